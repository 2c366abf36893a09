"""Draws a rig under test and its protocol: parameters, channels, noise, temperatures and runs.

It is a plain rig, which is always the same seat, or one unlike any other: seat, damper, sample rate, colour of the
noise, floor, tolerance, background force.
"""

import math
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from seatsim.blind.make.materiality import COARSE_STEP, EXACT, CommandedRuns, zero_scales
from seatsim.blind.truth import coil, excitation
from seatsim.blind.truth.experiment import CHANNELS, Experiment, RunPlan, simulate_run
from seatsim.blind.truth.faults import Changes, FrameForce
from seatsim.blind.truth.rig import SAMPLE_RATE
from seatsim.schema.arrays import Array
from seatsim.schema.fields import read_packaged

SECONDS = 24.0
"""Of a recorded run: about 30 periods of the suspension, as a drive over one stretch of road gives."""
UNSEEN_SECONDS = 14.0
_SCATTER = 0.015
"""Largest relative error of a nominal parameter; inside the stated tolerance of 2 %, so a faultless rig is one."""
_STEPPED = 0.4
"""Share of the rigs whose current is stepped in every run, not controlled in some."""
_SCHEDULED = np.array([coil.SCHEDULE, 0.0, 0.0, 0.0, 0.0, 0.0])
"""The law of runs whose current is stepped."""
_STARTS, _HOT = (20.0, 30.0, 45.0, 60.0), (55.0, 75.0)
"""Temperatures of the damper at which runs start, to within 2 K, and the range of the one that is hot, degC."""


class _Rigs(NamedTuple):
    """Nominal parameters of the plain rig, how dampers warm up, and kinds of seats, as `rigs.yaml` explains them."""

    plant: dict[str, float]
    coil: dict[str, float]
    bingham: dict[str, float]
    bouc_wen: dict[str, float]
    heat: dict[str, tuple[float, float]]
    seats: list[list[tuple[float, float]]]


RIGS = read_packaged(Path(__file__).with_name("rigs.yaml"), _Rigs)


def _scatter_parameters(nominal: Mapping[str, float], rng: Generator, width: float = _SCATTER) -> dict[str, float]:
    """Return true parameters: each nominal one off by up to `width`, those at zero by that share of their scale.

    Every parameter takes one number of the generator, also those that stay exact.
    """
    true, scales = dict(nominal), zero_scales(nominal)
    for name, value in nominal.items():
        off = width * rng.uniform(-1.0, 1.0)
        if name not in EXACT:
            true[name] = value * (1.0 + off) if value else off * scales.get(name, 0.0)
    return true


def draw_experiment(rng: Generator, bingham: bool, channels: tuple[str, ...]) -> Experiment:
    """Draw a rig and its protocol."""
    nominal = RIGS.plant | (RIGS.bingham if bingham else RIGS.bouc_wen) | RIGS.coil
    true = _scatter_parameters(nominal, rng) | _draw_heat(rng)
    level = rng.uniform(0.85, 1.2)
    # noise is stated to three digits, and drawn as stated
    noise = {name: float(f"{value * level:.3g}") for name, value in noise_of(channels).items()}
    return Experiment(nominal, true, channels, noise, _draw_runs(rng))


def noise_of(channels: Collection[str]) -> dict[str, float]:
    """Return the rms of the usual sensors' noise, of the channels that have some."""
    return {name: channel.noise for name, channel in CHANNELS.items() if name in channels and channel.noise}


def _draw_heat(rng: Generator) -> dict[str, float]:
    """Draw how the damper warms up, which its thermometer shows whether or not it fades; names of `RigParameters`."""
    own = rng.spawn(1)[0]  # so that all else that is drawn is as it would be without
    return {name: own.uniform(low, high) for name, (low, high) in RIGS.heat.items()}


