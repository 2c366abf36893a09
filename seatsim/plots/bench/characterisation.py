"""Pictures of a characterisation."""

from __future__ import annotations

from matplotlib.figure import Figure

from seatsim.characterisation.summary import Characterisation
from seatsim.plots.bench.asymmetry import asymmetry
from seatsim.plots.bench.loops import loops
from seatsim.plots.bench.steps import steps
from seatsim.plots.bench.trends import energy


def draw(found: Characterisation) -> dict[str, Figure]:
    """Return the figures of a characterisation by name, 10 inches wide.

    `loops` is always there, `energy` and `asymmetry` where there are cycles, `steps` where a response was determined.
    """
    figures = {"loops": loops(found)}
    if any(row.loop is not None for row in found.rows):
        figures |= {"energy": energy(found), "asymmetry": asymmetry(found)}
    if any(answer.share is not None for answer in found.responses):
        figures["steps"] = steps(found)
    return figures
