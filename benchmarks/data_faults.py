"""Faults of units, signs and offsets put into good recordings: what import, gap and diagnose say of each.

    python benchmarks/data_faults.py [--diagnose 6] [--field DIR]

A seat with hidden parameters (`seatsim blind make`, nothing wrong with it) and a damper bench are written as tables, a
fault is done to all runs of one, and the tables are imported with their nominal scenario. Each command then has to name
the channel and the fault, as an error or in a note; before that they must say nothing about the recordings as they are.
`gap` runs on every case, `diagnose` on those that it refuses at once, and for `--diagnose` others with a short budget.
With `--field` the recordings of a folder must be silent too.
"""

from __future__ import annotations

import argparse
import re
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from ruamel.yaml import YAML

import seatsim
from seatsim.blind.make.make import make
from seatsim.dampers.bouc_wen import BoucWen
from seatsim.importing.importing import import_files
from seatsim.kernel.bench import simulate_current
from seatsim.recordings.quality.examination import examine
from seatsim.recordings.quality.issue import Issue
from seatsim.recordings.recording import load_recording
from seatsim.rig.coil import Coil
from seatsim.schema.errors import InputError
from seatsim.simulation.damper_bench import bench_force

Array = NDArray[np.float64]
Table = Mapping[str, Array]

G, RATE, SECONDS = 9.80665, 500.0, 12.0
SEED, BUDGET = 1, 10.0
TEMPERATURE = 20.0
NOISE = {"displacement": 2e-5, "velocity": 2e-3, "damper_force": 3.0, "coil_current": 0.003, "damper_temperature": 0.1}
PARAMETERS = {"c_a": 500.0, "c_b": 800.0, "alpha_a": 60.0, "alpha_b": 500.0, "k0": 900.0, "x0": 0.0, "f0": 30.0,
              "A": 2000.0, "beta": 1300.0, "gamma": 900.0, "n": 2.0}  # fmt: skip
OFF = 1.01
"""Factor by which the nominal damper is stiffer than that of the bench."""
FLOOR, FRAME, DRIVER = "floor_acceleration", "frame_acceleration", "driver_acceleration"
TRAVEL, FORCE, COIL, COMMAND = "suspension_displacement", "damper_force", "coil_current", "current_command"
STROKE, SPEED, VOLTAGE, WARMTH = "displacement", "velocity", "command_voltage", "damper_temperature"
UNIT, SIGN, OFFSET = r"reads? as|is it in|in degF|in g\b|in kelvin|check its unit", "sign|exchanged", "offset|zero"
GRAVITY, CLOCK, LATE = "gravity", r"apart|Hz", r"late|follows|early"


class Fault(NamedTuple):
    """What is done to channels, the channel in which it is to be found, and a pattern of what is to be said of it."""

    change: Mapping[str, Callable[[Array], Array]]
    channel: str
    says: str


class Sound(NamedTuple):
    """A recording without faults: its folder, its runs as tables, and the map with which these are imported."""

    folder: Path
    tables: Mapping[str, Table]
    map: Mapping[str, object]


def scaled(channel: str, factor: float, says: str = UNIT, offset: float = 0.0) -> Fault:
    """Return the fault of `factor value + offset`."""
    return Fault({channel: lambda values: factor * values + offset}, channel, says)


def shifted(channel: str, offset: float, says: str = OFFSET) -> Fault:
    """Return the fault of a constant in a channel."""
    return scaled(channel, 1.0, says, offset)


def together(*faults: Fault) -> Fault:
    """Return the fault of several channels; it is enough to find the first."""
    return faults[0]._replace(change={name: does for fault in faults for name, does in fault.change.items()})


def late(channel: str, seconds: float) -> Fault:
    """Return the fault of a channel that comes late."""
    return Fault({channel: lambda values: np.roll(values, round(seconds * RATE))}, channel, LATE)


