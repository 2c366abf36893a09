"""Sealed cases on measured recordings."""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from real_rigs import quick, write_part
from rig_records import Array, RigRecords, dyke, quanser, utfsm
from ruamel.yaml import YAML
from scipy.optimize import least_squares

from seatsim.recordings.gap import pool_runs
from seatsim.recordings.recording import Recording, load_recording
from seatsim.scenario.loading import single
from seatsim.schema.files import write_whole

WORTH = 0.03
"""Share of the gap that a mechanism must take off to stand in a nominal."""
STEP = 1e-3
SOLE = ("A", "beta", "gamma")


class Mechanism(NamedTuple):
    """An effect that a nominal may hold: fixed parameters, and free ones with start, scale and bounds."""

    effect: str
    fixed: Mapping[str, float | str]
    free: Mapping[str, tuple[float, float, float, float]]


GAS = Mechanism(
    "damper.gas_spring", {}, {"preload": (20.0, 50.0, -500.0, 500.0), "stiffness": (100.0, 500.0, 0.0, 1e5)}
)
ASYMMETRY = Mechanism("damper.asymmetry", {}, {"viscous": (0.02, 0.1, -0.6, 0.6), "yielding": (0.02, 0.1, -0.6, 0.6)})
SATURATION = Mechanism("damper.magnetic_saturation", {}, {"bend": (0.3, 0.5, 0.0, 5.0)})
SEAL = Mechanism("damper.seal_friction", {"presliding": 1e-4}, {"force": (10.0, 20.0, 0.0, 500.0)})
RUBBING = Mechanism("suspension.friction", {"presliding": 1e-4}, {"force": (10.0, 20.0, 0.0, 500.0)})


class Identified(NamedTuple):
    """A nominal scenario with its gap to the recording it was fitted to."""

    nominal: dict[str, object]
    gap: float


def identify(
    recording: Recording, start: Mapping[str, object], free: Sequence[str], mechanisms: Sequence[Mechanism]
) -> Identified:
    """Return a nominal fitted to all runs of a recording, with those mechanisms that make it better by WORTH."""
    path = recording.nominal
    found = fit_nominal(recording, start, free, [])
    kept: list[Mechanism] = []
    while True:
        trials = [(fit_nominal(recording, found.nominal, free, [*kept, m]), m) for m in mechanisms if m not in kept]
        if not trials:
            return found
        best, added = min(trials, key=lambda t: t[0].gap)
        print(
            "   ",
            [m.effect for m in kept],
            "+",
            added.effect,
            round(found.gap, 4),
            "->",
            round(best.gap, 4),
            flush=True,
        )
        if best.gap > (1.0 - WORTH) * found.gap:
            write_whole(path, partial(YAML(typ="safe").dump, found.nominal))
            return found
        found, kept = best, [*kept, added]


def fit_nominal(
    recording: Recording, start: Mapping[str, object], free: Sequence[str], mechanisms: Sequence[Mechanism]
) -> Identified:
    """Return the scenario with its free parameters and those of mechanisms fitted to a recording."""
    base = {k: v for k, v in start.items() if k != "effects"}
    known = {e["effect"]: e["parameters"] for e in start.get("effects", [])}
    numbers = [float(lookup(base, name)) for name in free]
    extra = [(k, name, *values) for k, m in enumerate(mechanisms) for name, values in m.free.items()]
    x0 = [1.0] * len(free) + [known.get(mechanisms[k].effect, {}).get(name, s) / c for k, name, s, c, _, _ in extra]
    low = [0.05] * len(free) + [l / c for _, _, _, c, l, _ in extra]
    high = [20.0] * len(free) + [h / c for _, _, _, c, _, h in extra]

    def content(x: Array) -> dict[str, object]:
        nominal = copy.deepcopy(base)
        for name, value, factor in zip(free, numbers, x, strict=False):
            put(nominal, name, value, float(factor))
        effects = [{"effect": m.effect, "parameters": dict(m.fixed)} for m in mechanisms]
        for (k, name, _, c, _, _), value in zip(extra, x[len(free) :], strict=True):
            effects[k]["parameters"][name] = float(f"{value * c:.5g}")
        return nominal | ({"effects": effects} if effects else {})

    def residual(x: Array) -> Array:
        settings = content(x)
        measured, simulated = pool_runs(single(recording.nominal, settings), recording, list(recording.runs))
        return np.concatenate([(simulated[n] - measured[n]) / np.std(measured[n]) for n in measured])

    x0 = np.clip(x0, np.array(low) + 1e-6, np.array(high) - 1e-6)
    found = least_squares(residual, x0, bounds=(low, high), diff_step=1e-3, max_nfev=12, x_scale=1.0)
    return Identified(content(found.x), float(np.sqrt(np.mean(found.fun**2))))


