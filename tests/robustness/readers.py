"""What reads files of others, each with valid files and the names of those that are changed."""

from __future__ import annotations

import gzip
import io
import tempfile
from collections.abc import Callable, Generator, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from controllers.laws.static_output_feedback import StaticOutputFeedback
from controllers.synthesis import synthesise
from seatsim.blind.score.verdicts import read_verdict
from seatsim.blind.sealed import SEAL, Sealed, seal, unseal
from seatsim.importing.importing import import_files
from seatsim.importing.inspection import inspect_file
from seatsim.metrics.table import METRICS
from seatsim.provenance.statement import read_manifest
from seatsim.recordings.bench_tables import load_bench
from seatsim.recordings.recording import load_recording
from seatsim.report.sweep import report_sweep
from seatsim.rig.coil import Coil
from seatsim.rig.control import prepare_law
from seatsim.rig.plant import Plant
from seatsim.scenario.loading import load, single
from seatsim.sweeps.engines import DONE, Outcome, Work
from seatsim.sweeps.execute import execute, prepare
from seatsim.sweeps.parts import count_exceedances, read_rows, tabulate_quantiles
from seatsim.sweeps.sensitivity import analyse_sensitivity

from ..importing import exports

EXAMPLES = Path(__file__).resolve().parents[2] / "scenarios"
RECORDING, BENCH = EXAMPLES / "data" / "recording", EXAMPLES / "data" / "bench"
SHORT_ROWS, FEW_ROWS = 600, 200
ROWS = "runs/part-000000.parquet"
KEY = "c2VhdHNpbS1mdXp6LXJlYWRlcnMtMzItYnl0ZXMhISE="
"""A key for the sealed file."""
DIAGNOSIS = (
    b'{"verdict": "known", "where": [{"block": "damper", "share": 0.9}], "causes": [{"effect": "damper.remanence",'
    b' "probability": 0.97, "shrink": 0.87, "parameters": {"width": {"value": 0.08, "std": 0.004, "unit": "A"}}}],'
    b' "selected": ["damper.remanence"], "indistinguishable": [], "experiment": null, "held_out": ["run-c"],'
    b' "gap": {"before": {"overall": 0.31, "channels": {"damper_force": 0.4}}, "shrink": 0.87,'
    b' "shrink_interval": [0.82, 0.9]}, "augmented": "augmented.yaml"}'
)
"""A `diagnosis.json`."""
MANIFEST = (
    b'{"seed": 1, "versions": {"seatsim": "0.1.0"}, "platform": {"system": "Linux"}, "command": "comfort",'
    b' "arguments": ["--hours=6.0", "--", "rec"], "directory": "../..", "folder": "c", "own_code": [],'
    b' "inputs": [{"path": "../../rec/recording.yaml", "sha256": "00", "bytes": 4}],'
    b' "outputs": [{"path": "comfort.json", "sha256": "00", "bytes": 4}], "measured": {}}'
)
"""The manifest of a command."""
MAP = (
    b"rig: seat\nsample_rate: 500.0\ncsv: {decimal: '.'}\nruns: {first: [a.csv]}\nalign: {a.csv: 0.25}\nchannels:\n"
    b"  floor_acceleration: {column: floor_acceleration, unit: m/s^2, scale: 1.0, remove_mean: true}\n"
    b"  driver_acceleration: {column: driver_acceleration, unit: m/s^2, sign: -1, delay: 0.002, noise_rms: 0.05}\n"
    b"  suspension_displacement: {column: suspension_displacement, unit: m, offset: 0.001, fill: true}\n"
)
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
    points = b"plant.driver_mass,temperature\n55,20\n75,40\n98,60\n"
    floor = b"time,up\n" + b"".join(b"%.3f,%d\n" % (0.005 * row, row * 37 % 11 - 5) for row in range(SHORT_ROWS))
    measured = scenario[: scenario.index(b"excitation:")]
    measured += b"excitation: {kind: table, path: floor.csv, column: up, time_column: time, duration: 1.0}\n"
    designed = b"scenario: quickstart.yaml\ndesign: table\ntable: points.csv\nlimits: {driver_acceleration_rms: 2}\n"
    beside = {"quickstart.yaml": scenario}
    swept = make_sweep(sweep, beside)
    of_table = {"a.yaml": designed, "points.csv": points} | beside
    readers = {
        "scenario": ({"a.yaml": scenario}, "a.yaml", lambda folder: load(folder / "a.yaml")),
        "variants": ({"a.yaml": seat}, "a.yaml", lambda folder: load(folder / "a.yaml")),
        "recording": (recorded, "recording.yaml nominal.yaml", _read_recording),
        "table": (recorded, "run-1.csv.gz", _read_recording),
        "bench": ({"a.csv": rows}, "a.csv", lambda folder: load_bench(folder / "a.csv")),
        "sweep": ({"a.yaml": sweep} | beside, "a.yaml", lambda folder: prepare(folder / "a.yaml")),
        "design": (of_table, "a.yaml points.csv", lambda folder: prepare(folder / "a.yaml")),
        "floor": ({"a.yaml": measured, "floor.csv": floor}, "a.yaml floor.csv", _read_floor),
        "rows": (swept, f"manifest.json {ROWS}", _read_rows),
        "resumed": (swept, f"manifest.json {ROWS}", _resume),
        "map": ({"a.csv": table, "map.yaml": MAP}, "map.yaml", _import_by_map),
        "synthesis": ({"a.yaml": make_design()}, "a.yaml", _read_design),
        "diagnosis": ({"a.json": DIAGNOSIS}, "a.json", lambda folder: read_verdict(folder / "a.json")),
        "manifest": ({"manifest.json": MANIFEST}, "manifest.json", read_manifest),
        "sealed": (make_sealed(), "sealed folder-seal.txt", _read_sealed),
    } | {
        f"format {name}": ({name: content}, name, lambda folder, name=name: inspect_file(folder / name))
        for name, content in make_formats(table).items()
    }
    return {name: Reader(files, tuple(changed.split()), read) for name, (files, changed, read) in readers.items()}