ACCELERATIONS = (FLOOR, FRAME, DRIVER)
SEAT_FAULTS = {
    **{f"{name} in g": scaled(name, 1 / G) for name in ACCELERATIONS},
    **{f"{name} in mm/s^2": scaled(name, 1e3) for name in ACCELERATIONS},
    f"{FRAME} in ft/s^2": scaled(FRAME, 1 / 0.3048),
    **{f"{name} with its sign swapped": scaled(name, -1.0, SIGN) for name in ACCELERATIONS},
    **{f"{name} with gravity": shifted(name, 9.81, GRAVITY) for name in ACCELERATIONS},
    f"{FLOOR} with gravity downwards": shifted(FLOOR, -9.81, GRAVITY),
    f"{DRIVER} in g, with gravity": scaled(DRIVER, 1 / G, UNIT, 1.0),
    f"{FLOOR} in g, with gravity": scaled(FLOOR, 1 / G, UNIT, 1.0),
    "all accelerations with gravity": together(*(shifted(name, 9.81, GRAVITY) for name in ACCELERATIONS)),
    "all accelerations in g": together(*(scaled(name, 1 / G) for name in ACCELERATIONS)),
    "all accelerations swapped": together(*(scaled(name, -1.0, SIGN) for name in ACCELERATIONS)),
    **{f"{name} with 0.5 m/s^2": shifted(name, 0.5) for name in ACCELERATIONS},
    f"{FLOOR} with 2 m/s^2": shifted(FLOOR, 2.0),
    f"{TRAVEL} in mm": scaled(TRAVEL, 1e3), f"{TRAVEL} in cm": scaled(TRAVEL, 1e2),
    f"{TRAVEL} in inch": scaled(TRAVEL, 1 / 0.0254), f"{TRAVEL} with its sign swapped": scaled(TRAVEL, -1.0, SIGN),
    f"{TRAVEL} with 100 mm": shifted(TRAVEL, 0.1), f"{TRAVEL} in mm, with 100 mm": scaled(TRAVEL, 1e3, UNIT, 100.0),
    f"{FORCE} in kN": scaled(FORCE, 1e-3), f"{FORCE} in lbf": scaled(FORCE, 0.224809),
    f"{FORCE} with its sign swapped": scaled(FORCE, -1.0, SIGN), f"{FORCE} with 1 kN": shifted(FORCE, 1e3),
    f"{COMMAND} in mA": scaled(COMMAND, 1e3), f"{COMMAND} with its sign swapped": scaled(COMMAND, -1.0, SIGN),
    f"{COIL} in mA": scaled(COIL, 1e3), f"{COIL} with its sign swapped": scaled(COIL, -1.0, SIGN),
    f"{WARMTH} in kelvin": shifted(WARMTH, 273.15, UNIT), f"{WARMTH} in degF": scaled(WARMTH, 1.8, UNIT, 32.0),
    f"{TRAVEL} 0.2 s late": late(TRAVEL, 0.2), f"{DRIVER} 0.1 s late": late(DRIVER, 0.1),
    "time in ms": scaled("time", 1e3, CLOCK), "time in min": scaled("time", 1 / 60, CLOCK),
}  # fmt: skip
BENCH_FAULTS = {
    f"{STROKE} in mm": scaled(STROKE, 1e3), f"{STROKE} in cm": scaled(STROKE, 1e2),
    f"{STROKE} in inch": scaled(STROKE, 1 / 0.0254), f"{STROKE} with its sign swapped": scaled(STROKE, -1.0, SIGN),
    f"{STROKE} with 100 mm": shifted(STROKE, 0.1),
    f"{SPEED} in mm/s": scaled(SPEED, 1e3), f"{SPEED} with its sign swapped": scaled(SPEED, -1.0, SIGN),
    f"{SPEED} with 0.5 m/s": shifted(SPEED, 0.5),
    "motion swapped": together(scaled(STROKE, -1.0, SIGN), scaled(SPEED, -1.0, SIGN)),
    "motion in mm": together(scaled(STROKE, 1e3), scaled(SPEED, 1e3)),
    f"{FORCE} in kN": scaled(FORCE, 1e-3), f"{FORCE} in lbf": scaled(FORCE, 0.224809),
    f"{FORCE} with its sign swapped": scaled(FORCE, -1.0, SIGN), f"{FORCE} with 3 kN": shifted(FORCE, 3e3),
    f"{VOLTAGE} in mV": scaled(VOLTAGE, 1e3), f"{VOLTAGE} with its sign swapped": scaled(VOLTAGE, -1.0, SIGN),
    f"{COIL} in mA": scaled(COIL, 1e3), f"{COIL} with its sign swapped": scaled(COIL, -1.0, SIGN),
    f"{WARMTH} in kelvin": shifted(WARMTH, 273.15, UNIT), f"{WARMTH} in degF": scaled(WARMTH, 1.8, UNIT, 32.0),
    f"{FORCE} 0.1 s late": late(FORCE, 0.1), "time in ms": scaled("time", 1e3, CLOCK),
}  # fmt: skip


