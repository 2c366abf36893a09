"""Recordings of rigs that nobody here built, and what the diagnosis says of them: `python benchmarks/real_rigs.py`.

Out of `../shared/data` are written, into `--out` or a folder that is thrown away, never into the repository, folders
`NAME`, `NAME-fit` (the records that the nominal was fitted to) and `NAME-unseen`, all with the same nominal;
`rig_records` says what they are.

A nominal is a plain model without what the data are known to show. That this is in the data is shown without the
diagnosis: the effect is added by hand, fitted with the nominal's parameters inside their tolerance to half of the runs,
and judged on the other half and on the unseen records. `calibrated` has the parameters refitted alone.
"""

from __future__ import annotations

import argparse
import copy
import dataclasses
import tempfile
import time
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table
from rig_records import Array, Nominal, RigRecords, Runs, Trial, dyke, fsae, quanser, utfsm
from ruamel.yaml import YAML
from scipy.optimize import least_squares

import seatsim
from seatsim.recordings.gap import pool_runs
from seatsim.recordings.recording import BENCH_CHANNELS, SEAT_CHANNELS, ChannelEntry, Recording, load_recording
from seatsim.recordings.replay import LEFT_OUT
from seatsim.scenario.loading import single
from seatsim.scenario.scenario import Scenario
from seatsim.schema.fields import bounds, replace_fields
from seatsim.schema.files import write_whole
from seatsim.schema.registry import Record, find

DATA = Path(__file__).resolve().parents[2] / "shared" / "data"
TOLERANCE = 0.1
"""Fits to single records scatter by 8-20 % in the leading parameters of the nominals, by more in the others."""
STEP = 1e-3
"""Relative step of the finite differences, above the error of the time integration."""


class RigEvidence(NamedTuple):
    """What an effect added by hand is worth: overall gaps on runs that it was not fitted to, and on unseen records."""

    rig: str
    effects: str
    parameters: str
    floor: float
    nominal: float
    calibrated: float
    held_out: float
    unseen: tuple[float, float] | None

    @property
    def shrink(self) -> float:
        """Share by which the gap on the held-out runs is smaller than the nominal's."""
        return 1.0 - self.held_out / self.nominal


def write(rig: RigRecords, folder: Path) -> Path:
    """Write a rig's three folders with a nominal fitted to the first, and return that of the recording."""
    for part, runs in (("-fit", rig.fit), ("-unseen", rig.unseen), ("", rig.runs)):
        if runs:
            write_part(rig, rig.nominal, runs, folder / f"{rig.name}{part}")
    nominal = fitted(rig, quick(load_recording(folder / f"{rig.name}-fit")))
    for part in ("-fit", "-unseen", ""):
        if (folder / f"{rig.name}{part}").is_dir():
            write_whole(folder / f"{rig.name}{part}" / "nominal.yaml", partial(YAML(typ="safe").dump, nominal))
    return folder / rig.name


def write_part(rig: RigRecords, nominal: Nominal, runs: Runs, folder: Path, tolerance: float = TOLERANCE) -> None:
    """Write some of a rig's records and a nominal as one recording."""
    units = SEAT_CHANNELS if rig.kind == "seat" else BENCH_CHANNELS
    entries = [{"name": name, "file": f"{name}.csv.gz"} for name in runs]
    for entry in entries[1:] if rig.repeats else ():
        entry["repeat_of"] = entries[0]["name"]
    channels = next(iter(runs.values()))
    noise = {name: {"noise_rms": float(f"{rig.noise[name]:.3g}")} if name in rig.noise else {} for name in channels}
    header = {
        "rig": rig.kind, "sample_rate": rig.sample_rate, "parameter_tolerance": tolerance, "nominal": "nominal.yaml",
        "runs": entries, "channels": {name: {"unit": units[name]} | noise[name] for name in channels},
    }  # fmt: skip
    if rig.voltage_gain is not None:
        header["actuator"] = {"gain": rig.voltage_gain}
    for name, table in runs.items():
        frame = pd.DataFrame({"time": np.arange(len(next(iter(table.values())))) / rig.sample_rate, **table})
        write_whole(folder / f"{name}.csv.gz", partial(frame.to_csv, index=False, float_format="%.9g"))
    for file, content in (("nominal.yaml", nominal), ("recording.yaml", header)):
        write_whole(folder / file, partial(YAML(typ="safe").dump, content))


def quick(recording: Recording) -> Recording:
    """Return the recording with a displacement that is interpolated, not smoothed: a fit replays it often."""
    if "displacement" not in recording.channels:
        return recording
    channels = recording.channels | {"displacement": ChannelEntry("m", 0.0)}
    return dataclasses.replace(recording, channels=channels)


