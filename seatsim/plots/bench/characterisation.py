"""All figures of a characterisation."""

from __future__ import annotations

from matplotlib.figure import Figure

from seatsim.characterisation.summary import Characterisation
from seatsim.plots.bench.asymmetry import plot_asymmetry
from seatsim.plots.bench.loops import plot_loops
from seatsim.plots.bench.steps import plot_steps
from seatsim.plots.bench.trends import plot_energy


def plot_characterisation(found: Characterisation) -> dict[str, Figure]:
    """Return the figures of a characterisation by name, 10 inches wide.

    `loops` is always there, `energy` and `asymmetry` where there are cycles, `steps` where a response was determined.
    """
    figures = {"loops": plot_loops(found)}
    if any(row.loop is not None for row in found.rows):
        figures |= {"energy": plot_energy(found), "asymmetry": plot_asymmetry(found)}
    if any(answer.share is not None for answer in found.responses):
        figures["steps"] = plot_steps(found)
    return figures
