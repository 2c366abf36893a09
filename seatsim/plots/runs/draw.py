"""All figures of a result."""

from __future__ import annotations

from matplotlib.figure import Figure

from seatsim.cosimulation.damper import FmuDamper
from seatsim.plots.runs.comparison import plot_comparison
from seatsim.plots.runs.envelope import plot_force_velocity
from seatsim.plots.runs.histories import plot_time_histories
from seatsim.plots.runs.loops import plot_damper_loops
from seatsim.plots.runs.pareto import plot_pareto
from seatsim.plots.runs.spectra import plot_psd, plot_transmissibility
from seatsim.simulation.result import Result


def plot_result(result: Result) -> dict[str, Figure]:
    """Return the figures of a result by name, 10 inches wide.

    `comparison` and `pareto` are there for two runs or more, `pareto` also where there are performance bounds. Where
    there is nothing to show (a floor at rest, a record too short for a spectrum), a figure says so.

    Raises:
        RunError: a sine test of a damper cannot be carried to its end.
    """
    figures = {
        "time_histories": plot_time_histories(result.runs),
        "psd": plot_psd(result.runs),
        "transmissibility": plot_transmissibility(result.runs),
    }
    # A damper that is a unit of another program is not put to a sine test.
    models = [run for run in result.runs if not isinstance(run.scenario.damper.record, FmuDamper)]
    if models:
        figures["damper_loops"] = plot_damper_loops(models)
    if models and models[0] is result.runs[0]:
        figures["force_velocity"] = plot_force_velocity(result.runs[0])
    if len(result.runs) > 1:
        figures["comparison"] = plot_comparison(result.runs)
    if len(result.runs) > 1 or result.brackets:
        figures["pareto"] = plot_pareto(result.runs, result.brackets)
    return figures
