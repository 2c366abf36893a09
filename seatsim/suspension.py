"""What a seat suspension has beyond its linear spring and damping."""

from __future__ import annotations

from typing import NamedTuple

from seatsim.jit import jit


class SuspensionExtras(NamedTuple):
    """What a suspension has beyond `kf x + cf v`; all zero is the plant's own linear law."""

    friction: float = 0.0
    cubic: float = 0.0
    stop_low: float = 0.0
    stop_high: float = 0.0
    stop_stiffness: float = 0.0
    stop_damping: float = 0.0


@jit
def extra_force(extras: SuspensionExtras, x: float, v: float) -> float:
    """Return the force in N that opposes extension, of progressive spring and end stops (friction is set-valued)."""
    total = extras.cubic * x * x * x
    if extras.stop_stiffness > 0.0:
        if x > extras.stop_high:
            total += _buffer(extras, x - extras.stop_high, v)
        elif x < extras.stop_low:
            total -= _buffer(extras, extras.stop_low - x, -v)
    return total


@jit
def _buffer(extras: SuspensionExtras, depth: float, speed: float) -> float:
    """Return the push of a buffer compressed by `depth`, which never pulls."""
    return max(0.0, extras.stop_stiffness * depth * (1.0 + extras.stop_damping * speed))
