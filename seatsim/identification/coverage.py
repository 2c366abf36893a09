"""Which motion, currents, temperatures and frequencies records hold, and what is asked beyond them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from seatsim.dampers.base import DamperSpecification
from seatsim.recordings.bench_tables import BenchRecord
from seatsim.simulation.damper_bench import centring

BEYOND = 1.05
"""Factor from which a held-out record counts as beyond what was fitted."""
POWER = (0.05, 0.95)
"""Shares of the power of the velocity below the lowest and the highest frequency that count as covered."""


def coverage(records: Sequence[BenchRecord]) -> dict[str, Any]:
    """Return the ranges that the records visit, in SI units, degC and Hz, and the currents that were held."""
    steady = sorted({round(record.mean_current, 4) for record in records if np.ptp(record.current) == 0.0})
    warmth = [record.temperature for record in records if record.temperature is not None]
    bands = [_band(record) for record in records]
    return {
        "displacement": _range([record.displacement for record in records]),
        "velocity": _range([record.velocity for record in records]),
        "current": _range([record.current for record in records]),
        "steady_currents": steady,
        "temperature": _range(warmth) if warmth else None,
        "frequency": [min(low for low, _ in bands), max(high for _, high in bands)],
        "speeds": _shares(records),
    }


def remarks(
    specification: DamperSpecification, train: Sequence[BenchRecord], test: Sequence[BenchRecord], origin: float
) -> list[str]:
    """Return what the user should know of the data: motion off centre, tests outside what was fitted."""
    notes = []
    if specification.centred:
        off = next((text for r in train if (text := centring(r.displacement - origin, r.velocity))), "")
        notes += [off] if off else []
    for name, unit in (("velocity", "m/s"), ("current", "A"), ("displacement", "m")):
        seen = max(float(np.max(np.abs(getattr(record, name)))) for record in train)
        asked = max((float(np.max(np.abs(getattr(record, name)))) for record in test), default=0.0)
        if asked > BEYOND * seen:
            notes.append(f"held-out records reach {asked:.3g} {unit} of {name}, the fitted ones {seen:.3g} {unit} only")
    return notes


def _range(arrays: Sequence[Any]) -> list[float]:
    return [min(float(np.min(a)) for a in arrays), max(float(np.max(a)) for a in arrays)]


def _band(record: BenchRecord) -> tuple[float, float]:
    """Return the frequencies in Hz between which nine tenths of the power of the velocity lie."""
    power = np.abs(np.fft.rfft(record.velocity - np.mean(record.velocity))) ** 2
    grown = np.cumsum(power) / max(float(np.sum(power)), 1e-300)
    low, high = (float(np.searchsorted(grown, share)) * record.rate / len(record.velocity) for share in POWER)
    return low, high


def _shares(records: Sequence[BenchRecord]) -> dict[str, float]:
    """Return the share of time at each tenth of the largest speed."""
    speed = np.concatenate([np.abs(record.velocity) for record in records])
    top = float(np.max(speed))
    counts, edges = np.histogram(speed, 10, (0.0, top))
    return {f"{edge:.3g}": float(count / len(speed)) for edge, count in zip(edges[1:], counts, strict=True)}
