"""What reads files of others, each with valid files and the names of those that are changed."""

from __future__ import annotations

import gzip
import io
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from seatsim.blind.score.verdicts import read_verdict
from seatsim.importing.importing import import_files
from seatsim.importing.inspection import inspect_file
from seatsim.provenance.statement import read_manifest
from seatsim.recordings.bench_tables import load_bench
from seatsim.recordings.recording import load_recording
from seatsim.scenario.loading import load, single
from seatsim.sweeps.execute import prepare

from ..importing import exports

EXAMPLES = Path(__file__).resolve().parents[2] / "scenarios"
RECORDING, BENCH = EXAMPLES / "data" / "recording", EXAMPLES / "data" / "bench"
SHORT_ROWS, FEW_ROWS = 600, 200
DIAGNOSIS = Path(__file__).with_name("diagnosis.json").read_bytes()
"""A `diagnosis.json`."""
MANIFEST = Path(__file__).with_name("manifest.json").read_bytes()
"""The manifest of a command."""
MAP = Path(__file__).with_name("map.yaml").read_bytes()
"""A map for the import of a table."""


class Reader(NamedTuple):
    """Something that reads: the valid files, which of them are changed, and the call on their folder."""

    files: Mapping[str, bytes]
    changed: tuple[str, ...]
    read: Callable[[Path], object]


def make_readers() -> dict[str, Reader]:
    """Return all readers with their valid files."""
    scenario = (EXAMPLES / "quickstart.yaml").read_bytes()
    seat = (EXAMPLES / "laws.yaml").read_bytes()
    table = b"".join(gzip.decompress((RECORDING / "run-1.csv.gz").read_bytes()).splitlines(keepends=True)[:SHORT_ROWS])
    recorded = {name: (RECORDING / name).read_bytes() for name in ("recording.yaml", "nominal.yaml")}
    recorded |= {f"run-{number}.csv.gz": gzip.compress(table, 1) for number in (1, 2)}
    bench = next(path for path in sorted(BENCH.glob("*.csv*")))
    rows = bench.read_bytes() if bench.suffix == ".csv" else gzip.decompress(bench.read_bytes())
    rows = b"".join(rows.splitlines(keepends=True)[:SHORT_ROWS])
    sweep = b"scenario: quickstart.yaml\nseed: 1\ndesign: lhs\nruns: 10\n"
    sweep += b"vary:\n  plant.driver_mass: {normal: [80, 12], low: 50}\n"
    floor = b"time,up\n" + b"".join(b"%.3f,%d\n" % (0.005 * row, row * 37 % 11 - 5) for row in range(SHORT_ROWS))
    measured = scenario[: scenario.index(b"excitation:")]
    measured += b"excitation: {kind: table, path: floor.csv, column: up, time_column: time, duration: 1.0}\n"
    beside = {"quickstart.yaml": scenario}
    readers = {
        "scenario": ({"a.yaml": scenario}, "a.yaml", lambda folder: load(folder / "a.yaml")),
        "variants": ({"a.yaml": seat}, "a.yaml", lambda folder: load(folder / "a.yaml")),
        "recording": (recorded, "recording.yaml nominal.yaml", _read_recording),
        "table": (recorded, "run-1.csv.gz", _read_recording),
        "bench": ({"a.csv": rows}, "a.csv", lambda folder: load_bench(folder / "a.csv")),
        "sweep": ({"a.yaml": sweep} | beside, "a.yaml", lambda folder: prepare(folder / "a.yaml")),
        "floor": ({"a.yaml": measured, "floor.csv": floor}, "a.yaml floor.csv", _read_floor),
        "map": ({"a.csv": table, "map.yaml": MAP}, "map.yaml", _import_by_map),
        "diagnosis": ({"a.json": DIAGNOSIS}, "a.json", lambda folder: read_verdict(folder / "a.json")),
        "manifest": ({"manifest.json": MANIFEST}, "manifest.json", read_manifest),
    } | {
        f"format {name}": ({name: content}, name, lambda folder, name=name: inspect_file(folder / name))
        for name, content in make_formats(table).items()
    }
    return {name: Reader(files, tuple(changed.split()), read) for name, (files, changed, read) in readers.items()}


def _read_recording(folder: Path) -> object:
    recording = load_recording(folder)
    return [recording.table(run) for run in recording.runs], recording.nominal


def _read_floor(folder: Path) -> object:
    scenario = single(folder / "a.yaml")
    return None if scenario.excitation is None else scenario.excitation.floor(scenario.solver.step, scenario.seed)


def _import_by_map(folder: Path) -> object:
    return import_files([folder / "a.csv"], folder / "imported", folder / "map.yaml")


def make_formats(table: bytes) -> dict[str, bytes]:
    """Return the first rows of the table in every format that is imported, by `tests/importing/exports.py`."""

    frame = pd.read_csv(io.BytesIO(table)).head(FEW_ROWS)
    columns = {"time": 0.002 * np.arange(FEW_ROWS)} | {name: frame[name].to_numpy() for name in exports.UNITS}
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        for name, write in exports.FORMATS.items():
            write(folder / name, columns)
        return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}
