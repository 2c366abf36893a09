"""Valid files for the readers: tables in many formats, a map, a design, a diagnosis, a sealed set, a sweep, a unit."""

from __future__ import annotations

import importlib
import io
import sys
import tempfile
import zipfile
from collections.abc import Generator
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from seatsim.sweeps.engines.base import Work
    from seatsim.sweeps.outcome import Outcome

ROOT = Path(__file__).resolve().parents[1]
FEW_ROWS = 200
KEY = "c2VhdHNpbS1mdXp6LXJlYWRlcnMtMzItYnl0ZXMhISE="
"""A key for the sealed file."""


def make_formats(table: bytes) -> dict[str, bytes]:
    """Return the first rows of the table in every format that is imported, by `tests/importing/exports.py`."""
    import numpy as np
    import pandas as pd

    sys.path.insert(0, str(ROOT))
    exports: Any = importlib.import_module("tests.importing.exports")
    frame = pd.read_csv(io.BytesIO(table)).head(FEW_ROWS)
    columns = {"time": 0.002 * np.arange(FEW_ROWS)} | {name: frame[name].to_numpy() for name in exports.UNITS}
    road = 0.01 * np.sin(np.arange(FEW_ROWS) / 9.0)[:, None] * np.ones(3)
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        for name, write in exports.FORMATS.items():
            write(folder / name, columns)
        for kind in ("KRBI", "LRFI"):
            exports.opencrg(folder / f"{kind}.crg", road, kind=kind)
        return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def make_design() -> bytes:
    """Return a design of a plant of two states."""
    import numpy as np

    from controllers.synthesis import synthesise

    with tempfile.TemporaryDirectory() as place:
        two, one = np.eye(2), np.ones((1, 1))
        found = synthesise(
            np.array([[0.0, 1.0], [-4.0, -0.4]]), np.array([[0.0], [1.0]]), np.array([[0.0], [1.0]]), two, two,
            np.zeros((2, 1)), 0.1 * np.vstack([one, one]), np.zeros((2, 1)), time_budget=2.0,
        )  # fmt: skip
        found.save(Path(place) / "design.yaml")
        return (Path(place) / "design.yaml").read_bytes()


def make_diagnosis() -> bytes:
    """Return a `diagnosis.json`."""
    return (
        b'{"verdict": "known", "where": [{"block": "damper", "share": 0.9}], "causes": [{"effect": "damper.remanence",'
        b' "probability": 0.97, "shrink": 0.87, "parameters": {"width": {"value": 0.08, "std": 0.004, "unit": "A"}}}],'
        b' "selected": ["damper.remanence"], "indistinguishable": [], "experiment": null, "held_out": ["run-c"],'
        b' "gap": {"before": {"overall": 0.31, "channels": {"damper_force": 0.4}}, "shrink": 0.87,'
        b' "shrink_interval": [0.82, 0.9]}, "augmented": "augmented.yaml"}'
    )


def make_manifest() -> bytes:
    """Return the manifest of a command."""
    return (
        b'{"seed": 1, "versions": {"seatsim": "0.1.0"}, "platform": {"system": "Linux"}, "command": "comfort",'
        b' "arguments": ["--hours=6.0", "--", "rec"], "directory": "../..", "folder": "c", "own_code": [],'
        b' "inputs": [{"path": "../../rec/recording.yaml", "sha256": "00", "bytes": 4}],'
        b' "outputs": [{"path": "comfort.json", "sha256": "00", "bytes": 4}], "measured": {}}'
    )


def make_sealed() -> dict[str, bytes]:
    """Return a sealed file and the seal of its set."""
    from seatsim.blind.sealed import SEAL, Sealed, seal

    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "set"
        folder.mkdir()
        seal(Path(place) / "sealed", folder, KEY, Sealed({}, {"case-0001": {"run.csv": b"a\n1\n"}}, {"seed": 1}))
        return {"sealed": (Path(place) / "sealed").read_bytes(), "folder-seal.txt": (folder / SEAL).read_bytes()}


def make_map() -> bytes:
    """Return a map for the import of a table."""
    return (
        b"rig: seat\nsample_rate: 500.0\ncsv: {decimal: '.'}\nruns: {first: [a.csv]}\nalign: {a.csv: 0.25}\nchannels:\n"
        b"  floor_acceleration: {column: floor_acceleration, unit: m/s^2, scale: 1.0, remove_mean: true}\n"
        b"  driver_acceleration: {column: driver_acceleration, unit: m/s^2, sign: -1, delay: 0.002, noise_rms: 0.05}\n"
        b"  suspension_displacement: {column: suspension_displacement, unit: m, offset: 0.001, despike: true}\n"
    )


def make_unit() -> bytes:
    """Return a functional mock-up unit with a library that is none."""
    from seatsim.cosimulation.description import DESCRIPTION

    variable = (
        '<ScalarVariable name="{}" valueReference="{}" causality="{}" variability="{}"><Real {}/></ScalarVariable>'
    )
    variables = [("v", 0, "input", "continuous", 'start="0" unit="m/s"'), ("F", 1, "output", "continuous", 'unit="N"'),
                 ("c", 2, "parameter", "tunable", 'start="1" max="5"')]  # fmt: skip
    stated = "".join(variable.format(*each) for each in variables)
    text = f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="d" guid="1"><CoSimulation modelIdentifier="d"/>
<UnitDefinitions><Unit name="N"><BaseUnit kg="1" m="1" s="-2"/></Unit></UnitDefinitions>
<ModelVariables>{stated}</ModelVariables><ModelStructure><Outputs><Unknown index="2"/></Outputs></ModelStructure>
</fmiModelDescription>"""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        archive.writestr(DESCRIPTION, text)
        for folder, ending in (("linux64", "so"), ("darwin64", "dylib"), ("win64", "dll")):
            archive.writestr(f"binaries/{folder}/d.{ending}", "no library")
    return packed.getvalue()


def make_sweep(scenario: bytes, definition: bytes) -> dict[str, bytes]:
    """Return the files of a sweep and of the folder that holds its rows, whose figures are made up."""
    from seatsim.sweeps.execute import execute, prepare

    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        (folder / "quickstart.yaml").write_bytes(scenario)
        (folder / "a.yaml").write_bytes(definition)
        execute(prepare(folder / "a.yaml"), folder, make_up)
        paths = [path for path in sorted(folder.rglob("*")) if path.is_file()]
        return {path.relative_to(folder).as_posix(): path.read_bytes() for path in paths}


def make_up(work: Work) -> Generator[list[Outcome]]:
    """Yield an outcome for each run of a sweep, as an engine does, without simulating."""
    from seatsim.metrics.table import METRICS
    from seatsim.sweeps.outcome import DONE, Outcome

    yield [
        Outcome(run, DONE, "", 1, tuple(1.0 + 0.01 * run * number for number in range(len(METRICS))))
        for runs in work.tasks
        for run in runs
    ]
