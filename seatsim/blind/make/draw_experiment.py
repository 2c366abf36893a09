"""Draws a rig under test and its protocol: parameters, channels, noise, temperatures and runs."""

from __future__ import annotations

import dataclasses
from collections.abc import Collection, Mapping

import numpy as np
from numpy.random import Generator

from seatsim.blind.truth import coil
from seatsim.blind.truth.excitation import draw_bumps, draw_current_steps, draw_road, draw_sweep
from seatsim.blind.truth.experiment import CHANNELS, Experiment, RunPlan
from seatsim.blind.truth.faults import FrameForce
from seatsim.blind.truth.rig import SAMPLE_RATE
from seatsim.schema.arrays import Array

SECONDS = 24.0
"""Of a recorded run: about 30 periods of the suspension, as a drive over one stretch of road gives."""
UNSEEN_SECONDS = 14.0
SCATTER = 0.015
"""Largest relative error of a nominal parameter; inside the stated tolerance of 2 %, so a faultless rig is one."""
STEPPED = 0.4
"""Share of the rigs whose current is stepped in every run, not controlled in some."""
_STARTS, _HOT = (20.0, 30.0, 45.0, 60.0), (55.0, 75.0)
"""Temperatures of the damper at which runs start, to within 2 K, and the range of the one that is hot, degC."""
PLANT = {"ms": 20.0, "m": 80.0, "kf": 4600.0, "cf": 150.0, "kc": 60000.0, "cc": 1500.0}
COIL = {"rate": 130.0, "i_max": 1.0}
_FORCES = {"c_a": 250.0, "c_b": 350.0, "y_a": 45.0, "y_b": 620.0}
BINGHAM = {"is_bingham": 1.0, **_FORCES, "f0": 0.0, "v_ref": 0.004}
_HYSTERESIS = {"A": 2000.0, "beta": 1000.0, "gamma": 1000.0, "n": 2.0}
BOUC_WEN = {"is_bingham": 0.0, **_FORCES, "k0": 0.0, "x0": 0.0, "f0": 0.0, **_HYSTERESIS}
EXACT = ("is_bingham", "n", "i_max", "damper_ratio")
"""Parameters that are choices, not measurements, and are never off."""


def zero_scales(nominal: Mapping[str, float]) -> dict[str, float]:
    """Return what a relative error refers to where the nominal value is zero (contract, section 3)."""
    return {"k0": nominal["kf"], "x0": 0.01, "f0": 100.0}


def scatter_parameters(nominal: Mapping[str, float], rng: Generator, width: float = SCATTER) -> dict[str, float]:
    """Return true parameters: each nominal one off by up to `width`, those at zero by that share of their scale.

    Every parameter takes one number of the generator, also those that stay exact.
    """
    true, scales = dict(nominal), zero_scales(nominal)
    for name, value in nominal.items():
        off = width * rng.uniform(-1.0, 1.0)
        if name not in EXACT:
            true[name] = value * (1.0 + off) if value else off * scales.get(name, 0.0)
    return true


def draw_experiment(
    rng: Generator, bingham: bool, channels: tuple[str, ...], scatter: float = SCATTER, background: float = 0.0
) -> Experiment:
    """Draw a rig and its protocol; `background` is the rms of a force on the frame, N, which a repeated run shows."""
    nominal = PLANT | (BINGHAM if bingham else BOUC_WEN) | COIL
    true = scatter_parameters(nominal, rng, scatter) | draw_heat(rng)
    level = rng.uniform(0.85, 1.2)
    # noise is stated to three digits, and drawn as stated
    noise = {name: float(f"{value * level:.3g}") for name, value in noise_of(channels).items()}
    forces = (FrameForce("coloured", background, int(rng.integers(1, 10**6))),) if background else ()
    return Experiment(nominal, true, channels, noise, _draw_runs(rng, bool(background)), forces)


def noise_of(channels: Collection[str]) -> dict[str, float]:
    """Return the rms of the usual sensors' noise, of the channels that have some."""
    return {name: channel.noise for name, channel in CHANNELS.items() if name in channels and channel.noise}


def draw_heat(rng: Generator) -> dict[str, float]:
    """Draw how the damper warms up, which its thermometer shows whether or not it fades; names of `RigParameters`."""
    own = rng.spawn(1)[0]  # so that all else that is drawn is as it would be without
    ranges = {
        "fluid_heat": (25.0, 90.0),
        "housing_heat": (120.0, 400.0),
        "thermometer_time": (1.0, 5.0),
        "fluid_to_housing": (1.5, 4.0),
        "housing_to_air": (0.4, 1.5),
    }
    return {name: own.uniform(low, high) for name, (low, high) in ranges.items()}


def draw_temperatures(rng: Generator, count: int) -> list[float]:
    """Draw the temperature of the damper at the start of each run, degC; the last run is the unseen one.

    A fade needs a hot run among the recorded ones, so every rig has one, whatever is wrong with it.
    """
    own = np.random.default_rng(rng.integers(2**63))
    levels = own.choice(_STARTS, count) + own.uniform(-2.0, 2.0, count)
    levels[own.integers(count - 1)] = own.uniform(*_HOT)
    return [float(level) for level in levels]


def draw_laws(rng: Generator) -> tuple[Array, Array]:
    """Draw a skyhook and an output feedback: level A, dead band m/s; gains N/m and N s/m."""
    skyhook = [coil.SKYHOOK, round(rng.uniform(0.7, 1.0), 2), rng.uniform(0.002, 0.02), 0.0, 0.0, 0.0]
    stiffness, relative = -rng.uniform(0.0, 1500.0), rng.uniform(0.0, 200.0)
    gains = [stiffness, relative, rng.uniform(900.0, 2200.0), rng.uniform(200.0, 900.0)]
    return np.array(skyhook), np.array([coil.FEEDBACK, 0.9, *gains])


def _draw_runs(rng: Generator, repeat: bool) -> tuple[RunPlan, ...]:
    """Draw two runs on roads, one over bumps, the first again where `repeat`, and the unseen sweep.

    The order of the draws is part of what a seed means; a set must be the same in every version.
    """
    rows, unseen = round(SECONDS * SAMPLE_RATE), round(UNSEEN_SECONDS * SAMPLE_RATE)
    rms = rng.uniform(1.15, 1.7)
    starts = draw_temperatures(rng, 4)
    no_current = np.zeros(rows)
    schedule = np.array([coil.SCHEDULE, 0.0, 0.0, 0.0, 0.0, 0.0])
    skyhook, feedback = draw_laws(rng)
    top = rng.uniform(0.8, 1.0)
    first = RunPlan("run-a", draw_road(rng, SECONDS, rms), schedule, draw_current_steps(rng, rows, top), starts[0])
    laws = [(skyhook, no_current), (feedback, no_current)]
    if rng.random() < STEPPED:
        laws = [(schedule, draw_current_steps(rng, rows, top)) for _ in laws]
    second = RunPlan("run-b", draw_road(rng, SECONDS, rms), *laws[0], starts[1])
    third = RunPlan("run-c", draw_bumps(rng, SECONDS, rng.uniform(6.0, 8.5)), *laws[1], starts[2])
    again = (dataclasses.replace(first, name="run-d", repeat_of="run-a"),) if repeat else ()
    sweep = draw_sweep(rng, UNSEEN_SECONDS, 0.9 * rms)
    last = RunPlan("run-u", sweep, schedule, draw_current_steps(rng, unseen, top), starts[3])
    return (first, second, third, *again, last)
