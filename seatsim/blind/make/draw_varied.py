"""Draws a rig unlike any other: seat, damper, sample rate, colour of the noise, floor, tolerance, background force."""

from __future__ import annotations

import dataclasses
import math
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from seatsim.blind.make import draw_experiment as standard
from seatsim.blind.make.materiality import COARSE_STEP, CommandedRuns
from seatsim.blind.truth import coil
from seatsim.blind.truth.excitation import NoiseColour, draw_current_steps, draw_vehicle, draw_vehicle_floor
from seatsim.blind.truth.experiment import Experiment, RunPlan, simulate_run
from seatsim.blind.truth.faults import Changes, FrameForce
from seatsim.schema.arrays import Array

SAMPLE_RATES = (256.0, 400.0, 500.0, 512.0, 800.0, 1000.0)
"""Hz, of common loggers."""
_SMALLEST_TOLERANCE, _LARGEST_TOLERANCE = 0.01, 0.05
_NOISE_FACTOR = 2.0
"""Largest factor by which a channel's noise is above or below that of the usual sensors."""
_BACKGROUND_SHARE = 1.0 / 3.0
"""Share of the rigs that have a force on the frame beside the floor, and a repeated run that shows it."""
BACKGROUND = (0.01, 0.03)
"""Rms of that force over that of the force between floor and frame."""
LARGEST_BACKGROUND = 0.8
"""Materiality of that force: as strong as it were an effect it would be `floor.unmeasured_input`, and no background."""
_OFFSET_SHARE = 0.4
"""Share of the Bouc-Wen dampers whose accumulator has a nominal stiffness and force."""
STEEPEST = 8000.0
"""Largest rate at which a regularised yield force may stop the frame, 1/s; the steps of the truth resolve it."""
_FEEDBACK_GAIN = 2.0
"""By which the feedback's gains are above those of the standard rig, whose floor has more low frequencies."""
LEAST_VISCOUS = 250.0
"""N s/m; below it a damper in a mount with play is stiffer than the steps of the truth resolve."""


class _SeatKind(NamedTuple):
    """Ranges of a kind of seat."""

    frame: tuple[float, float]  # kg
    resonance: tuple[float, float]  # Hz, of frame and driver on the suspension
    damper_ratio: tuple[float, float]  # stroke of the damper per suspension displacement


_SEATS = (
    _SeatKind((14.0, 28.0), (1.2, 2.2), (1.0, 1.0)),  # car seat on a suspension
    _SeatKind((28.0, 60.0), (1.0, 1.6), (0.4, 0.8)),  # truck seat on a scissor
    _SeatKind((22.0, 45.0), (1.1, 2.0), (0.8, 1.0)),  # tractor seat
)
_DRIVER = (50.0, 110.0)
"""kg."""
_CUSHION_RESONANCE, _CUSHION_DAMPING = (3.5, 6.5), (0.12, 0.4)
"""Hz, and damping ratio, of the driver on the cushion."""
_SUSPENSION_DAMPING = (0.03, 0.15)
"""Damping ratio of the suspension without its damper."""
_STANDARD_MASS = standard.PLANT["ms"] + standard.PLANT["m"]
"""kg, to which the standard damper fits."""


def draw_varied_experiment(rng: Generator, bingham: bool, channels: tuple[str, ...]) -> Experiment:
    """Draw a rig and its protocol; a third of them have a background force and a repeated run."""
    rate, tolerance = float(rng.choice(SAMPLE_RATES)), _log_uniform(rng, _SMALLEST_TOLERANCE, _LARGEST_TOLERANCE)
    tolerance = float(f"{tolerance:.2g}")
    nominal = draw_nominal(rng, bingham)
    noise = {
        name: float(f"{value * _log_uniform(rng, 1.0 / _NOISE_FACTOR, _NOISE_FACTOR):.3g}")
        for name, value in standard.noise_of(channels).items()
    }
    true = standard.scatter_parameters(nominal, rng, tolerance) | standard.draw_heat(rng)
    colours = {name: _draw_colour(rng) for name in noise}
    experiment = Experiment(nominal, true, channels, noise, (), (), rate, tolerance, colours)
    repeat = rng.random() < _BACKGROUND_SHARE
    experiment = dataclasses.replace(experiment, runs=_draw_runs(rng, experiment, repeat))
    return _add_background(experiment, rng) if repeat else experiment


def _log_uniform(rng: Generator, low: float, high: float) -> float:
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def draw_nominal(rng: Generator, bingham: bool) -> dict[str, float]:
    """Draw the parameters of seat, damper and coil, rounded to three digits as an owner states them."""
    seat = _SEATS[int(rng.integers(len(_SEATS)))]
    plant = _draw_plant(rng, seat)
    ratio = round(rng.uniform(*seat.damper_ratio), 2)
    damper = _draw_damper(rng, plant, ratio, bingham)
    coil = {"rate": _log_uniform(rng, 60.0, 250.0), "i_max": standard.COIL["i_max"]}
    rounded = {name: float(f"{value:.3g}") for name, value in (plant | damper | coil).items()}
    return rounded | {"damper_ratio": ratio}


