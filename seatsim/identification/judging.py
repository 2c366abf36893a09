"""Predictions of measured records, and how well they agree."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.identification.figures import Figures, figures
from seatsim.identification.predict import Bench, drive, predicted
from seatsim.identification.smoothing import sharpened, smoothed
from seatsim.identification.split import Split
from seatsim.recordings.bench_tables import BenchRecord, load_bench
from seatsim.schema.errors import InputError

Array = NDArray[np.float64]


class Judged(NamedTuple):
    """A record or a part of one, what it was for (train, test, predicted), its predicted force in N, the agreement.

    The force is NaN from where the state ran away; there it counts as zero in the figures.
    """

    record: BenchRecord
    part: str
    predicted: Array
    figures: Figures

    @property
    def complete(self) -> bool:
        """Whether the state stayed finite."""
        return bool(np.all(np.isfinite(self.predicted)))


class Further(NamedTuple):
    """Records that are predicted only.

    moving_average: seconds over which their owner averaged motion and force; centred: the mean of each force was
    removed.
    """

    records: list[BenchRecord]
    moving_average: float = 0.0
    centred: bool = False


def further(paths: Sequence[str | Path], moving_average: float = 0.0, centred: bool = False) -> Further:
    """Return the records of some tables or folders, to be predicted.

    Raises:
        InputError: the data or the moving average are not as they must be.
    """
    records = [record for path in paths for record in load_bench(path)]
    longest = min((len(record.force) / record.rate for record in records), default=math.inf)
    if not 0.0 <= moving_average < longest:
        raise InputError(
            f"--moving-average {moving_average:g} s is not permitted; it must be at least 0 s"
            + (f" and shorter than the shortest record, {longest:g} s" if records else "")
        )
    if not records and (moving_average or centred):
        raise InputError("--moving-average and --centred are of records to be predicted; name these by --predict")
    return Further(records, moving_average, centred)


def judge(bench: Bench, parts: Split, origin: float) -> list[Judged]:
    """Return the agreement on what was fitted, then on what was held out; every record is simulated from its start."""
    train, rest = [], []
    for record, fitted in zip(parts.train, parts.fitted, strict=True):
        force = predicted(bench, drive(record, origin, True))
        rows = len(fitted.force)
        train.append(_judged(fitted, "train", force[:rows]))
        if rows < len(force):
            rest.append(_judged(record.part(rows, len(force)), "test", force[rows:]))
    return train + rest + [_judged(r, "test", predicted(bench, drive(r, origin, True))) for r in parts.held_out]


def foretold(bench: Bench, origin: float, more: Further) -> list[Judged]:
    """Return the agreement on further records, whose motion is sharpened and whose predicted force is averaged."""
    found = []
    for record in more.records:
        rows = round(more.moving_average * record.rate)
        force = smoothed(predicted(bench, drive(sharpened(record, rows), origin, True)), rows)
        found.append(_judged(record, "predicted", force - np.mean(force) if more.centred else force))
    return found


def _judged(record: BenchRecord, part: str, force: Array) -> Judged:
    return Judged(record, part, force, figures(record.force, np.where(np.isfinite(force), force, 0.0)))
