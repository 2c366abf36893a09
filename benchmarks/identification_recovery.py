"""Are the parameters found that made the data? `python benchmarks/identification_recovery.py`.

Every damper is put on a simulated bench with parameters drawn up to 30 % off its defaults, from which `seatsim
identify` then starts; a law in the current is drawn at its nodes, what is 0 within 3 % of a size that its unit has.
Sines of 25 mm, 0.5 Hz; 10 mm, 1 and 2 Hz; 5 mm, 4 Hz; 2 mm, 5 Hz at five currents and a random motion at three, slower
where the model does not hold so far, with white noise of 2 % of each record's standard deviation. A parameter whose
Fisher information at the truth leaves more than 2.5 % of its size unknown is declared unidentifiable before the fit;
all others have to come back within 5 %. A coefficient of a law counts against the size of the law. Results stand in
`--out` as JSON and are not made again.
"""

from __future__ import annotations

import argparse
import json
import zlib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table
from threadpoolctl import threadpool_limits

from seatsim.identification.coordinates import Coordinates
from seatsim.identification.damper_record import (
    DamperRecord,
    Scales,
    find_model,
    find_specification,
    law_range,
    rescale_damper,
)
from seatsim.identification.identify import identify_records
from seatsim.identification.information import Information, compute_information
from seatsim.identification.prediction import BenchModel, prepare_inputs
from seatsim.identification.problem import IdentificationProblem, weight_records
from seatsim.recordings.bench_tables import BenchRecord
from seatsim.rig.temperature import TemperatureFactors
from seatsim.schema.errors import RunError
from seatsim.schema.files import write_json
from seatsim.schema.registry import names
from seatsim.simulation.damper_bench import bench_force

Array = NDArray[np.float64]

SINES = ((0.025, 0.5, 3), (0.01, 1.0, 3), (0.01, 2.0, 4), (0.005, 4.0, 6), (0.002, 5.0, 6))
"""Amplitude [m], frequency [Hz], cycles."""
SHARES = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Currents over the largest."""
FASTEST = 0.126
"""m/s, of these motions."""
RATE = 500.0
NOISE, OFF, OFFSET = 0.02, 0.3, 20.0
UNKNOWN, WITHIN = 0.025, 0.05
DRAWS = 20


class RecoveryRow(TypedDict):
    """A parameter: its truth, what was found, its declared uncertainty and its error, both over its size."""

    name: str
    truth: float
    found: float
    uncertainty: float
    error: float


class Recovery(TypedDict):
    """What came back of a damper; noise and what the fit leaves in percent, the duration in s."""

    rows: list[RecoveryRow]
    noise: float
    left: float | None
    seconds: float


def list_motions(slow: float) -> list[tuple[str, Array, Array]]:
    """Return name, displacement and velocity every half step of each motion, at speeds times `slow`."""
    found = []
    for amplitude, frequency, cycles in SINES:
        phase = 2.0 * np.pi * frequency * np.arange(int(2 * cycles * RATE / frequency) + 1) / (2.0 * RATE)
        size = slow * amplitude
        found.append(
            (f"{1e3 * size:g}mm_{frequency:g}Hz", size * np.sin(phase), size * 2.0 * np.pi * frequency * np.cos(phase))
        )
    rng = np.random.default_rng(7)
    time = np.arange(int(8.0 * RATE) + 1) / (2.0 * RATE)
    tones, phases = rng.uniform(0.3, 8.0, 30), rng.uniform(0.0, 2.0 * np.pi, 30)
    angle = 2.0 * np.pi * np.outer(time, tones) + phases
    speed = np.sum(np.cos(angle), axis=1)
    reach = slow * FASTEST / np.max(np.abs(speed))
    found.append(("random", reach * np.sin(angle) @ (0.5 / np.pi / tones), reach * speed))
    return found


def make_records(record: DamperRecord, rng: np.random.Generator) -> list[BenchRecord]:
    """Return noisy bench records of a damper.

    Raises:
        RunError: its state ran away.
    """
    specification = find_specification(type(record))
    top = largest_current(record)
    records = []
    for name, x, v in list_motions(min(1.0, specification.max_speed / FASTEST)):
        for share in SHARES[::2] if name == "random" else SHARES:
            force = bench_force(record, x, v, share * top, 20.0, 1.0 / RATE, TemperatureFactors())
            force += NOISE * np.std(force) * rng.standard_normal(len(force))
            title, current = f"{name}, {share * top:g} A", np.full(len(force), share * top)
            records.append(BenchRecord(title, name, RATE, x[::2].copy(), v[::2].copy(), force, current, False, None))
    return records


def largest_current(record: DamperRecord) -> float:
    """Return the largest current in A of a damper's tests."""
    specification = find_specification(type(record))
    return float(min(specification.max_current, law_range(record._asdict(), specification.max_current)))


