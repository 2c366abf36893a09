"""Predictions of measured records: how well they agree, and which ranges the records visit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from seatsim.dampers.base import DamperSpecification
from seatsim.identification.prediction import BenchModel, predict_force, prepare_inputs, sharpen, smooth
from seatsim.identification.settings import Split
from seatsim.recordings.bench_tables import BenchRecord, load_bench
from seatsim.schema.arrays import Array
from seatsim.schema.content import Joined, Unwritten, written
from seatsim.schema.errors import InputError
from seatsim.simulation.damper_bench import centring

_GUARD = 0.05
"""Share of a record's peak force below which a measured force does not count in the mean deviation."""


class Agreement(NamedTuple):
    """Agreement of a predicted force s with a measured one y.

    r2            1 - sum (y - s)^2 / sum (y - mean y)^2
    md            mean of |y - s| / |y|, over the samples where |y| is more than 5 % of its peak
    rmse          sqrt(mean (y - s)^2), N
    fit_percent   100 (1 - ||y - s|| / ||y - mean y||)

    Source: Yu et al. 2019 eqs 6-8 for the first three. Its eq 7 diverges where the measured force crosses zero; the
    guard is ours.
    """

    r2: float
    md: float
    rmse: float
    fit_percent: float


def assess_agreement(measured: Array, predicted: Array) -> Agreement:
    """Return the agreement on one record, arrays of shape (N,) in N; minus infinity for a force that never varies."""
    error = measured - predicted
    spread = float(np.sum((measured - np.mean(measured)) ** 2))
    share = float(np.sum(error**2)) / spread if spread > 0.0 else np.inf
    counted = np.abs(measured) > _GUARD * np.max(np.abs(measured))
    deviation = float(np.mean(np.abs(error[counted] / measured[counted]))) if counted.any() else np.inf
    rmse = float(np.sqrt(np.mean(error**2)))
    return Agreement(1.0 - share, deviation, rmse, 100.0 * (1.0 - share**0.5))


def mean_agreement(each: Sequence[Agreement]) -> Agreement:
    """Return the mean of every figure over records, each of which has the same weight."""
    return Agreement(*(float(np.mean(values)) for values in zip(*each, strict=True)))


class Assessment(NamedTuple):
    """A record or a part of one, what it was for (train, test, predicted), its predicted force in N, the agreement.

    The force is NaN from where the state ran away; there it counts as zero in the agreement.
    """

    record: Unwritten[BenchRecord]
    part: str
    predicted: Unwritten[Array]
    agreement: Joined[Agreement]

    @property
    @written()
    def current(self) -> float:
        """Mean current in A."""
        return self.record.mean_current

    @property
    def complete(self) -> bool:
        """Whether the state stayed finite."""
        return bool(np.all(np.isfinite(self.predicted)))


class PredictionData(NamedTuple):
    """Records that are predicted only.

    moving_average: seconds over which their owner averaged motion and force; centred: the mean of each force was
    removed.
    """

    records: list[BenchRecord]
    moving_average: float = 0.0
    centred: bool = False


def load_prediction_data(
    paths: Sequence[str | Path], moving_average: float = 0.0, centred: bool = False
) -> PredictionData:
    """Return the records of some tables or folders, to be predicted.

    Raises:
        InputError: the data or the moving average are not as they must be.
    """
    records = [record for path in paths for record in load_bench(path)]
    shortest = min((len(record.force) / record.rate for record in records), default=math.inf)
    if not 0.0 <= moving_average < shortest:
        raise InputError(
            f"--moving-average {moving_average:g} s is not permitted; it must be at least 0 s"
            + (f" and shorter than the shortest record, {shortest:g} s" if records else "")
        )
    if not records and (moving_average or centred):
        raise InputError("--moving-average and --centred are of records to be predicted; name these by --predict")
    return PredictionData(records, moving_average, centred)


def assess_fit(bench: BenchModel, parts: Split, origin: float) -> list[Assessment]:
    """Return the agreement on what was fitted, then on what was held out; every record is simulated from its start.

    origin: displacement in m that counts as x = 0.
    """
    train, rest = [], []
    for record, fitted in zip(parts.train, parts.fitted, strict=True):
        force = predict_force(bench, prepare_inputs(record, origin, True))
        rows = len(fitted.force)
        train.append(_assess(fitted, "train", force[:rows]))
        if rows < len(force):
            rest.append(_assess(record.part(rows, len(force)), "test", force[rows:]))
    held_out = [(record, predict_force(bench, prepare_inputs(record, origin, True))) for record in parts.held_out]
    return train + rest + [_assess(record, "test", force) for record, force in held_out]


def assess_predictions(bench: BenchModel, origin: float, data: PredictionData) -> list[Assessment]:
    """Return the agreement on records that are predicted only, treated as their owner treated them.

    The motion is sharpened before it drives the model, and the predicted force averaged and centred as the measured
    one was.
    """
    found = []
    for record in data.records:
        rows = round(data.moving_average * record.rate)
        force = smooth(predict_force(bench, prepare_inputs(sharpen(record, rows), origin, True)), rows)
        found.append(_assess(record, "predicted", force - np.mean(force) if data.centred else force))
    return found


def _assess(record: BenchRecord, part: str, force: Array) -> Assessment:
    return Assessment(record, part, force, assess_agreement(record.force, np.where(np.isfinite(force), force, 0.0)))


_BEYOND = 1.05
"""Factor from which a held-out record counts as beyond what was fitted."""
_POWER = (0.05, 0.95)
"""Shares of the power of the velocity below the lowest and the highest frequency that count as covered."""
_SPEED_CLASSES = 10
"""Classes of speed whose shares of time are counted."""
_SAME_CURRENT = 4
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
    steady = {round(record.mean_current, _SAME_CURRENT) for record in records if np.ptp(record.current) == 0.0}
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
        if tested > _BEYOND * fitted:
            text = f"held-out records reach {tested:.3g} {unit} of {name}, the fitted ones {fitted:.3g} {unit} only"
            notes.append(text)
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
    low, high = (float(np.searchsorted(grown, share)) * record.rate / len(record.velocity) for share in _POWER)
    return low, high


def _shares_of_time(records: Sequence[BenchRecord]) -> dict[str, float]:
    """Return the share of time at each tenth of the largest speed."""
    speed = np.concatenate([np.abs(record.velocity) for record in records])
    counts, edges = np.histogram(speed, _SPEED_CLASSES, (0.0, float(np.max(speed))))
    return {f"{edge:.3g}": float(count / len(speed)) for edge, count in zip(edges[1:], counts, strict=True)}
