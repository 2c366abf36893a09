"""All figures of a result."""

from __future__ import annotations

from matplotlib.figure import Figure

from seatsim.plots.runs.comparison import plot_comparison, plot_pareto
from seatsim.plots.runs.dampers import plot_force_velocity
from seatsim.plots.runs.looks import show_runs
from seatsim.plots.runs.signals import plot_psd, plot_time_histories, plot_transmissibility
from seatsim.simulation.result import Result


def plot_result(result: Result) -> dict[str, Figure]:
    """Return the figures of a result by name.

    `pareto` is there for two runs or more, `comparison` where a number is swept; `force_velocity` is that of the run
    whose current varies the most. Where several scenarios have several runs, each has figures over time and frequency
    of its own, under its name. Where there is nothing to show (a floor at rest, a record too short for a spectrum), a
    figure says so.

    Raises:
        RunError: a sine test of a damper cannot be carried to its end.
    """
    figures = {}
    if len(result.runs) > 1:
        figures["pareto"] = plot_pareto(result.runs)
    if (comparison := plot_comparison(result.runs)) is not None:
        figures["comparison"] = comparison
    plots = {"time_histories": plot_time_histories, "psd": plot_psd, "transmissibility": plot_transmissibility}
    for shown in show_runs(result.runs):
        end = f"_{shown.scenario}" * bool(shown.scenario)
        figures |= {f"{name}{end}": plot(shown) for name, plot in plots.items()}
    return figures | {"force_velocity": plot_force_velocity(result.runs)}