def main() -> None:
    """Print what is said of each fault and how many were named; fail where one is silent, or a good recording not."""
    options = argparse.ArgumentParser()
    options.add_argument("--diagnose", type=int, default=0, help="cases that gap does not refuse, to be diagnosed")
    options.add_argument("--field", type=Path, help="folder of recordings that must be silent")
    options.add_argument("--only", default="", help="only faults with this in their names")
    asked = options.parse_args()
    with tempfile.TemporaryDirectory() as place:
        root = Path(place)
        silent = [f"{each.name}: {issue.sentence}" for each, issue in _doubts(asked.field)]
        total, left = 0, asked.diagnose
        for sound, faults in ((make_seat(root), SEAT_FAULTS), (make_bench(root), BENCH_FAULTS)):
            as_it_is = say_import(sound, sound.tables, sound.folder / "sound")
            silent += [f"{sound.folder.name}, without a fault: {said}" for said in as_it_is]
            for name, fault in ((name, fault) for name, fault in faults.items() if asked.only in name):
                total += 1
                heard = hear(sound, fault, root / f"case-{total}", left > 0)
                left -= "diagnose" in heard and not str(heard["gap"]).startswith("refused")
                print(f"\n{sound.folder.name}: {name}", flush=True)
                for command, said in heard.items():
                    print(f"  {command:9} {said or 'SILENT'}")
                silent += [f"{sound.folder.name}: {name}: {each}" for each, said in heard.items() if not said]
    print(f"\n{total} faults, {total - len({each.rpartition(':')[0] for each in silent})} named by every command")
    print("\n".join(silent))
    raise SystemExit(bool(silent))


def hear(sound: Sound, fault: Fault, folder: Path, wants_diagnosis: bool) -> dict[str, str | None]:
    """Return by command the sentence that names a fault, None where none does."""
    tables = {run: {name: fault.change.get(name, np.asarray)(values) for name, values in table.items()}
              for run, table in sound.tables.items()}  # fmt: skip
    found = {"import": _named(say_import(sound, tables, folder), fault)}
    recording = folder / "recording"
    if not (recording / "recording.yaml").exists():
        return found
    said, refused = say_gap(recording)
    found["gap"] = _named(said, fault)
    if refused and found["gap"]:
        found["gap"] = f"refused: {found['gap']}"
    if refused or wants_diagnosis:
        found["diagnose"] = _named(say_diagnosis(recording), fault)
    return found


def _named(said: Sequence[str], fault: Fault) -> str | None:
    return next((text for text in said if fault.channel in text and re.search(fault.says, text)), None)


def say_import(sound: Sound, tables: Mapping[str, Table], folder: Path) -> list[str]:
    """Return what import says of tables, its errors and warnings first."""
    (folder / "files").mkdir(parents=True)
    for run, table in tables.items():
        pd.DataFrame(table).to_csv(folder / "files" / f"{run}.csv", index=False, float_format="%.9g")
    YAML(typ="safe").dump(sound.map, folder / "map.yaml")
    try:
        found = import_files(
            [folder / "files"], folder / "recording", folder / "map.yaml", str(sound.folder / "nominal.yaml")
        )
    except InputError as error:
        return [str(error)]
    return [issue.sentence for issue in found.doubts if issue.severity != "note" or folder.name != "sound"]


def say_gap(recording: Path) -> tuple[list[str], bool]:
    """Return what gap says of a recording, and whether it refuses it."""
    try:
        return list(seatsim.gap(recording / "nominal.yaml", recording).notes), False
    except InputError as error:
        return [str(error)], True


def say_diagnosis(recording: Path) -> list[str]:
    """Return what diagnose says of a recording."""
    try:
        return seatsim.diagnose(recording, budget=BUDGET).notes
    except InputError as error:
        return [str(error)]


