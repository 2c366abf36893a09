"""Order of the seat's mechanical state, in which the kernel integrates it and the instruments read its rates."""

from __future__ import annotations

State = tuple[float, ...]
"""State of a model, or of several one after another; compiled code needs tuples of a length known beforehand."""

DISPLACEMENT, VELOCITY, CUSHION_DISPLACEMENT, CUSHION_VELOCITY = range(4)
"""x = zs - z0 in m, its rate in m/s, xc = zc - zs in m, its rate in m/s."""
FLOOR_WORK, DAMPER_WORK, SUSPENSION_WORK, CUSHION_WORK = range(4, 8)
"""J; work that floor and outer forces supply, and that damper, suspension damping and cushion damping dissipate."""
MECHANICAL = 8
"""Length of the mechanical state; the states of the damper and of the effects on the seat follow it."""
