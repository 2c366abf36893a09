"""Where and in which direction vibration enters a seated person: weighting and multiplying factors of ISO 2631-1:1997.

Source: ISO 2631-1:1997, 7.2.3 and Tables 1 and 2 with 8.2.2.1 to 8.2.2.3; factors recalled, not read in the standard.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, NamedTuple

from seatsim.schema.content import Form
from seatsim.schema.errors import InputError, nearest


class Direction(NamedTuple):
    """One axis at one point of contact with the person."""

    weighting: str
    """Frequency weighting, a name of `seatsim.metrics.WEIGHTINGS`."""
    comfort: Annotated[float, Form(key="factor_comfort")]
    """Factor k of the vibration total value for comfort (8.2.2); m/rad for rotation."""
    health: Annotated[float | None, Form(key="factor_health")] = None
    """Factor k with regard to health (7.2.3); None where the standard has none."""
    unit: str = "m/s^2"


POINTS = ("seat", "back", "feet")
"""Surfaces through which vibration enters a seated person."""

DIRECTIONS: Mapping[str, Direction] = {
    "x": Direction("Wd", 1.0, 1.4),
    "y": Direction("Wd", 1.0, 1.4),
    "z": Direction("Wk", 1.0, 1.0),
    "rx": Direction("We", 0.63, unit="rad/s^2"),
    "ry": Direction("We", 0.4, unit="rad/s^2"),
    "rz": Direction("We", 0.2, unit="rad/s^2"),
    "back.x": Direction("Wc", 0.8),
    "back.y": Direction("Wd", 0.5),
    "back.z": Direction("Wd", 0.4),
    "feet.x": Direction("Wk", 0.25),
    "feet.y": Direction("Wk", 0.25),
    "feet.z": Direction("Wk", 0.4),
}
"""By axis: fore-and-aft x, lateral y, vertical z; without a point in front, on the surface of the seat."""


def direction(axis: str) -> Direction:
    """Return the direction of an axis.

    Raises:
        InputError: no axis has this name.
    """
    if axis not in DIRECTIONS:
        raise InputError(f"no axis is called '{axis}'{nearest(axis, DIRECTIONS)}; permitted: {', '.join(DIRECTIONS)}")
    return DIRECTIONS[axis]


def point_of(axis: str) -> str:
    """Return the point of contact of an axis, a name of `POINTS`."""
    return axis.partition(".")[0] if "." in axis else POINTS[0]