def _doubts(folder: Path | None) -> Iterator[tuple[Path, Issue]]:
    """Yield the issues of every recording of a folder, and of the one that is shipped."""
    shipped = Path(__file__).resolve().parents[1] / "scenarios" / "data" / "recording"
    for each in [shipped, *sorted(path.parent for path in (folder or shipped / "none").glob("*/recording.yaml"))]:
        for issue in examine(load_recording(each)).issues:
            yield each, issue


def make_seat(root: Path) -> Sound:
    """Make the recording of a seat whose nominal scenario is right but for its tolerances."""
    make(1, SEED, root / "seats", root / "sealed", kinds=["none"], processes=1)
    return read_sound((root / "seats" / "case-0001").rename(root / "seat"))


def make_bench(root: Path) -> Sound:
    """Make the recording of a damper bench: random strokes, a voltage in steps, and a nominal that is 1 % off."""
    folder = root / "bench"
    folder.mkdir()
    entry = {"model": "bouc_wen", "parameters": PARAMETERS | {"c_a": OFF * PARAMETERS["c_a"]}}
    nominal = {"damper": entry, "actuator": {"max_current": 1.0, "rate": 130.0}, "temperature": TEMPERATURE}
    YAML(typ="safe").dump(nominal, folder / "nominal.yaml")
    runs = {f"run-{number}": _bench_run(number) for number in (1, 2)}
    for run, table in runs.items():
        pd.DataFrame(table).to_csv(folder / f"{run}.csv", index=False, float_format="%.9g")
    units = {STROKE: "m", SPEED: "m/s", FORCE: "N", VOLTAGE: "V", COIL: "A", WARMTH: "degC"}
    header = {
        "rig": "damper_bench", "sample_rate": RATE, "nominal": "nominal.yaml", "actuator": {"gain": 0.5},
        "runs": [{"name": run, "file": f"{run}.csv"} for run in runs],
        "channels": {name: {"unit": unit, "noise_rms": NOISE.get(name, 0.0)} for name, unit in units.items()},
    }  # fmt: skip
    YAML(typ="safe").dump(header, folder / "recording.yaml")
    return read_sound(folder)


def _bench_run(seed: int) -> Table:
    generator, step = np.random.default_rng(seed), 1.0 / RATE
    time = 0.5 * step * np.arange(2 * round(SECONDS * RATE) + 1)
    tones = [(0.006 / k, 2 * np.pi * 0.6 * k, 2 * np.pi * generator.random()) for k in range(1, 9)]
    fade = 1 - np.exp(-(time**2))
    stroke = fade * sum(size * np.sin(omega * time + phase) for size, omega, phase in tones)
    speed = np.gradient(stroke, 0.5 * step)
    command = generator.choice([0.0, 0.25, 0.5, 0.75, 1.0], 40)[(time / 0.4).astype(int)]
    current = simulate_current(Coil(130.0), command, 0.5 * step, command[0])
    force = bench_force(BoucWen(**PARAMETERS), stroke, speed, current, TEMPERATURE, step)
    warm = TEMPERATURE + 0.02 * time
    exact = {STROKE: stroke[::2], SPEED: speed[::2], FORCE: force, COIL: current[::2], WARMTH: warm[::2]}
    noisy = {name: values + NOISE[name] * generator.standard_normal(len(values)) for name, values in exact.items()}
    return {"time": time[::2], **noisy, VOLTAGE: command[::2] / 0.5}


def read_sound(folder: Path) -> Sound:
    """Return a recording as tables with a column of time, and the map that imports them in SI units."""
    recording = load_recording(folder)
    tables = {}
    for run in recording.runs:
        table = recording.table(run)
        tables[run] = {"time": np.arange(len(next(iter(table.values())))) / recording.header.sample_rate, **table}
    channels = {name: {"column": name, "unit": entry.unit, "noise_rms": entry.noise_rms}
                for name, entry in recording.channels.items()}  # fmt: skip
    stated: dict[str, object] = {"rig": recording.header.rig, "channels": channels}
    stated["time"] = {"column": "time", "unit": "s"}
    if recording.voltage_gain is not None:
        stated["actuator"] = {"gain": recording.voltage_gain}
    return Sound(folder, tables, stated)


if __name__ == "__main__":
    main()
