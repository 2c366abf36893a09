"""What reads files of others, each with valid files and the names of those that are changed."""

from __future__ import annotations

import gzip
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import NamedTuple

from fuzz_files import (
    KEY,
    make_design,
    make_diagnosis,
    make_formats,
    make_manifest,
    make_map,
    make_sealed,
    make_sweep,
    make_unit,
    make_up,
)

HERE = Path(__file__).resolve().parents[1]
EXAMPLES = HERE / "scenarios"
RECORDING, BENCH = EXAMPLES / "data" / "recording", EXAMPLES / "data" / "bench"
SHORT_ROWS = 600
ROWS = "runs/part-000000.parquet"


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
    sidecar = b"sample_rate_Hz: 500\ntemperature_degC: 20\nnote: a sine of 1 Hz\n"
    sweep = b"scenario: quickstart.yaml\nseed: 1\ndesign: lhs\nruns: 10\n"
    sweep += b"vary:\n  plant.driver_mass: {normal: [80, 12], low: 50}\n"
    design = b"plant.driver_mass,temperature\n55,20\n75,40\n98,60\n"
    formats = make_formats(table)
    rows_of_sweep = make_sweep(scenario, sweep)
    floor = b"time,up\n" + b"".join(b"%.3f,%d\n" % (0.005 * row, row * 37 % 11 - 5) for row in range(SHORT_ROWS))
    measured = scenario[: scenario.index(b"excitation:")]
    measured += b"excitation: {kind: table, path: floor.csv, column: up, time_column: time, duration: 1.0}\n"
    designed = b"scenario: quickstart.yaml\ndesign: table\ntable: points.csv\nlimits: {driver_acceleration_rms: 2}\n"
    return {
        "scenario": Reader({"a.yaml": scenario}, ("a.yaml",), _read_scenario),
        "variants": Reader({"a.yaml": seat}, ("a.yaml",), _read_scenario),
        "recording": Reader(recorded, ("recording.yaml", "nominal.yaml"), _read_recording),
        "table": Reader(recorded, ("run-1.csv.gz",), _read_recording),
        "bench": Reader({"a.csv": rows, "a.yaml": sidecar}, ("a.csv", "a.yaml"), _read_bench),
        "sweep": Reader({"a.yaml": sweep, "quickstart.yaml": scenario}, ("a.yaml",), _read_sweep),
        "design": Reader(
            {"a.yaml": designed, "points.csv": design, "quickstart.yaml": scenario},
            ("a.yaml", "points.csv"),
            _read_sweep,
        ),
        "floor": Reader({"a.yaml": measured, "floor.csv": floor}, ("a.yaml", "floor.csv"), _read_floor),
        "rows": Reader(rows_of_sweep, ("manifest.json", ROWS), _read_rows),
        "resumed": Reader(rows_of_sweep, ("manifest.json", ROWS), _read_resumed),
        "unit": Reader({"a.fmu": make_unit()}, ("a.fmu",), _read_unit),
        "import": Reader({"a.csv": table}, ("a.csv",), _read_import),
        "map": Reader({"a.csv": table, "map.yaml": make_map()}, ("map.yaml",), _read_map),
        **{
            f"format {name}": Reader({name: content}, (name,), partial(_read_format, name))
            for name, content in formats.items()
        },
        "synthesis": Reader({"design.yaml": make_design()}, ("design.yaml",), _read_design),
        "diagnosis": Reader({"diagnosis.json": make_diagnosis()}, ("diagnosis.json",), _read_diagnosis),
        "manifest": Reader({"manifest.json": make_manifest()}, ("manifest.json",), _read_manifest),
        "sealed": Reader(make_sealed(), ("sealed", "folder-seal.txt"), _read_sealed),
    }


def _read_scenario(folder: Path) -> object:
    from seatsim.scenario.loading import load

    return load(folder / "a.yaml")


def _read_recording(folder: Path) -> object:
    from seatsim.recordings.recording import load_recording

    recording = load_recording(folder)
    tables = [recording.table(run) for run in recording.runs]
    return tables, recording.nominal


def _read_bench(folder: Path) -> object:
    from seatsim.recordings.bench_tables import load_bench

    return load_bench(folder / "a.csv")


def _read_sweep(folder: Path) -> object:
    from seatsim.sweeps.execute import prepare

    return prepare(folder / "a.yaml")


def _read_floor(folder: Path) -> object:
    from seatsim.scenario.loading import single

    scenario = single(folder / "a.yaml")
    return None if scenario.excitation is None else scenario.excitation.floor(scenario.solver.step, scenario.seed)


def _read_rows(folder: Path) -> object:
    from seatsim.report.sweep import report_sweep
    from seatsim.sweeps.statistics.rows import count_exceedances, read_rows, tabulate_quantiles
    from seatsim.sweeps.statistics.sensitivity import analyse_sensitivity

    rows = read_rows(folder)
    return report_sweep(rows, tabulate_quantiles(rows), analyse_sensitivity(rows), count_exceedances(rows))


def _read_resumed(folder: Path) -> object:
    from seatsim.sweeps.execute import execute, prepare

    return execute(prepare(folder / "a.yaml"), folder, make_up, resume=True)


def _read_unit(folder: Path) -> object:
    from seatsim.cosimulation.description import check_parameter, describe_unit, find_variable

    unit = describe_unit(folder / "a.fmu")
    variables = find_variable(unit, "v", "input"), find_variable(unit, "F", "output")
    return variables, check_parameter(unit, "c", 2.0)


def _read_map(folder: Path) -> object:
    from seatsim.importing.importing import import_files

    return import_files([folder / "a.csv"], folder / "imported", folder / "map.yaml")


def _read_import(folder: Path) -> object:
    from seatsim.importing.inspection import inspect_file

    return inspect_file(folder / "a.csv")


def _read_format(name: str, folder: Path) -> object:
    from seatsim.importing.inspection import inspect_file

    return inspect_file(folder / name)


def _read_design(folder: Path) -> object:
    from controllers.synthesis.design import Design

    return Design.load(folder / "design.yaml").gamma


def _read_diagnosis(folder: Path) -> object:
    from seatsim.blind.score.verdicts import read_verdict

    return read_verdict(folder / "diagnosis.json")


def _read_manifest(folder: Path) -> object:
    from seatsim.provenance.statement import read_manifest

    return read_manifest(folder)


def _read_sealed(folder: Path) -> object:
    from seatsim.blind.sealed import unseal

    (folder / "set").mkdir(exist_ok=True)
    (folder / "folder-seal.txt").rename(folder / "set" / "seal.txt")
    try:
        return unseal(folder / "sealed", KEY, folder / "set")
    finally:
        (folder / "set" / "seal.txt").rename(folder / "folder-seal.txt")
        (folder / "set").rmdir()
