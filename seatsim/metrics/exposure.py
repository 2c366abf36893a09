"""A day's exposure to whole-body vibration: directive 2002/44/EC and the health guidance of ISO 2631-1, Annex B.

Nothing here says more about health than the two texts do.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from seatsim.metrics.comfort import EIGHT_HOURS, Dose, daily_exposure, daily_vdv, estimated_vdv
from seatsim.metrics.directions import direction
from seatsim.schema.content import written
from seatsim.schema.errors import InputError

HOUR, DAY = 3600.0, 24.0
"""s; h"""


class ExposureValue(NamedTuple):
    """A value of directive 2002/44/EC, Article 3 (2): of A(8) in m/s^2, or of the VDV in m/s^1.75."""

    a8: float
    vdv: float


ACTION, LIMIT = ExposureValue(0.5, 9.1), ExposureValue(1.15, 21.0)

ZONE_A8 = tuple(level * math.sqrt(600.0 / EIGHT_HOURS) for level in (3.0, 6.0))
"""Bounds of the zone of equation B.1 as A(8), 0.43 and 0.87 m/s^2: recalled as 3 and 6 m/s^2 at 10 min (Figure B.1)."""

ZONE_VDV = (8.5, 17.0)
"""Bounds of the zone of equation B.2 as estimated VDV in m/s^1.75 (ISO 2631-1:1997, B.3.1; recalled)."""

ZONES = {
    "below": "below the health guidance caution zone: health effects have not been clearly documented",
    "within": "within the zone: caution with respect to potential health risks is indicated",
    "above": "above the zone: health risks are likely",
}
"""What ISO 2631-1:1997, B.3.1, says of the zones (recalled), for people regularly exposed who sit."""


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
    """Zone of ISO 2631-1, Annex B, by equation B.1: a name of `ZONES`."""
    zone_vdv: str
    """The same by equation B.2, from the estimated VDV of the day."""

    @property
    @written()
    def zone_a8_text(self) -> str:
        """What ISO 2631-1 says of the zone by equation B.1."""
        return ZONES[self.zone_a8]

    @property
    @written()
    def zone_vdv_text(self) -> str:
        """What ISO 2631-1 says of the zone by equation B.2."""
        return ZONES[self.zone_vdv]


def assess_exposure(doses: dict[str, Dose], hours: float) -> Exposure | None:
    """Return the exposure of `hours` a day to vibration like that of a record; None where no axis counts for health.

    Args:
        doses: of the weighted accelerations by axis (`seatsim.metrics.DIRECTIONS`), without multiplying factors.
        hours: duration of the vibration in a day, above 0, at most 24.

    Raises:
        InputError: `hours` is out of its range, or an axis is not known.
    """
    if not 0 < hours <= DAY:
        raise InputError(f"hours: is {hours:g}; a day of vibration must be above 0 and at most {DAY:g}")
    seconds = HOUR * hours
    factors = {axis: k for axis in doses if (k := direction(axis).health) is not None}
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
        limit_value=_reach(LIMIT, *day, hours),
        zone_a8=_zone(day[0], ZONE_A8),
        zone_vdv=_zone(evdv, ZONE_VDV),
    )


def _reach(value: ExposureValue, a8: float, vdv8: float, hours: float) -> ValueReached:
    # A(8) grows with the root of the time, a dose of fourth powers with its fourth root.
    until = hours * (value.a8 / a8) ** 2 if a8 > 0 else math.inf
    until_vdv = hours * (value.vdv / vdv8) ** 4 if vdv8 > 0 else math.inf
    return ValueReached(*value, a8 > value.a8, vdv8 > value.vdv, until, until_vdv)


def _zone(value: float, bounds: tuple[float, ...]) -> str:
    low, high = bounds
    return "below" if value < low else "above" if value > high else "within"
