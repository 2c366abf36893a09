"""Where vibration enters a person, and a day's exposure: directive 2002/44/EC and ISO 2631-1 with Annex B.

Nothing here says more about health than the two texts do.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, NamedTuple

from seatsim.metrics.comfort import EIGHT_HOURS, Dose, daily_exposure, daily_vdv, estimated_vdv
from seatsim.schema.content import Form
from seatsim.schema.errors import InputError
from seatsim.schema.fields import read_packaged

HOUR, DAY = 3600.0, 24.0
"""s; h"""


class _ExposureValue(NamedTuple):
    """A value of directive 2002/44/EC, Article 3 (2): of A(8) in m/s^2, or of the VDV in m/s^1.75."""

    a8: float
    vdv: float


ACTION, _LIMIT = _ExposureValue(0.5, 9.1), _ExposureValue(1.15, 21.0)

_ZONE_A8 = tuple(level * math.sqrt(600.0 / EIGHT_HOURS) for level in (3.0, 6.0))
"""Bounds of the zone of equation B.1 as A(8), 0.43 and 0.87 m/s^2: recalled as 3 and 6 m/s^2 at 10 min (Figure B.1)."""

_ZONE_VDV = (8.5, 17.0)
"""Bounds of the zone of equation B.2 as estimated VDV in m/s^1.75 (ISO 2631-1:1997, B.3.1; recalled)."""


class ValueReached(NamedTuple):
    """Whether a day's exposure exceeds a value of the directive, and the hours of such vibration that reach it.

    Hours are infinite without vibration, and may exceed 24: then the value is not reached in a day.
    """

    a8: float
    vdv: float
    exceeded_by_a8: bool
    exceeded_by_vdv: bool
    hours_to_a8: float
    hours_to_vdv: float


class Exposure(NamedTuple):
    """A day's exposure, each figure that of its worst axis of x, y, z on the seat."""

    hours: float
    a8: float
    """A(8) = max over axes of k a_w sqrt(T / 8 h) in m/s^2, k = 1.4 for x and y, 1 for z."""
    a8_axis: str
    vdv8: float
    """max over axes of k VDV (T / T_record)^(1/4) in m/s^1.75."""
    vdv8_axis: str
    action_value: ValueReached
    limit_value: ValueReached
    zone_a8: str
    """`below`, `within` or `above` the health guidance caution zone of ISO 2631-1, Annex B, by equation B.1."""
    zone_vdv: str
    """The same by equation B.2, from the estimated VDV of the day."""


def assess_exposure(doses: dict[str, Dose], hours: float) -> Exposure | None:
    """Return the exposure of `hours` a day to vibration like that of a record; None where no axis counts for health.

    Args:
        doses: of the weighted accelerations by axis (`DIRECTIONS`), without multiplying factors.
        hours: duration of the vibration in a day, above 0, at most 24.

    Raises:
        InputError: `hours` is out of its range.
    """
    if not 0 < hours <= DAY:
        raise InputError(f"hours: is {hours:g}; a day of vibration must be above 0 and at most {DAY:g}")
    seconds = HOUR * hours
    factors = {axis: k for axis in doses if (k := DIRECTIONS[axis].health) is not None}
    if not factors:
        return None
    a8 = {axis: daily_exposure(k * doses[axis].rms, seconds) for axis, k in factors.items()}
    vdv8 = {axis: daily_vdv(k * doses[axis].vdv, doses[axis].duration, seconds) for axis, k in factors.items()}
    evdv = max(estimated_vdv(k * doses[axis].rms, seconds) for axis, k in factors.items())
    worst, worst_vdv = max(a8, key=lambda axis: a8[axis]), max(vdv8, key=lambda axis: vdv8[axis])
    day = a8[worst], vdv8[worst_vdv]
    return Exposure(
        hours=hours,
        a8=day[0],
        a8_axis=worst,
        vdv8=day[1],
        vdv8_axis=worst_vdv,
        action_value=_reach(ACTION, *day, hours),
        limit_value=_reach(_LIMIT, *day, hours),
        zone_a8=_zone(day[0], _ZONE_A8),
        zone_vdv=_zone(evdv, _ZONE_VDV),
    )


def _reach(value: _ExposureValue, a8: float, vdv8: float, hours: float) -> ValueReached:
    # A(8) grows with the root of the time, a dose of fourth powers with its fourth root.
    until = hours * (value.a8 / a8) ** 2 if a8 > 0 else math.inf
    until_vdv = hours * (value.vdv / vdv8) ** 4 if vdv8 > 0 else math.inf
    return ValueReached(*value, a8 > value.a8, vdv8 > value.vdv, until, until_vdv)


def _zone(value: float, bounds: tuple[float, ...]) -> str:
    low, high = bounds
    return "below" if value < low else "above" if value > high else "within"


class Direction(NamedTuple):
    """One axis at one point of contact with the person.

    Source: ISO 2631-1:1997, 7.2.3 and Tables 1 and 2 with 8.2.2.1 to 8.2.2.3; factors recalled, not read in the
    standard.
    """

    weighting: str
    """Frequency weighting, a name of `seatsim.metrics.weighting.WEIGHTINGS`."""
    comfort: Annotated[float, Form(key="factor_comfort")]
    """Factor k of the vibration total value for comfort (8.2.2); m/rad for rotation."""
    health: Annotated[float | None, Form(key="factor_health")] = None
    """Factor k with regard to health (7.2.3); None where the standard has none."""
    unit: str = "m/s^2"


POINTS = ("seat", "back", "feet")
"""Surfaces through which vibration enters a seated person."""

DIRECTIONS = read_packaged(Path(__file__).with_name("directions.yaml"), dict[str, Direction])
"""By axis: fore-and-aft x, lateral y, vertical z; without a point in front, on the surface of the seat."""


def point_of(axis: str) -> str:
    """Return the point of contact of an axis, a name of `POINTS`."""
    return axis.partition(".")[0] if "." in axis else POINTS[0]
