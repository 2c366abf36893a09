"""Predictions of measured records, and how well they agree."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from seatsim.identification.agreement import Agreement, assess_agreement
from seatsim.identification.prediction import BenchModel, predict_force, prepare_inputs
from seatsim.identification.smoothing import sharpen, smooth
from seatsim.identification.split import Split
from seatsim.recordings.bench_tables import BenchRecord, load_bench
from seatsim.schema.arrays import Array
from seatsim.schema.content import Joined, Unwritten, written
from seatsim.schema.errors import InputError


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