def _draw_plant(rng: Generator, seat: _SeatKind) -> dict[str, float]:
    """Draw masses, and from natural frequencies and damping ratios the springs and dampings."""
    ms, m = rng.uniform(*seat.frame), rng.uniform(*_DRIVER)
    w, cushion = (2.0 * math.pi * rng.uniform(*band) for band in (seat.resonance, _CUSHION_RESONANCE))
    suspension = {"kf": (ms + m) * w * w, "cf": 2.0 * rng.uniform(*_SUSPENSION_DAMPING) * (ms + m) * w}
    seated = {"kc": m * cushion * cushion, "cc": 2.0 * rng.uniform(*_CUSHION_DAMPING) * m * cushion}
    return {"ms": ms, "m": m, **suspension, **seated}


def _draw_damper(rng: Generator, plant: dict[str, float], ratio: float, bingham: bool) -> dict[str, float]:
    """Draw a damper that fits the seat.

    The standard damper's force goes with the mass that it damps over the ratio, its viscous part over the ratio
    squared, and each part is off by up to a factor of 1.5.
    """
    size = (plant["ms"] + plant["m"]) / _STANDARD_MASS / ratio
    powers = {"c_a": 2.0, "c_b": 2.0, "y_a": 1.0, "y_b": 1.0}
    damper = {
        name: standard.BOUC_WEN[name] * size / ratio ** (power - 1.0) * _log_uniform(rng, 1.0 / 1.5, 1.5)
        for name, power in powers.items()
    }
    damper["c_a"] = max(damper["c_a"], LEAST_VISCOUS)
    if bingham:
        steepest = ratio**2 * (damper["y_a"] + damper["y_b"]) / (STEEPEST * plant["ms"])
        return damper | {"is_bingham": 1.0, "f0": 0.0, "v_ref": max(steepest, 0.002) * _log_uniform(rng, 1.0, 4.0)}
    slope, share = _log_uniform(rng, 500.0, 2500.0), rng.uniform(0.3, 0.7)
    offset = rng.random() < _OFFSET_SHARE
    hysteresis = {"A": slope, "beta": share * slope, "gamma": (1.0 - share) * slope, "n": float(rng.integers(1, 3))}
    k0 = size * rng.uniform(100.0, 800.0) if offset else 0.0
    f0 = size * rng.uniform(-40.0, 40.0) if offset else 0.0
    return damper | {"is_bingham": 0.0, **hysteresis, "x0": 0.0, "k0": k0, "f0": f0}


def _draw_colour(rng: Generator) -> NoiseColour:
    """Draw the colour of a sensor's noise: 40-80 % of its variance is white."""
    left = rng.uniform(0.2, 0.6)
    flicker = left * rng.uniform(0.1, 0.6)
    return NoiseColour(flicker, _log_uniform(rng, 0.5, 10.0), left - flicker, _log_uniform(rng, 3.0, 60.0))


def _draw_runs(rng: Generator, experiment: Experiment, repeat: bool) -> tuple[RunPlan, ...]:
    """Draw three runs of one vehicle on different roads, the first again where `repeat`, and the unseen one."""
    rate, vehicle, top = experiment.sample_rate, draw_vehicle(rng), rng.uniform(0.8, 1.0)
    starts = standard.draw_temperatures(rng, 4)
    schedule = np.array([coil.SCHEDULE, 0.0, 0.0, 0.0, 0.0, 0.0])
    laws = [schedule, *_fit_laws(standard.draw_laws(rng), experiment), schedule]
    if rng.random() < standard.STEPPED:
        laws = [schedule] * 4
    runs = []
    for k, (name, law) in enumerate(zip(("run-a", "run-b", "run-c", "run-u"), laws, strict=True)):
        seconds = standard.UNSEEN_SECONDS if name == "run-u" else standard.SECONDS
        floor = draw_vehicle_floor(rng, vehicle, seconds, rng.uniform(0.05, 0.6))
        currents = draw_current_steps(rng, round(seconds * rate), top, rate)
        runs.append(RunPlan(name, floor, law, currents, starts[k]))
    again = [dataclasses.replace(runs[0], name="run-d", repeat_of="run-a")] if repeat else []
    return (*runs[:3], *again, runs[3])


def _fit_laws(laws: tuple[Array, Array], experiment: Experiment) -> tuple[Array, Array]:
    """Return skyhook and feedback for this rig.

    The feedback assumes the standard damper, so its forces are scaled to it; on real floors it asks for more of them.
    """
    skyhook, feedback = laws
    nominal = experiment.nominal
    scale = _FEEDBACK_GAIN * _STANDARD_MASS / (nominal["ms"] + nominal["m"]) * nominal["damper_ratio"]
    return skyhook, np.concatenate([feedback[:2], scale * feedback[2:]])


def _add_background(experiment: Experiment, rng: Generator) -> Experiment:
    """Return the experiment with a random force on the frame, a share of that between floor and frame, not material."""
    motions = [simulate_run(experiment, Changes(), k, step=COARSE_STEP) for k in range(len(experiment.runs) - 1)]
    carried = experiment.true["ms"] * motions[0].frame + experiment.true["m"] * motions[0].driver
    rms = rng.uniform(*BACKGROUND) * float(np.std(carried))
    force = FrameForce("coloured", rms, int(rng.integers(1, 10**6)))
    runs = CommandedRuns(experiment, [motion.command for motion in motions])
    size, _ = runs.materiality(Changes(frame_forces=(force,)), Changes())
    weaker = dataclasses.replace(force, rms=rms * min(1.0, LARGEST_BACKGROUND / size))
    return dataclasses.replace(experiment, background=(weaker,))
