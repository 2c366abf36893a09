"""Pictures of a result; the only part of seatsim that imports matplotlib.

Figures are built through matplotlib's objects, without pyplot and without global state, so threads may draw.
Equal results give equal bytes where a figure is saved with `metadata={"Software": "seatsim"}`.
"""

from __future__ import annotations

from matplotlib.figure import Figure

from seatsim.plots.comparison import comparison
from seatsim.plots.envelope import force_velocity
from seatsim.plots.histories import time_histories
from seatsim.plots.loops import damper_loops
from seatsim.plots.pareto import pareto
from seatsim.plots.spectra import psd, transmissibility
from seatsim.result import Result

__all__ = ["draw"]


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
