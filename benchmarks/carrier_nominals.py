"""Measured records written as recordings, with nominals that are fitted to them.

A carrier's nominal holds every mechanism that takes a share off its gap: effects of the library, added one by one while
the best of them takes WORTH off. Further effects are put into the records beside them.
"""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from rig_records import Addition, CarrierRecords, Nominal, RigRecords, Runs
from ruamel.yaml import YAML
from scipy.optimize import least_squares

from seatsim.recordings.gap import pool_runs
from seatsim.recordings.recording import BENCH_CHANNELS, SEAT_CHANNELS, ChannelEntry, Recording, load_recording
from seatsim.scenario.loading import single
from seatsim.schema.arrays import Array
from seatsim.schema.fields import bounds
from seatsim.schema.files import write_whole
from seatsim.schema.registry import find

DATA = Path(__file__).resolve().parents[2] / "shared" / "data"
STEP = 1e-3
"""Relative step of the finite differences, above the error of the time integration."""
WORTH = 0.03
"""Share of the gap that a mechanism must take off to stand in a nominal."""
TOLERANCE = 0.05
"""The nominals are fitted to these very records; runs of one rig scatter by about so much."""
LARGEST_CURRENT = 2.0
"""A; so that the supply limits nothing."""
SHARED = ("A", "beta", "gamma")
"""Parameters that are scaled together, so that the yield stays at |z| = 1."""
STEPS = 12


def require_data(folder: Path) -> Path:
    """Return the folder of the measured data, or end where it is not there."""
    if not folder.is_dir():
        raise SystemExit(f"{folder}: the measured data are not there; state their folder with --data")
    return folder


class Fit(NamedTuple):
    """A nominal with its gap to the records."""

    nominal: Nominal
    gap: float


def write_carrier(carrier: CarrierRecords, folder: Path) -> Path:
    """Write records with their best nominal as a recording in `folder`/NAME and return that; an old one is kept."""
    rig, out = carrier.rig, folder / carrier.rig.name
    if (out / "identified").is_file():
        return out
    nominal = copy.deepcopy(rig.nominal)
    if rig.kind == "damper_bench":
        nominal["actuator"]["max_current"] = LARGEST_CURRENT
    write_part(rig, nominal, rig.runs, out, TOLERANCE)
    found, kept = identify(quick(load_recording(out)), nominal, rig.free, carrier.mechanisms)
    write_whole(out / "nominal.yaml", partial(YAML(typ="safe").dump, found.nominal))
    write_whole(out / "identified", lambda part: part.write_text(f"{found.gap:.4f} {' '.join(kept)}\n"))
    return out


def write_part(rig: RigRecords, nominal: Nominal, runs: Runs, folder: Path, tolerance: float) -> None:
    """Write some of a rig's records and a nominal as one recording."""
    units = SEAT_CHANNELS if rig.kind == "seat" else BENCH_CHANNELS
    entries = [{"name": name, "file": f"{name}.csv.gz"} for name in runs]
    for entry in entries[1:] if rig.repeats else ():
        entry["repeat_of"] = entries[0]["name"]
    channels = next(iter(runs.values()))
    noise = {name: {"noise_rms": float(f"{rig.noise[name]:.3g}")} if name in rig.noise else {} for name in channels}
    header: dict[str, object] = {"rig": rig.kind, "sample_rate": rig.sample_rate, "parameter_tolerance": tolerance}
    header |= {"nominal": "nominal.yaml", "runs": entries}
    header["channels"] = {name: {"unit": units[name]} | noise[name] for name in channels}
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


def identify(
    recording: Recording, start: Nominal, free: Sequence[str], mechanisms: Sequence[Addition]
) -> tuple[Fit, list[str]]:
    """Return the nominal fitted to all runs, and the names of the mechanisms that it holds."""
    best, kept = fit(recording, start, free), list[Addition]()
    while len(kept) < len(mechanisms):
        trials = [(fit(recording, best.nominal, free, [*kept, m]), m) for m in mechanisms if m not in kept]
        next_best, added = min(trials, key=lambda trial: trial[0].gap)
        if next_best.gap > (1.0 - WORTH) * best.gap:
            break
        best, kept = next_best, [*kept, added]
    return best, [name for name, _, _ in kept]


def fit(
    recording: Recording,
    start: Nominal,
    free: Sequence[str],
    mechanisms: Sequence[Addition] = (),
    counted: NDArray[np.bool_] | slice = slice(None),
) -> Fit:
    """Return the nominal with its free parameters and those of mechanisms fitted to the rows counted.

    x counts in starts of each parameter.
    """
    known = {entry["effect"]: entry["parameters"] for entry in start.get("effects", [])}
    x0, low, high = [1.0] * len(free), [0.05] * len(free), [20.0] * len(free)
    for effect, _, starts in mechanisms:
        for name, value in starts.items():
            least, most = sorted(limit / value for limit in bounds(find("effect", effect), name))
            begin = float(known.get(effect, {}).get(name, 0.1 * value)) / value
            x0.append(min(max(begin, least), most))
            low.append(least)
            high.append(most)

    def residual(x: Array) -> Array:
        scenario = single(recording.nominal_file, nominal_at(start, free, mechanisms, x))
        measured, simulated = pool_runs(scenario, recording, list(recording.runs))
        return np.concatenate([((simulated[n] - measured[n]) / np.std(measured[n]))[counted] for n in measured])

    found = least_squares(residual, x0, bounds=(low, high), diff_step=np.full(len(x0), STEP), max_nfev=STEPS)
    return Fit(nominal_at(start, free, mechanisms, found.x), float(np.sqrt(np.mean(found.fun**2))))


def nominal_at(start: Nominal, free: Sequence[str], mechanisms: Sequence[Addition], x: Array) -> Nominal:
    """Return the nominal with its free parameters times the first of x, and the mechanisms at the rest."""
    nominal, values = copy.deepcopy(start), iter(x)
    for dotted, factor in zip(free, values, strict=False):
        name, _, key = dotted.partition(".")
        section = nominal["damper"]["parameters"] if name == "damper" else nominal[name]
        for k in SHARED if key == "A" else (key,):
            section[k] = float(f"{section[k] * factor:.5g}")
    rest = iter(x[len(free) :])
    nominal["effects"] = [
        {"effect": effect, "parameters": {**fixed, **{n: float(f"{s * next(rest):.5g}") for n, s in starts.items()}}}
        for effect, fixed, starts in mechanisms
    ]
    return nominal


def read_gap(folder: Path) -> tuple[float, str]:
    """Return the gap of an identified carrier and the mechanisms of its nominal."""
    gap, *names = (folder / "identified").read_text().split()
    return float(gap), ", ".join(names)