def _draw_temperatures(rng: Generator, count: int) -> list[float]:
    """Draw the temperature of the damper at the start of each run, degC; the last run is the unseen one.

    A fade needs a hot run among the recorded ones, so every rig has one, whatever is wrong with it.
    """
    own = np.random.default_rng(rng.integers(2**63))
    levels = own.choice(_STARTS, count) + own.uniform(-2.0, 2.0, count)
    levels[own.integers(count - 1)] = own.uniform(*_HOT)
    return [float(level) for level in levels]


def _draw_laws(rng: Generator) -> tuple[Array, Array]:
    """Draw a skyhook and an output feedback: level A, dead band m/s; gains N/m and N s/m."""
    skyhook = [coil.SKYHOOK, round(rng.uniform(0.7, 1.0), 2), rng.uniform(0.002, 0.02), 0.0, 0.0, 0.0]
    stiffness, relative = -rng.uniform(0.0, 1500.0), rng.uniform(0.0, 200.0)
    gains = [stiffness, relative, rng.uniform(900.0, 2200.0), rng.uniform(200.0, 900.0)]
    return np.array(skyhook), np.array([coil.FEEDBACK, 0.9, *gains])


def _draw_runs(rng: Generator) -> tuple[RunPlan, ...]:
    """Draw two runs on roads, one over bumps, and the unseen sweep.

    The order of the draws is part of what a seed means; a set must be the same in every version.
    """
    rows, unseen = round(SECONDS * SAMPLE_RATE), round(UNSEEN_SECONDS * SAMPLE_RATE)
    rms = rng.uniform(1.15, 1.7)
    starts = _draw_temperatures(rng, 4)
    no_current = np.zeros(rows)
    skyhook, feedback = _draw_laws(rng)
    top = rng.uniform(0.8, 1.0)
    road = excitation.draw_road(rng, SECONDS, rms)
    first = RunPlan("run-a", road, _SCHEDULED, excitation.draw_current_steps(rng, rows, top), starts[0])
    laws = [(skyhook, no_current), (feedback, no_current)]
    if rng.random() < _STEPPED:
        laws = [(_SCHEDULED, excitation.draw_current_steps(rng, rows, top)) for _ in laws]
    second = RunPlan("run-b", excitation.draw_road(rng, SECONDS, rms), *laws[0], starts[1])
    third = RunPlan("run-c", excitation.draw_bumps(rng, SECONDS, rng.uniform(6.0, 8.5)), *laws[1], starts[2])
    sweep = excitation.draw_sweep(rng, UNSEEN_SECONDS, 0.9 * rms)
    last = RunPlan("run-u", sweep, _SCHEDULED, excitation.draw_current_steps(rng, unseen, top), starts[3])
    return (first, second, third, last)


SAMPLE_RATES = (256.0, 400.0, 500.0, 512.0, 800.0, 1000.0)
"""Hz, of common loggers."""
_SMALLEST_TOLERANCE, _LARGEST_TOLERANCE = 0.01, 0.05
_NOISE_FACTOR = 2.0
"""Largest factor by which a channel's noise is above or below that of the usual sensors."""
_BACKGROUND_SHARE = 1.0 / 3.0
"""Share of the rigs that have a force on the frame beside the floor, and a repeated run that shows it."""
_BACKGROUND = (0.01, 0.03)
"""Rms of that force over that of the force between floor and frame."""
_LARGEST_BACKGROUND = 0.8
"""Materiality of that force: as strong as it were an effect it would be `floor.unmeasured_input`, and no background."""
_OFFSET_SHARE = 0.4
"""Share of the Bouc-Wen dampers whose accumulator has a nominal stiffness and force."""
_STEEPEST = 8000.0
"""Largest rate at which a regularised yield force may stop the frame, 1/s; the steps of the truth resolve it."""
_FEEDBACK_GAIN = 2.0
"""By which the feedback's gains are above those of the standard rig, whose floor has more low frequencies."""
_LEAST_VISCOUS = 250.0
"""N s/m; below it a damper in a mount with play is stiffer than the steps of the truth resolve."""


