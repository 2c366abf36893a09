"""The best nominal of measured records: fitted with every mechanism that takes a share off its gap.

Mechanisms are effects of the library, added one by one while the best of them takes WORTH off the gap. Further effects
are put into the records beside them.
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from real_rigs import STEP, quick, write_part
from rig_records import Addition, Array, CarrierRecords, Nominal
from ruamel.yaml import YAML
from scipy.optimize import least_squares

from seatsim.recordings.gap import pool_runs
from seatsim.recordings.recording import Recording, load_recording
from seatsim.scenario.loading import single
from seatsim.schema.fields import bounds
from seatsim.schema.files import write_whole
from seatsim.schema.registry import find

WORTH = 0.03
"""Share of the gap that a mechanism must take off to stand in a nominal."""
TOLERANCE = 0.05
"""The nominals are fitted to these very records; runs of one rig scatter by about so much."""
LARGEST_CURRENT = 2.0
"""A; so that the supply limits nothing."""
SHARED = ("A", "beta", "gamma")
"""Parameters that are scaled together, so that the yield stays at |z| = 1."""
STEPS = 12


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


def identify(
    recording: Recording, start: Nominal, free: Sequence[str], mechanisms: Sequence[Addition]
) -> tuple[Fit, list[str]]:
    """Return the nominal fitted to all runs, and the names of the mechanisms that it holds."""
    best, kept = fit(recording, start, free, []), list[Addition]()
    while len(kept) < len(mechanisms):
        trials = [(fit(recording, best.nominal, free, [*kept, m]), m) for m in mechanisms if m not in kept]
        next_best, added = min(trials, key=lambda trial: trial[0].gap)
        if next_best.gap > (1.0 - WORTH) * best.gap:
            break
        best, kept = next_best, [*kept, added]
    return best, [name for name, _, _ in kept]


def fit(recording: Recording, start: Nominal, free: Sequence[str], mechanisms: Sequence[Addition]) -> Fit:
    """Return the nominal with its free parameters and those of mechanisms fitted; x counts in starts of each."""
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
        return np.concatenate([(simulated[name] - measured[name]) / np.std(measured[name]) for name in measured])

    found = least_squares(residual, x0, bounds=(low, high), diff_step=np.full(len(x0), STEP), max_nfev=STEPS)
    return Fit(nominal_at(start, free, mechanisms, found.x), float(np.sqrt(np.mean(found.fun**2))))


def nominal_at(start: Nominal, free: Sequence[str], mechanisms: Sequence[Addition], x: Array) -> Nominal:
    """Return the nominal with its free parameters times the first of x, and the mechanisms at the rest."""
    nominal, values = copy.deepcopy(start), iter(x)
    for dotted, factor in zip(free, values, strict=False):
        name, _, key = dotted.partition(".")
        section = nominal["damper"]["parameters"] if name == "damper" else _section(nominal, name)
        for k in SHARED if key == "A" else (key,):
            section[k] = float(f"{section[k] * factor:.5g}")
    rest = iter(x[len(free) :])
    nominal["effects"] = [
        {"effect": effect, "parameters": {**fixed, **{n: float(f"{s * next(rest):.5g}") for n, s in starts.items()}}}
        for effect, fixed, starts in mechanisms
    ]
    return nominal


def _section(nominal: Nominal, name: str) -> dict[str, float]:
    return nominal["plant"] if name == "plant" else nominal["actuator"]


def read_gap(folder: Path) -> tuple[float, str]:
    """Return the gap of an identified carrier and the mechanisms of its nominal."""
    gap, *names = (folder / "identified").read_text().split()
    return float(gap), ", ".join(names)
