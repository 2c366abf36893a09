"""What a seat passes on of the vibration under it: SEAT factors of several runs (ISO 10326-1)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from seatsim.metrics.arrays import ratio
from seatsim.metrics.comfort import Dose

RUNS = 3
"""Consecutive runs that a test is made of (ISO 10326-1:2016, 10.2.1)."""
SPREAD = 0.05
"""Largest deviation of each of them from their mean, as a share of it (ISO 10326-1:2016, 10.2.1)."""


class SeatTransmission(NamedTuple):
    """SEAT factors along one axis, from the weighted accelerations of several runs."""

    rms: float
    """Mean a_w on the seat over mean a_w at its base (ISO 10326-1:2016, 10.2.2); NaN where the base is at rest."""
    vdv: float
    """Mean VDV on the seat over mean VDV at its base, for motion with shocks (Griffin, Handbook of Human Vibration)."""
    runs: tuple[float, ...]
    """SEAT factor (RMS) of each run."""
    spread: float
    """Largest deviation of a run from the mean, on the seat or at its base, as a share of the mean."""
    within_spread: bool | None
    """Whether at least three runs are within 5 % of their mean; None where there are fewer."""


def seat_transmission(seat: Sequence[Dose], base: Sequence[Dose]) -> SeatTransmission:
    """Return the SEAT factors of runs whose doses on the seat and at its base are given pair by pair, at least one."""
    on_seat, at_base = [dose.rms for dose in seat], [dose.rms for dose in base]
    spread = max(spread_of(on_seat), spread_of(at_base))
    return SeatTransmission(
        rms=ratio(sum(on_seat), sum(at_base)),
        vdv=ratio(sum(dose.vdv for dose in seat), sum(dose.vdv for dose in base)),
        runs=tuple(ratio(a, b) for a, b in zip(on_seat, at_base, strict=True)),
        spread=spread,
        within_spread=spread <= SPREAD if len(seat) >= RUNS else None,
    )


def spread_of(values: Sequence[float]) -> float:
    """Return the largest deviation from the mean of at least one value, as a share of the mean; 0 where that is 0."""
    mean = sum(values) / len(values)
    return max(abs(value - mean) for value in values) / mean if mean > 0 else 0.0