_DRIVER = (50.0, 110.0)
"""kg."""
_CUSHION_RESONANCE, _CUSHION_DAMPING = (3.5, 6.5), (0.12, 0.4)
"""Hz, and damping ratio, of the driver on the cushion."""
_SUSPENSION_DAMPING = (0.03, 0.15)
"""Damping ratio of the suspension without its damper."""
_STANDARD_MASS = RIGS.plant["ms"] + RIGS.plant["m"]
"""kg, to which the standard damper fits."""


def draw_varied_experiment(rng: Generator, bingham: bool, channels: tuple[str, ...]) -> Experiment:
    """Draw a rig and its protocol; a third of them have a background force and a repeated run."""
    rate = float(rng.choice(SAMPLE_RATES))
    tolerance = float(f"{_log_uniform(rng, _SMALLEST_TOLERANCE, _LARGEST_TOLERANCE):.2g}")
    nominal = _draw_nominal(rng, bingham)
    factors = {name: _log_uniform(rng, 1.0 / _NOISE_FACTOR, _NOISE_FACTOR) for name in noise_of(channels)}
    noise = {name: float(f"{value * factors[name]:.3g}") for name, value in noise_of(channels).items()}
    true = _scatter_parameters(nominal, rng, tolerance) | _draw_heat(rng)
    colours = {name: _draw_colour(rng) for name in noise}
    experiment = Experiment(nominal, true, channels, noise, (), (), rate, tolerance, colours)
    repeat = rng.random() < _BACKGROUND_SHARE
    experiment = experiment._replace(runs=_draw_varied_runs(rng, experiment, repeat))
    return _add_background(experiment, rng) if repeat else experiment


def _log_uniform(rng: Generator, low: float, high: float) -> float:
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def _draw_nominal(rng: Generator, bingham: bool) -> dict[str, float]:
    """Draw the parameters of seat, damper and coil, rounded to three digits as an owner states them."""
    frame, resonance, ratios = RIGS.seats[int(rng.integers(len(RIGS.seats)))]
    ms, m = rng.uniform(*frame), rng.uniform(*_DRIVER)
    # springs and dampings follow from natural frequencies and damping ratios
    w, cushion = (2.0 * math.pi * rng.uniform(*band) for band in (resonance, _CUSHION_RESONANCE))
    suspension = {"kf": (ms + m) * w * w, "cf": 2.0 * rng.uniform(*_SUSPENSION_DAMPING) * (ms + m) * w}
    seated = {"kc": m * cushion * cushion, "cc": 2.0 * rng.uniform(*_CUSHION_DAMPING) * m * cushion}
    plant = {"ms": ms, "m": m, **suspension, **seated}
    ratio = round(rng.uniform(*ratios), 2)
    damper = _draw_damper(rng, plant, ratio, bingham)
    driver = {"rate": _log_uniform(rng, 60.0, 250.0), "i_max": RIGS.coil["i_max"]}
    rounded = {name: float(f"{value:.3g}") for name, value in (plant | damper | driver).items()}
    return rounded | {"damper_ratio": ratio}


