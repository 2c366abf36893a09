"""What bounds the fit of any damper model to the sines: `python benchmarks/identification_ceiling.py DIR`.

DIR holds the measured data. Two references beside `identification_models.py`, on the same records and held-out ones:

repeats  The steady cycles of a record, cut where the displacement rises through its middle: the mean of every second
    one predicts the others. What that misses no model of motion and current can predict; start and stop are left out.
black box  Ridge regression on FEATURES random tanh features of the current and of velocity and displacement, present
    and up to HISTORY ago; its penalty is that which predicts each of the training motions best from the others. It is
    told nothing of dampers, nor the measured force.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table
from threadpoolctl import threadpool_limits

from seatsim.characterisation.cycles import find_cycles, resample_loops, select_steady_cycles
from seatsim.identification.agreement import Agreement, assess_agreement, mean_agreement
from seatsim.identification.settings import IdentificationSettings
from seatsim.identification.split import split_records
from seatsim.recordings.bench_tables import BenchRecord, load_bench

Array = NDArray[np.float64]

SINES, HELD_OUT = "utfsm_mr_sine_raw", ("*10mm_2Hz*", "*5mm_4Hz*")
RATE = 200.0
HISTORY = (0.005, 0.01, 0.02, 0.04, 0.08, 0.16)
"""Seconds."""
FEATURES = 600
STEEPEST = 10.0
"""Slope of a feature, over the spread of an input."""
PENALTIES = 10.0 ** np.arange(-8.0, 1.0)


def assess_repeats(record: BenchRecord) -> Agreement | None:
    """Return how well the mean of every second steady cycle predicts the others, None where there are too few."""
    steady = select_steady_cycles(find_cycles(record.displacement))
    if len(steady) < 4:
        return None
    cycles = np.array([loop.force for loop in resample_loops(record, steady)])
    others = cycles[1::2]
    return assess_agreement(others.ravel(), np.tile(np.mean(cycles[::2], axis=0), len(others)))


def stack_inputs(record: BenchRecord) -> tuple[Array, Array]:
    """Return the inputs of the black box, shape (N, 2 + 2 len(HISTORY) + 1), and the force, at `RATE`."""
    every = max(1, round(record.rate / RATE))
    back = [round(seconds * record.rate) for seconds in (0.0, *HISTORY)]
    columns = [record.current]
    for k in back:
        late = np.maximum(np.arange(len(record.force)) - k, 0)
        columns += [record.velocity[late], record.displacement[late] - (record.displacement if k else 0.0)]
    return np.column_stack(columns)[::every], record.force[::every]


class BlackBox:
    """Random features of the inputs of some records."""

    def __init__(self, records: list[BenchRecord]) -> None:
        rng = np.random.default_rng(0)
        stacked = np.concatenate([stack_inputs(record)[0] for record in records])
        self.size = np.std(stacked, axis=0)
        self.turn = rng.standard_normal((stacked.shape[1], FEATURES)) * np.exp(
            rng.uniform(np.log(0.1), np.log(STEEPEST), FEATURES)
        )
        self.turn[:, : FEATURES // 2] *= rng.random((stacked.shape[1], FEATURES // 2)) < 0.3
        self.shift = rng.uniform(-2.0, 2.0, FEATURES)

    def features(self, record: BenchRecord) -> Array:
        """Return the features of a record, shape (N, P)."""
        u = stack_inputs(record)[0] / self.size
        return np.column_stack([np.ones(len(u)), u, u[:, :1] * u, np.tanh(u @ self.turn + self.shift)])

    def normal(self, record: BenchRecord) -> tuple[Array, Array]:
        """Return the normal equations of a record, which counts alike with the others."""
        features, force = self.features(record), stack_inputs(record)[1]
        weight = 1.0 / (np.var(force) * len(force))
        return weight * features.T @ features, weight * features.T @ force


def solve_ridge(parts: list[tuple[Array, Array]], penalty: float) -> Array:
    """Return the coefficients of a ridge regression."""
    left, right = parts[0]
    for a, b in parts[1:]:
        left, right = left + a, right + b
    size = np.trace(left) / len(left)
    return np.asarray(np.linalg.solve(left + penalty * size * np.eye(len(left)), right))


def assess_black_box(
    train: list[BenchRecord], test: list[BenchRecord]
) -> tuple[list[Agreement], list[Agreement], float]:
    """Return the figures on training and held-out records, and the penalty chosen."""
    box = BlackBox(train)
    features = [box.features(record) for record in train]
    parts = [box.normal(record) for record in train]
    motions = sorted({record.file for record in train})

    def error(penalty: float) -> float:
        found = []
        for motion in motions:
            found_at = solve_ridge([p for p, r in zip(parts, train, strict=True) if r.file != motion], penalty)
            found += [
                1.0 - assess_agreement(stack_inputs(r)[1], f @ found_at).fit_percent / 100.0
                for f, r in zip(features, train, strict=True) if r.file == motion
            ]  # fmt: skip
        return float(np.mean(np.square(found)))

    penalty = min(PENALTIES, key=error)
    coefficients = solve_ridge(parts, penalty)

    def assess(records: list[BenchRecord]) -> list[Agreement]:
        return [assess_agreement(stack_inputs(record)[1], box.features(record) @ coefficients) for record in records]

    return assess(train), assess(test), float(penalty)


def report(data: Path) -> None:
    """Print both references, record by record and on average."""
    parts = split_records(load_bench(data / SINES), IdentificationSettings(HELD_OUT))
    train, test = parts.train, parts.held_out
    fitted, predicted, penalty = assess_black_box(train, test)
    table = Table(title=f"fit % (penalty {penalty:g})", title_justify="left")
    for column in ("record", "part", "repeats", "black box"):
        table.add_column(column, justify="left" if column in ("record", "part") else "right")
    for part, members, boxes in (("train", train, fitted), ("test", test, predicted)):
        cycles = [assess_repeats(record) for record in members]
        for record, cycle, box in zip(members, cycles, boxes, strict=True):
            table.add_row(record.name, part, f"{cycle.fit_percent:.1f}" if cycle else "-", f"{box.fit_percent:.1f}")
        mean = mean_agreement([cycle for cycle in cycles if cycle]).fit_percent
        table.add_row("mean", part, f"{mean:.1f}", f"{mean_agreement(boxes).fit_percent:.1f}", end_section=True)
    Console(width=120).print(table)


def main() -> None:
    """Read the argument and run."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("data", type=Path, metavar="DIR", help="folder of the measured data")
    with threadpool_limits(1):
        report(parser.parse_args().data)


if __name__ == "__main__":
    main()
