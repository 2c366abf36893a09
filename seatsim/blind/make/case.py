"""One rig under test: its nominal and its true parameters, channels, noise, temperatures and runs."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from seatsim.blind.truth import commands, roads
from seatsim.blind.truth.rig import FINE, RATE, STEP, Motion, simulate
from seatsim.blind.truth.sensors import readings
from seatsim.blind.truth.slots import Array, record
from seatsim.blind.truth.truth import Changes, Context, Push

SECONDS = 24.0
UNSEEN_SECONDS = 14.0
STEPPED = 0.4
"""Share of the rigs whose current is stepped in every run, not controlled in some."""
COMPARED = ("frame_acceleration", "driver_acceleration", "suspension_displacement", "damper_force", "coil_current")
CHANNELS = (
    "floor_acceleration", "frame_acceleration", "driver_acceleration", "suspension_displacement", "damper_force",
    "current_command", "coil_current", "damper_temperature",
)  # fmt: skip
NOISE = {
    "floor_acceleration": 0.01, "frame_acceleration": 0.03, "driver_acceleration": 0.015,
    "suspension_displacement": 5e-5, "damper_force": 2.5, "coil_current": 0.003, "damper_temperature": 0.1,
}  # fmt: skip
PLANT = {"ms": 20.0, "m": 80.0, "kf": 4600.0, "cf": 150.0, "kc": 60000.0, "cc": 1500.0}
COIL = {"rate": 130.0, "i_max": 1.0}
BOUC_WEN = {
    "is_bingham": 0.0, "c_a": 250.0, "c_b": 350.0, "y_a": 45.0, "y_b": 620.0, "k0": 0.0, "x0": 0.0, "f0": 0.0,
    "A": 2000.0, "beta": 1000.0, "gamma": 1000.0, "n": 2.0,
}  # fmt: skip
BINGHAM = {"is_bingham": 1.0, "c_a": 250.0, "c_b": 350.0, "y_a": 45.0, "y_b": 620.0, "f0": 0.0, "v_ref": 0.004}
EXACT = ("is_bingham", "n", "i_max")
ZERO_SCALE = {"k0": PLANT["kf"], "x0": 0.01, "f0": 100.0}


@dataclass(frozen=True)
class RunPlan:
    """Excitation and control of a run; `temperature` of the damper at its start, degC."""

    name: str
    floor: Array
    law: Array
    schedule: Array
    temperature: float
    repeat_of: str | None = None

    @property
    def rows(self) -> int:
        """Rows of the table."""
        return self.schedule.size


@dataclass(frozen=True)
class Setting:
    """A rig and its protocol before any effect; the last run is the unseen one."""

    nominal: Mapping[str, float]
    true: Mapping[str, float]
    channels: tuple[str, ...]
    noise: Mapping[str, float]
    runs: tuple[RunPlan, ...]
    background: tuple[Push, ...] = ()

    @property
    def compared(self) -> tuple[str, ...]:
        """Recorded outputs that a gap compares."""
        return tuple(name for name in COMPARED if name in self.channels)


def scattered(nominal: Mapping[str, float], rng: Generator, width: float = 0.015) -> dict[str, float]:
    """Return true parameters: each nominal one off by up to `width`, those at zero by that share of their scale."""
    true = dict(nominal)
    for name, value in nominal.items():
        off = width * rng.uniform(-1.0, 1.0)
        if name not in EXACT:
            true[name] = value * (1.0 + off) if value else off * ZERO_SCALE.get(name, 0.0)
    return true


def _temperatures(rng: Generator, warm: bool, count: int) -> list[float]:
    if not warm and rng.random() < 0.65:
        return [20.0] * count
    levels = rng.choice([30.0, 45.0, 60.0], count) + rng.uniform(-2.0, 2.0)
    if warm:
        levels[rng.integers(count - 1)] = rng.uniform(55.0, 75.0)
    return [float(level) for level in levels]


def _plans(rng: Generator, warm: bool, repeat: bool) -> tuple[RunPlan, ...]:
    rows, unseen = round(SECONDS * RATE), round(UNSEEN_SECONDS * RATE)
    rms = rng.uniform(1.15, 1.7)
    hot = _temperatures(rng, warm, 4)
    off = np.zeros(rows)
    schedule = np.array([commands.SCHEDULE, 0.0, 0.0, 0.0, 0.0, 0.0])
    skyhook = np.array([commands.SKYHOOK, round(rng.uniform(0.7, 1.0), 2), rng.uniform(0.002, 0.02), 0.0, 0.0, 0.0])
    feedback = np.array(
        [commands.FEEDBACK, 0.9, -rng.uniform(0.0, 1500.0), rng.uniform(0.0, 200.0), rng.uniform(900.0, 2200.0),
         rng.uniform(200.0, 900.0)]
    )  # fmt: skip
    top = rng.uniform(0.8, 1.0)
    first = RunPlan("run-a", roads.road(rng, SECONDS, rms), schedule, roads.steps(rng, rows, top), hot[0])
    laws = [(skyhook, off), (feedback, off)]
    if rng.random() < STEPPED:
        laws = [(schedule, roads.steps(rng, rows, top)) for _ in laws]
    second = RunPlan("run-b", roads.road(rng, SECONDS, rms), *laws[0], hot[1])
    third = RunPlan("run-c", roads.bumps(rng, SECONDS, rng.uniform(6.0, 8.5)), *laws[1], hot[2])
    again = (dataclasses.replace(first, name="run-d", repeat_of="run-a"),) if repeat else ()
    last = RunPlan(
        "run-u", roads.sweep(rng, UNSEEN_SECONDS, 0.9 * rms), schedule, roads.steps(rng, unseen, top), hot[3]
    )
    return (first, second, third, *again, last)


def draw_setting(
    rng: Generator, bingham: bool, channels: tuple[str, ...], warm: bool = False, scatter: float = 0.015,
    background: float = 0.0,
) -> Setting:  # fmt: skip
    """Draw a rig and its protocol; `background` is the rms of a random force on the frame, N (shown by a repeat)."""
    nominal = PLANT | (BINGHAM if bingham else BOUC_WEN) | COIL
    true = scattered(nominal, rng, scatter)
    level = rng.uniform(0.85, 1.2)
    noise = {name: float(f"{value * level:.3g}") for name, value in NOISE.items() if name in channels}
    pushes = (Push("coloured", background, int(rng.integers(1, 10**6))),) if background else ()
    return Setting(nominal, true, channels, noise, _plans(rng, warm, bool(background)), pushes)


def _push_of(setting: Setting, changes: Changes, run: int) -> Array:
    seconds = setting.runs[run].rows / RATE
    total = np.zeros(round(seconds * FINE))
    for push in (*setting.background, *changes.pushes):
        rng = np.random.default_rng([push.seed, run])
        match push.kind:
            case "coloured":
                total += push.rms * roads.coloured_push(rng, seconds)
            case "hum":
                total += push.rms * roads.hum_push(rng, seconds, push.detail)
            case _:
                total += push.rms * roads.knock_push(rng, seconds, push.detail)
    return total if setting.background or changes.pushes else np.zeros(1)


def drive(
    setting: Setting, changes: Changes, run: int, command: Array | None = None, floor: Array | None = None,
    step: float = STEP,
) -> Motion:  # fmt: skip
    """Move the true rig through a run; with `command` (one per row) the loop is open; `floor` is given at the rows."""
    plan = setting.runs[run]
    values = dict(setting.true) | {"t_start": plan.temperature, "t_ambient": plan.temperature}
    for name, value in changes.slots.items():
        number = value[min(run, len(value) - 1)] if isinstance(value, tuple) else value
        if name == "rate_factor":
            values["rate"] *= number
        else:
            values[name] = number
    law, schedule = (plan.law, plan.schedule) if command is None else (np.zeros(6), command)
    ground, rate = (plan.floor, FINE) if floor is None else (floor, RATE)
    pushes = _push_of(setting, changes, run)
    return simulate(record(values), ground, pushes, law, schedule, schedule.size, rate, step)


def read(setting: Setting, changes: Changes, run: int, motion: Motion) -> dict[str, Array]:
    """Return what the recorded channels show of a motion, without noise."""
    shown = readings(motion, setting.runs[run].floor, changes.faults, run)
    return {name: shown[name] for name in CHANNELS}


def context_of(setting: Setting, shown: list[dict[str, Array]]) -> Context:
    """Return what truth forms may know, from the rig without them."""
    pooled = {name: np.concatenate([run[name] for run in shown]) for name in CHANNELS}
    driver = pooled["driver_acceleration"]
    mass, stiffness = setting.nominal["m"], setting.nominal["kc"]
    return Context(
        spread={name: float(np.std(values)) for name, values in pooled.items()},
        x_peak=float(np.max(np.abs(pooled["suspension_displacement"]))),
        y_peak=mass * float(np.max(driver)) / stiffness,
        tension_peak=mass * float(np.max(-driver)),
        channels=setting.channels,
        is_bingham=setting.nominal["is_bingham"] == 1.0,
    )