def _draw_damper(rng: Generator, plant: dict[str, float], ratio: float, bingham: bool) -> dict[str, float]:
    """Draw a damper that fits the seat.

    The standard damper's force goes with the mass that it damps over the ratio, its viscous part over the ratio
    squared, and each part is off by up to a factor of 1.5.
    """
    size = (plant["ms"] + plant["m"]) / _STANDARD_MASS / ratio
    powers = {"c_a": 2.0, "c_b": 2.0, "y_a": 1.0, "y_b": 1.0}
    damper = {
        name: RIGS.bouc_wen[name] * size / ratio ** (power - 1.0) * _log_uniform(rng, 1.0 / 1.5, 1.5)
        for name, power in powers.items()
    }
    damper["c_a"] = max(damper["c_a"], _LEAST_VISCOUS)
    if bingham:
        steepest = ratio**2 * (damper["y_a"] + damper["y_b"]) / (_STEEPEST * plant["ms"])
        return damper | {"is_bingham": 1.0, "f0": 0.0, "v_ref": max(steepest, 0.002) * _log_uniform(rng, 1.0, 4.0)}
    slope, share = _log_uniform(rng, 500.0, 2500.0), rng.uniform(0.3, 0.7)
    offset = rng.random() < _OFFSET_SHARE
    hysteresis = {"A": slope, "beta": share * slope, "gamma": (1.0 - share) * slope, "n": float(rng.integers(1, 3))}
    k0 = size * rng.uniform(100.0, 800.0) if offset else 0.0
    f0 = size * rng.uniform(-40.0, 40.0) if offset else 0.0
    return damper | {"is_bingham": 0.0, **hysteresis, "x0": 0.0, "k0": k0, "f0": f0}


def _draw_colour(rng: Generator) -> excitation.NoiseColour:
    """Draw the colour of a sensor's noise: 40-80 % of its variance is white."""
    left = rng.uniform(0.2, 0.6)
    flicker = left * rng.uniform(0.1, 0.6)
    return excitation.NoiseColour(flicker, _log_uniform(rng, 0.5, 10.0), left - flicker, _log_uniform(rng, 3.0, 60.0))


def _draw_varied_runs(rng: Generator, experiment: Experiment, repeat: bool) -> tuple[RunPlan, ...]:
    """Draw three runs of one vehicle on different roads, the first again where `repeat`, and the unseen one."""
    rate, vehicle, top = experiment.sample_rate, excitation.draw_vehicle(rng), rng.uniform(0.8, 1.0)
    starts = _draw_temperatures(rng, 4)
    nominal, (skyhook, feedback) = experiment.nominal, _draw_laws(rng)
    # the feedback assumes the standard damper, so its forces are scaled to this one; a real floor asks for more of them
    scale = _FEEDBACK_GAIN * _STANDARD_MASS / (nominal["ms"] + nominal["m"]) * nominal["damper_ratio"]
    laws = [_SCHEDULED, skyhook, np.concatenate([feedback[:2], scale * feedback[2:]]), _SCHEDULED]
    if rng.random() < _STEPPED:
        laws = [_SCHEDULED] * 4
    runs = []
    for k, (name, law) in enumerate(zip(("run-a", "run-b", "run-c", "run-u"), laws, strict=True)):
        seconds = UNSEEN_SECONDS if name == "run-u" else SECONDS
        floor = excitation.draw_vehicle_floor(rng, vehicle, seconds, rng.uniform(0.05, 0.6))
        currents = excitation.draw_current_steps(rng, round(seconds * rate), top, rate)
        runs.append(RunPlan(name, floor, law, currents, starts[k]))
    again = [runs[0]._replace(name="run-d", repeat_of="run-a")] if repeat else []
    return (*runs[:3], *again, runs[3])


def _add_background(experiment: Experiment, rng: Generator) -> Experiment:
    """Return the experiment with a random force on the frame, a share of that between floor and frame, not material."""
    motions = [simulate_run(experiment, Changes(), k, step=COARSE_STEP) for k in range(len(experiment.runs) - 1)]
    carried = experiment.true["ms"] * motions[0].frame + experiment.true["m"] * motions[0].driver
    rms = rng.uniform(*_BACKGROUND) * float(np.std(carried))
    force = FrameForce("coloured", rms, int(rng.integers(1, 10**6)))
    runs = CommandedRuns(experiment, [motion.command for motion in motions])
    size, _ = runs.materiality(Changes(frame_forces=(force,)), Changes())
    weaker = force._replace(rms=rms * min(1.0, _LARGEST_BACKGROUND / size))
    return experiment._replace(background=(weaker,))