def _read_design(folder: Path) -> object:
    seat = Plant(20.0, 80.0, 4600.0, 150.0, 6e4, 1500.0)
    return prepare_law(StaticOutputFeedback(design=str(folder / "a.yaml")), seat, Coil(), 0.005)


def _read_recording(folder: Path) -> object:
    recording = load_recording(folder)
    return [recording.table(run) for run in recording.runs], recording.nominal


def _read_floor(folder: Path) -> object:
    scenario = single(folder / "a.yaml")
    return None if scenario.excitation is None else scenario.excitation.floor(scenario.solver.step, scenario.seed)


def _read_rows(folder: Path) -> object:
    rows = read_rows(folder)
    return report_sweep(rows, analyse_sensitivity(rows), count_exceedances(rows)), tabulate_quantiles(rows)


def _resume(folder: Path) -> object:
    return execute(prepare(folder / "a.yaml"), folder, make_up, resume=True)


def _import_by_map(folder: Path) -> object:
    return import_files([folder / "a.csv"], folder / "imported", folder / "map.yaml")


def _read_sealed(folder: Path) -> object:
    (folder / "set").mkdir(exist_ok=True)
    (folder / "folder-seal.txt").rename(folder / "set" / "seal.txt")
    try:
        return unseal(folder / "sealed", KEY, folder / "set")
    finally:
        (folder / "set" / "seal.txt").rename(folder / "folder-seal.txt")
        (folder / "set").rmdir()


def make_formats(table: bytes) -> dict[str, bytes]:
    """Return the first rows of the table in every format that is imported, by `tests/importing/exports.py`."""

    frame = pd.read_csv(io.BytesIO(table)).head(FEW_ROWS)
    columns = {"time": 0.002 * np.arange(FEW_ROWS)} | {name: frame[name].to_numpy() for name in exports.UNITS}
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        for name, write in exports.FORMATS.items():
            write(folder / name, columns)
        return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def make_design() -> bytes:
    """Return a design of a plant of two states."""

    with tempfile.TemporaryDirectory() as place:
        two, one = np.eye(2), np.ones((1, 1))
        found = synthesise(
            np.array([[0.0, 1.0], [-4.0, -0.4]]),
            np.array([[0.0], [1.0]]),
            np.array([[0.0], [1.0]]),
            two,
            two,
            np.zeros((2, 1)),
            0.1 * np.vstack([one, one]),
            np.zeros((2, 1)),
            time_budget=2.0,
        )
        found.save(Path(place) / "design.yaml")
        return (Path(place) / "design.yaml").read_bytes()


def make_sealed() -> dict[str, bytes]:
    """Return a sealed file and the seal of its set."""

    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "set"
        folder.mkdir()
        seal(Path(place) / "sealed", folder, KEY, Sealed({}, {"case-0001": {"run.csv": b"a\n1\n"}}, {"seed": 1}))
        return {"sealed": (Path(place) / "sealed").read_bytes(), "folder-seal.txt": (folder / SEAL).read_bytes()}


def make_sweep(definition: bytes, beside: Mapping[str, bytes]) -> dict[str, bytes]:
    """Return the files of a sweep and of the folder that holds its rows, whose figures are made up."""

    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        for name, content in {"a.yaml": definition, **beside}.items():
            (folder / name).write_bytes(content)
        execute(prepare(folder / "a.yaml"), folder, make_up)
        paths = [path for path in sorted(folder.rglob("*")) if path.is_file()]
        return {path.relative_to(folder).as_posix(): path.read_bytes() for path in paths}


def make_up(work: Work) -> Generator[list[Outcome]]:
    """Yield an outcome for each run of a sweep, as an engine does, without simulating."""

    yield [
        Outcome(run, DONE, "", 1, tuple(1.0 + 0.01 * run * number for number in range(len(METRICS))))
        for runs in work.tasks
        for run in runs
    ]
