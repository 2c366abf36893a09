"""Which motion, currents, temperatures and frequencies records hold, and what is asked beyond them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from seatsim.dampers.base import DamperSpecification
from seatsim.recordings.bench_tables import BenchRecord
from seatsim.schema.arrays import Array
from seatsim.simulation.damper_bench import centring

BEYOND = 1.05
"""Factor from which a held-out record counts as beyond what was fitted."""
POWER = (0.05, 0.95)
"""Shares of the power of the velocity below the lowest and the highest frequency that count as covered."""
SPEED_CLASSES = 10
"""Classes of speed whose shares of time are counted."""
SAME_CURRENT = 4
"""Decimals of a current in A that tell two steady currents apart."""


class VisitedRanges(NamedTuple):
    """The ranges that records visit, each with its least and greatest value, in SI units, degC and Hz.

    steady_currents: currents that were constant over a record. temperature: None where it was not recorded. frequency:
    where nine tenths of the power of the velocity lie. speeds: share of time by the upper end of each tenth of the
    largest speed.
    """

    displacement: list[float]
    velocity: list[float]
    current: list[float]
    steady_currents: list[float]
    temperature: list[float] | None
    frequency: list[float]
    speeds: dict[str, float]


def measure_coverage(records: Sequence[BenchRecord]) -> VisitedRanges:
    """Return the ranges that the records visit."""
    steady = {round(record.mean_current, SAME_CURRENT) for record in records if np.ptp(record.current) == 0.0}
    temperatures = [record.temperature for record in records if record.temperature is not None]
    bands = [_band(record) for record in records]
    return VisitedRanges(
        displacement=_range([record.displacement for record in records]),
        velocity=_range([record.velocity for record in records]),
        current=_range([record.current for record in records]),
        steady_currents=sorted(steady),
        temperature=_range(temperatures) if temperatures else None,
        frequency=[min(low for low, _ in bands), max(high for _, high in bands)],
        speeds=_shares_of_time(records),
    )


def note_limits(
    specification: DamperSpecification, train: Sequence[BenchRecord], test: Sequence[BenchRecord], origin: float
) -> list[str]:
    """Return what the user should know of the data: motion off centre, tests outside what was fitted."""
    notes = []
    if specification.centred:
        off = next((text for r in train if (text := centring(r.displacement - origin, r.velocity))), "")
        notes += [off] if off else []
    for name, unit in (("velocity", "m/s"), ("current", "A"), ("displacement", "m")):
        fitted = max(_largest(record, name) for record in train)
        tested = max((_largest(record, name) for record in test), default=0.0)
        if tested > BEYOND * fitted:
            notes.append(
                f"held-out records reach {tested:.3g} {unit} of {name}, the fitted ones {fitted:.3g} {unit} only"
            )
    return notes


def _largest(record: BenchRecord, name: str) -> float:
    """Return the largest magnitude of one of a record's quantities."""
    return float(np.max(np.abs(record._asdict()[name])))


def _range(arrays: Sequence[Array]) -> list[float]:
    return [min(float(np.min(a)) for a in arrays), max(float(np.max(a)) for a in arrays)]


def _band(record: BenchRecord) -> tuple[float, float]:
    """Return the frequencies in Hz between which nine tenths of the power of the velocity lie."""
    power = np.abs(np.fft.rfft(record.velocity - np.mean(record.velocity))) ** 2
    grown = np.cumsum(power) / max(float(np.sum(power)), 1e-300)
    low, high = (float(np.searchsorted(grown, share)) * record.rate / len(record.velocity) for share in POWER)
    return low, high


def _shares_of_time(records: Sequence[BenchRecord]) -> dict[str, float]:
    """Return the share of time at each tenth of the largest speed."""
    speed = np.concatenate([np.abs(record.velocity) for record in records])
    counts, edges = np.histogram(speed, SPEED_CLASSES, (0.0, float(np.max(speed))))
    return {f"{edge:.3g}": float(count / len(speed)) for edge, count in zip(edges[1:], counts, strict=True)}
