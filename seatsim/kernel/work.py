"""How much work a run may be: one that needs far shorter steps than were asked for is given up, not waited for."""

from __future__ import annotations

from seatsim.compilation.jit import jit

MOST_WORK = 100
"""Mean number of parts of a step at which a run is given up: it would take minutes, where others take milliseconds."""
MOST_DEBT = 1000.0 * MOST_WORK
"""Parts beyond that mean that are lent, so that a stiff start does not end a run."""


@jit
def owe(debt: float, parts: float) -> float:
    """Return the parts owed after a step that took `parts` of them: what exceeds `MOST_WORK`, less what was saved."""
    return max(0.0, debt + parts - MOST_WORK)