def fitted(rig: RigRecords, recording: Recording) -> Nominal:
    """Return the nominal scenario, its free parameters fitted to a recording's counted rows."""
    scenario, skip = recording.nominal, round(LEFT_OUT * rig.sample_rate)
    kept = np.concatenate([rig.counted(recording.table(run))[skip:] for run in recording.runs])

    def residual(factors: Array) -> Array:
        return misfit(varied(scenario, rig.free, factors), recording, list(recording.runs), kept)

    ones = np.ones(len(rig.free))
    found = least_squares(residual, ones, bounds=(0.05 * ones, 20.0 * ones), diff_step=np.full(len(rig.free), STEP)).x
    nominal = copy.deepcopy(rig.nominal)
    for name, factor in zip(rig.free, found, strict=True):
        section, _, key = name.partition(".")
        for k in ("A", "beta", "gamma") if key == "A" else (key,):
            values = nominal["damper"]["parameters"] if section == "damper" else nominal["plant"]
            values[k] = float(f"{values[k] * factor:.5g}")
    return nominal


def misfit(
    scenario: Scenario, recording: Recording, runs: Sequence[str], kept: NDArray[np.bool_] | slice = slice(None)
) -> Array:
    """Return simulated minus measured at the rows kept, in standard deviations of each channel, end to end."""
    measured, simulated = pool_runs(scenario, recording, runs)
    return np.concatenate([(simulated[name] - measured[name])[kept] / np.std(measured[name]) for name in measured])


def varied(scenario: Scenario, names: Sequence[str], factors: Array) -> Scenario:
    """Return the scenario with parameters `section.name` times factors; `damper.A` keeps the yield at |z| = 1."""
    damper, plant = scenario.damper.record, scenario.plant
    for name, factor in zip(names, factors, strict=True):
        section, _, key = name.partition(".")
        if section == "damper":
            keys = ("A", "beta", "gamma") if key == "A" else (key,)
            damper = replace_fields(damper, multiply(damper, keys, float(factor)))
        elif plant is not None:
            plant = replace_fields(plant, multiply(plant, (key,), float(factor)))
    return dataclasses.replace(scenario, damper=dataclasses.replace(scenario.damper, record=damper), plant=plant)


def multiply(record: Record, names: Sequence[str], factor: float) -> dict[str, float]:
    """Return some of the numbers of a record times a factor."""
    numbers = {name: record._asdict()[name] for name in names}
    return {name: value * factor for name, value in numbers.items() if isinstance(value, int | float)}


def by_hand(rig: RigRecords, folder: Path) -> list[RigEvidence]:
    """Fit each trial's effects to every second run, parameters inside their tolerance, and judge them on the others."""
    recording, nominal = load_recording(folder), single(folder / "nominal.yaml")
    other = folder.with_name(f"{rig.name}-unseen")
    seen, held = list(recording.runs)[::2], list(recording.runs)[1::2]
    before, first = seatsim.gap(nominal, recording, held), _unseen(nominal, other)
    calibrated, _ = _augmented(rig, nominal, quick(recording), seen, ())
    refitted, found = seatsim.gap(calibrated, recording, held).overall, []
    for trial in rig.trials:
        augmented, shown = _augmented(rig, nominal, quick(recording), seen, trial)
        after, last = seatsim.gap(augmented, recording, held).overall, _unseen(augmented, other)
        effects = " + ".join(effect for effect, _, _ in trial)
        gaps = before.floor.overall, before.overall, refitted, after
        found.append(
            RigEvidence(rig.name, effects, shown, *gaps, None if first is None or last is None else (first, last))
        )
    return found


def _unseen(scenario: Scenario, folder: Path) -> float | None:
    return seatsim.gap(scenario, folder).overall if folder.is_dir() else None


def _augmented(
    rig: RigRecords, nominal: Scenario, recording: Recording, runs: Sequence[str], trial: Trial
) -> tuple[Scenario, str]:
    free = [(find("effect", effect), name, start) for effect, _, starts in trial for name, start in starts.items()]
    count = len(rig.free)

    def scenario(x: Array) -> Scenario:
        values, effects = iter(x[count:]), []
        for effect, fixed, starts in trial:
            chosen = {name: float(start * next(values)) for name, start in starts.items()}
            effects.append(find("effect", effect)(**fixed, **chosen))
        return dataclasses.replace(varied(nominal, rig.free, x[:count]), effects=tuple(effects))

    limits = [(1.0 - TOLERANCE, 1.0 + TOLERANCE)] * count
    for cls, name, start in free:
        one, other = (limit / start for limit in bounds(cls, name))
        limits.append((min(one, other), max(one, other)))
    low, high = zip(*limits, strict=True)

    def residual(x: Array) -> Array:
        return misfit(scenario(x), recording, runs)

    steps = np.full(len(limits), STEP)
    x = least_squares(residual, np.ones(len(limits)), bounds=(low, high), diff_step=steps).x
    shown = [f"{name} {start * factor:.3g}" for (_, name, start), factor in zip(free, x[count:], strict=True)]
    return scenario(x), ", ".join(shown)