def state_problem(record: DamperRecord, records: list[BenchRecord]) -> IdentificationProblem:
    """Return the problem of identifying a damper, its own parameters the start."""
    force, stroke, speed = (
        float(np.std(np.concatenate(parts)))
        for parts in zip(*((r.force, r.displacement, r.velocity) for r in records), strict=True)
    )
    scales = Scales(force, stroke, speed, largest_current(record))
    coordinates = Coordinates(record, scales, find_specification(type(record)).fixed, len(SHARES))
    inputs = [prepare_inputs(each, 0.0, False) for each in records]
    return IdentificationProblem(coordinates, inputs, weight_records(records, inputs), False, None)


def draw_damper(model: str, rng: np.random.Generator) -> tuple[DamperRecord, list[BenchRecord]]:
    """Return a damper near the default, and its bench records."""
    start = find_model(model)()
    start = rescale_damper(start, 1.0, largest_current(start))
    offset = {"f0": OFFSET} if "f0" in start._asdict() else {}
    for _ in range(DRAWS):
        plain = Coordinates(
            start,
            Scales(1e3, 0.01, 0.1, largest_current(start)),
            (*find_specification(type(start)).fixed, "f0"),
            len(SHARES),
        )
        vector = plain.to_vector(start)
        change = rng.uniform(-OFF, OFF, len(vector))
        logarithmic = np.array([c.logarithmic for c in plain.components])
        size = np.where(vector == 0.0, 1.0, np.abs(vector))
        moved = np.where(logarithmic, vector + np.log(1.0 + change), vector + change * size)
        record = plain.to_record(np.clip(moved, plain.low, plain.high))._replace(**offset)
        try:
            return record, make_records(record, rng)
        except RunError:
            continue
    raise RunError(f"{model}: no draw is stable")


def reference_sizes(problem: IdentificationProblem, known: Information) -> list[float]:
    """Return the size that a parameter's error counts against: its own, or that of its law."""
    parts, end = problem.coordinates.components, problem.coordinates.end
    found = []
    for part, estimate in zip(parts, known.estimates, strict=True):
        own = abs(estimate.value)
        if part.at is not None:
            law = [
                (p.position or 0, e.value) for p, e in zip(parts, known.estimates, strict=True) if p.field == part.field
            ]
            own = max(abs(value) * end**power for power, value in law) / end ** (part.position or 0)
        found.append(own or float("inf"))
    return found


def recover(model: str) -> Recovery:
    """Return what came back of a damper: every parameter's truth, declared uncertainty and error over its size."""
    rng = np.random.default_rng(zlib.crc32(model.encode()))
    truth, records = draw_damper(model, rng)
    problem = state_problem(truth, records)
    vector = problem.to_vector(BenchModel(truth, TemperatureFactors()))
    with ThreadPoolExecutor() as executor:
        known = compute_information(problem, vector, executor)
    found = identify_records(records, model)
    values = {estimate.name: estimate.value for estimate in found.information.estimates}
    rows: list[RecoveryRow] = [
        {"name": e.name, "truth": e.value, "found": values[e.name], "uncertainty": e.std / size,
         "error": abs(values[e.name] - e.value) / size}
        for e, size in zip(known.estimates, reference_sizes(problem, known), strict=True)
    ]  # fmt: skip
    floor = 100.0 * problem.cost(vector) ** 0.5
    mean = found.mean("train")
    return {"rows": rows, "noise": floor, "left": 100.0 - mean.fit_percent if mean else None, "seconds": found.seconds}


def report(out: Path, models: list[str]) -> None:
    """Make what is not there and print the table."""
    console = Console(width=170)
    table = Table(title="parameters within 5 % of the truth", title_justify="left")
    for column in ("model", "parameters", "identifiable", "recovered", "worst %", "of", "noise %", "left %", "s"):
        table.add_column(column, justify="left" if column in ("model", "of") else "right")
    for model in models:
        path = out / f"{model}.json"
        if not path.exists():
            try:
                write_json(path, recover(model))
            except Exception as error:
                console.print(f"{model}: {type(error).__name__}: {error}")
                continue
        kept: Recovery = json.loads(path.read_text(encoding="utf-8"))
        rows = [row for row in kept["rows"] if row["uncertainty"] <= UNKNOWN]
        worst = max(rows, key=lambda row: row["error"], default=None)
        back = sum(row["error"] <= WITHIN for row in rows)
        counts = str(len(kept["rows"])), str(len(rows)), str(back), f"{100.0 * worst['error']:.2f}" if worst else "nan"
        figures = f"{kept['noise']:.2f}", f"{kept['left']:.2f}", f"{kept['seconds']:.0f}"
        table.add_row(model, *counts, worst["name"] if worst else "-", *figures)
    console.print(table)


def main() -> None:
    """Read the arguments and run."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path("out/identification-recovery"), help="folder of the results")
    parser.add_argument("--models", default="", help="models, joined by commas; all where absent")
    options = parser.parse_args()
    with threadpool_limits(1):
        report(options.out, options.models.split(",") if options.models else names("damper"))


if __name__ == "__main__":
    main()