def lookup(content: Mapping[str, object], dotted: str) -> float:
    node = content
    for key in dotted.split("."):
        node = node[key]
    return node


def put(content: dict[str, object], dotted: str, value: float, factor: float) -> None:
    *path, key = dotted.split(".")
    node = content
    for part in path:
        node = node[part]
    if key == "A":
        scale = factor * value / node["A"]
        for name in SOLE:
            node[name] = float(f"{node[name] * scale:.5g}")
        return
    node[key] = float(f"{factor * value:.5g}")


def carriers(data: Path) -> list[tuple[RigRecords, tuple[str, ...], tuple[Mechanism, ...]]]:
    """Return records with what is free in their nominals."""
    bench = tuple(f"damper.parameters.{k}" for k in ("c_a", "c_b", "alpha_a", "alpha_b", "A"))
    plant = tuple(
        f"plant.{k}" for k in ("suspension_stiffness", "suspension_damping", "cushion_stiffness", "cushion_damping")
    )
    d = dyke(data, "dyke", 130.0)
    whole = list({**d.fit, **d.runs, **d.unseen}.values())
    joined = {c: np.concatenate([t[c] for t in whole]) for c in whole[0]}
    n = round(4.1 * 751.2)
    pieces = {f"piece-{k}": {c: v[k * n : (k + 1) * n] for c, v in joined.items()} for k in range(6)}
    low = utfsm(data, "utfsm-low", (0.0, 0.25, 0.5))
    q = quanser(data, "quanser", ("frame_acceleration", "driver_acceleration", "suspension_displacement"))
    seats = {k: {c: v[:9000:2] for c, v in t.items()} for k, t in {**q.fit, **q.runs}.items()}
    every = utfsm(data, "utfsm", (0.0, 0.25, 0.5, 0.75, 1.0))
    return [
        (d._replace(fit={}, unseen={}, runs=pieces), (*bench, "actuator.rate"), (GAS, ASYMMETRY)),
        (low._replace(runs={**low.fit, **low.runs, **low.unseen}), bench, (GAS, ASYMMETRY, SATURATION)),
        (every._replace(runs={**every.fit, **every.runs, **every.unseen}), bench, (GAS, ASYMMETRY, SATURATION)),
        (q._replace(runs=seats, sample_rate=250.0), plant, (RUBBING,)),
    ]


def build(rig: RigRecords, free: Sequence[str], mechanisms: Sequence[Mechanism], folder: Path) -> Identified:
    where = folder / rig.name
    nominal = copy.deepcopy(rig.nominal)
    if rig.kind == "damper_bench":
        nominal["actuator"]["max_current"] = 2.0
    write_part(rig, nominal, rig.runs, where)
    recording = quick(load_recording(where))
    found = identify(recording, nominal, free, mechanisms)
    write_whole(where / "nominal.yaml", partial(YAML(typ="safe").dump, found.nominal))
    return found


if __name__ == "__main__":
    import sys, time

    for rig, free, mech in carriers(Path("/work/shared/data")):
        t = time.time()
        f = build(rig, free, mech, Path(sys.argv[1]))
        print(rig.name, f.gap, f.nominal, time.time() - t, flush=True)
