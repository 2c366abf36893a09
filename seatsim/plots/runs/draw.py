"""All figures of a result."""

from __future__ import annotations

from matplotlib.figure import Figure

from seatsim.plots.runs.comparison import comparison
from seatsim.plots.runs.envelope import force_velocity
from seatsim.plots.runs.histories import time_histories
from seatsim.plots.runs.loops import damper_loops
from seatsim.plots.runs.pareto import pareto
from seatsim.plots.runs.spectra import psd, transmissibility
from seatsim.simulation.result import Result


def draw(result: Result) -> dict[str, Figure]:
    """Return the figures of a result by name, 10 inches wide; `comparison` and `pareto` are there for two runs or more.

    Where there is nothing to show (a floor at rest, a record too short for a spectrum), a figure says so. The
    sine tests of the dampers raise RunError where one cannot be carried to its end.
    """
    figures = {
        "time_histories": time_histories(result.runs),
        "psd": psd(result.runs),
        "transmissibility": transmissibility(result.runs),
        "damper_loops": damper_loops(result.runs),
        "force_velocity": force_velocity(result.runs[0]),
    }
    if len(result.runs) > 1:
        figures["comparison"] = comparison(result.runs)
    if len(result.runs) > 1 or result.brackets:
        figures["pareto"] = pareto(result.runs, result.brackets)
    return figures