def rigs(data: Path) -> list[RigRecords]:
    """Return all rigs."""
    return [
        utfsm(data, "utfsm", (0.0, 0.25)),
        utfsm(data, "utfsm-all", (0.0, 0.25, 0.5, 0.75, 1.0)),
        dyke(data, "dyke", 1000.0),
        dyke(data, "dyke-130", 130.0),
        fsae(data, "fsae", "t1_3_3_18_18_s5_n100_50psi", 6.0),
        quanser(data, "quanser", ("frame_acceleration", "driver_acceleration", "suspension_displacement")),
        quanser(data, "quanser-travel", ("suspension_displacement",)),
    ]


def nominal_table(folders: Mapping[str, Path], known: Mapping[str, str]) -> Table:
    """Return the gap of each nominal beside its noise floor."""
    table = _table("nominal on the recording's runs", "rig", "runs", "rows", "gap", "noise floor", "known to show")
    for name, folder in folders.items():
        found, recording = seatsim.gap(folder / "nominal.yaml", folder), load_recording(folder)
        rows = sum(len(next(iter(recording.table(run).values()))) for run in recording.runs)
        figures = f"{found.overall:.3f}", f"{found.floor.overall:.3f}"
        table.add_row(name, str(len(recording.runs)), str(rows), *figures, known[name])
    return table


def evidence_table(found: Sequence[RigEvidence]) -> Table:
    """Return what the effects added by hand are worth."""
    columns = ("rig", "effect by hand", "fitted", "floor", "nominal", "calibrated", "with effect", "shrink", "unseen")
    table = _table("effects added by hand, overall gap on held-out runs and unseen records", *columns)
    for f in found:
        unseen = "-" if f.unseen is None else f"{f.unseen[0]:.3f} -> {f.unseen[1]:.3f}"
        gaps = [f"{value:.3f}" for value in (f.floor, f.nominal, f.calibrated, f.held_out)]
        table.add_row(f.rig, f.effects, f.parameters, *gaps, f"{f.shrink:.0%}", unseen)
    return table


def diagnosis_table(folders: Mapping[str, Path], known: Mapping[str, str]) -> Table:
    """Return what the diagnosis says beside what is known."""
    table = _table("diagnosis", "rig", "verdict", "selected", "where", "shrink", "s", "known to show")
    for name, folder in folders.items():
        start = time.perf_counter()
        try:
            found = seatsim.diagnose(folder)
        except seatsim.SeatsimError as error:
            table.add_row(name, "error", str(error), "", "", "", known[name])
            continue
        where = ", ".join(f"{share.block} {share.share:.2f}" for share in found.where)
        seconds, shrink = f"{time.perf_counter() - start:.0f}", f"{found.gap.shrink:.2f}"
        table.add_row(name, found.verdict, ", ".join(found.selected), where, shrink, seconds, known[name])
    return table


def _table(title: str, *columns: str) -> Table:
    table = Table(title=title, title_justify="left")
    for column in columns:
        table.add_column(column)
    return table


def report(data: Path, out: Path, diagnosed: bool) -> None:
    """Write the recordings and print the tables."""
    console = Console(width=180)
    folders, known, found = {}, {}, []
    for rig in rigs(data):
        start = time.perf_counter()
        folders[rig.name], known[rig.name] = write(rig, out), rig.known
        found += by_hand(rig, folders[rig.name])
        values = YAML(typ="safe").load(folders[rig.name] / "nominal.yaml")
        section = values.get("plant", values["damper"]["parameters"])
        console.print(f"{rig.name} ({time.perf_counter() - start:.0f} s): {section}, noise {rig.noise}")
    console.print(nominal_table(folders, known))
    console.print(evidence_table(found))
    console.print(diagnosis_table(folders, known) if diagnosed else "diagnosis left out")


def main() -> None:
    """Read the arguments, write and print."""
    parser = argparse.ArgumentParser(description="recordings of real rigs, and what the diagnosis says of them")
    parser.add_argument("--data", type=Path, default=DATA)
    parser.add_argument("--out", type=Path, help="folder for the recordings; without it they are thrown away")
    parser.add_argument("--no-diagnosis", action="store_true", help="only the recordings and the effects by hand")
    args = parser.parse_args()
    if not args.data.is_dir():
        raise SystemExit(f"{args.data}: the measured data are not there; state their folder with --data")
    with tempfile.TemporaryDirectory() as temporary:
        report(args.data, args.out or Path(temporary), not args.no_diagnosis)


if __name__ == "__main__":
    main()
