"""One seat recording in many formats: the same numbers after import, and the same diagnosis.

    python benchmarks/import_formats.py [--formats german.csv a.mf4 v73.mat]

A seat with one hidden effect (`seatsim blind make`) is written as other programs export it (by
`tests/importing/exports.py`), imported without a map, given the noise of its sensors and diagnosed. It fails where a
number differs by more than 1e-6 of its channel, or a verdict, an effect or a parameter from those of the first format.
"""

from __future__ import annotations

import argparse
import importlib
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from ruamel.yaml import YAML

import seatsim
from seatsim.blind.make.make import make
from seatsim.importing.importing import import_files
from seatsim.recordings.recording import Recording, load_recording

ROOT = Path(__file__).resolve().parents[1]
SEED, BUDGET = 3, 300.0
DEFAULT = ("a.csv", "german.csv", "a.mf4", "v73.mat")
SAME, CLOSE = 1e-6, 1e-2
"""Largest difference of a number over the standard deviation of its channel, and of a parameter over itself."""


def main() -> None:
    """Print verdict and effects by format, and fail where they differ."""
    sys.path.insert(0, str(ROOT))
    exports: Any = importlib.import_module("tests.importing.exports")
    options = argparse.ArgumentParser()
    options.add_argument("--formats", nargs="+", default=DEFAULT, choices=exports.FORMATS)
    with tempfile.TemporaryDirectory() as place:
        original = make_seat(Path(place), list(exports.UNITS))
        found = {}
        for name in options.parse_args().formats:
            folder = Path(place) / f"from-{name}"
            off = import_runs(original, exports.FORMATS[name], name, folder, list(exports.UNITS))
            diagnosis = seatsim.diagnose(folder, budget=BUDGET)
            found[name] = (diagnosis.verdict, {cause.effect: numbers(cause) for cause in selected(diagnosis)})
            print(f"{name:12} numbers differ by {off:.1e}; {found[name][0]}: {found[name][1]}", flush=True)
            assert off < SAME, name
    first, *others = found.values()
    for verdict, effects in others:
        assert verdict == first[0] and effects.keys() == first[1].keys()
        for effect, parameters in effects.items():
            for key, value in parameters.items():
                assert is_close(value, first[1][effect][key]), (effect, key)
    print(f"the same diagnosis from {len(found)} formats")


def is_close(value: Any, expected: Any) -> bool:
    """Say whether two values of a parameter are the same, numbers up to `CLOSE`."""
    return bool(value == expected or np.isclose(value, expected, rtol=CLOSE))


def selected(diagnosis: seatsim.Diagnosis) -> list[Any]:
    """Return the causes that the diagnosis chose."""
    return [cause for cause in diagnosis.causes if cause.effect in diagnosis.selected]


def numbers(cause: Any) -> dict[str, float | str]:
    """Return the parameters of a cause without their standard deviations."""
    return {key: each if isinstance(each, str) else round(each.value, 5) for key, each in cause.parameters.items()}


def make_seat(place: Path, channels: list[str]) -> Recording:
    """Return the first made recording of a seat with one effect that has all these channels."""
    seed = SEED
    while True:
        make(1, seed, place / f"seat-{seed}", place / f"sealed-{seed}", kinds=["one"], processes=1)
        recording = load_recording(place / f"seat-{seed}" / "case-0001")
        if set(channels) <= set(recording.channels):
            return recording
        seed += 1


def import_runs(original: Recording, export: Any, name: str, folder: Path, channels: list[str]) -> float:
    """Export all runs, import them with the noise of their sensors; return the largest difference of a number."""
    files = folder.with_name(f"files-{name}")
    files.mkdir()
    for run in original.runs:
        table = original.table(run)
        rows = len(table[channels[0]])
        times = np.arange(rows) / original.header.sample_rate
        export(files / f"{run}.{name.partition('.')[2]}", {"time": times, **{each: table[each] for each in channels}})
    import_files([files], folder, nominal=str(original.nominal))
    path, yaml = folder / "recording.yaml", YAML(typ="safe")
    header = yaml.load(path)
    for each, entry in header["channels"].items():
        entry["noise_rms"] = original.channels[each].noise_rms
    yaml.dump(header, path)
    imported = load_recording(folder)
    pairs = [(original.table(run)[each], imported.table(run)[each]) for run in original.runs for each in channels]
    return max(float(np.max(np.abs(one - other)) / np.std(one)) for one, other in pairs)


if __name__ == "__main__":
    main()
