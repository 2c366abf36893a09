"""Where a gap lies: the forces that a simulation lacks so that its motion is the measured one.

A force p on the frame and l on the driver are found, by iteration, that make the free-running simulation move as the
rig did. With r what is measured less what is simulated, in the frequency domain,

    l += m r_ad + (kc + j w cc) r_xc,          r_xc = (r_ad - r_as) / (j w)^2
    p += ms r_as - (kc + j w cc) r_xc + (kf + j w (cf + c)) r_x

with c the damper's mean damping. At the matched motion the load cell tells the damper's part of p from that of
suspension and floor; the command tells what the coil lacks; `(j w)^2 r_x = r_as` is what sensors must fulfil.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from seatsim.diagnosis.fit import Point
from seatsim.diagnosis.nuisance import varied
from seatsim.diagnosis.problem import POOL, Drive, Problem
from seatsim.simulation import Forces

Array = NDArray[np.float64]

BAND = (0.4, 30.0)
"""Hz between which missing forces are sought."""
LEAST_CUSHION = 1.5
"""Hz above which the cushion's deflection, twice an integral of measured accelerations, is trusted."""
ROUNDS = 5
"""Iterations to the matched motion."""
MARGIN = 1.3
"""Factor on the power of what noise seems to lack."""


@dataclass(frozen=True)
class Missing:
    """What a simulation lacks, by run, shape (samples,) each: forces in N, current in A, kinematic error in m/s^2."""

    damper: dict[str, Array]
    frame: dict[str, Array]
    driver: dict[str, Array]
    coil: dict[str, Array]
    kinematic: dict[str, Array]
    matched: dict[str, Array]


def missing(problem: Problem, point: Point) -> Missing:
    """Return what the rig at a point lacks to move as the measured one did."""
    found = list(POOL.map(lambda run: _matched(problem, point, run), problem.runs))
    parts = [{run: values[k] for run, values in zip(problem.runs, found, strict=True)} for k in range(6)]
    return Missing(*parts)


def _matched(problem: Problem, point: Point, run: str) -> tuple[Array, ...]:
    """Return the missing forces of a run, its coil and kinematic errors, and the simulated channels at the match."""
    plant = varied(problem.scenario, problem.parameters, point.u).plant
    assert plant is not None
    for change in (effect.plant for effect in point.effects if hasattr(effect, "plant")):
        plant = change(plant)
    samples = problem.measured[run].shape[1]
    frequency = np.fft.rfftfreq(samples, 1.0 / problem.recording.header.sample_rate)
    s = 2j * np.pi * np.where(frequency > 0.0, frequency, 1.0)
    band = (frequency >= BAND[0]) & (frequency <= BAND[1])
    trusted = frequency > LEAST_CUSHION
    push, lift = np.zeros(samples), np.zeros(samples)
    damping = _mean_damping(problem, point, run)
    row = {name: k for k, name in enumerate(problem.channels)}
    simulated = np.zeros(0)
    for turn in range(ROUNDS):
        drive = Drive(None, Forces(_padded(problem, run, push), _padded(problem, run, lift)))
        simulated = problem.simulated(run, point.u, point.effects, drive)
        if turn == ROUNDS - 1:
            break
        r = {name: np.fft.rfft(problem.measured[run][k] - simulated[k]) * band for name, k in row.items()}
        r_x = r["suspension_displacement"] if "suspension_displacement" in r else r["frame_acceleration"] / s**2
        r_as = r["frame_acceleration"] if "frame_acceleration" in r else s**2 * r_x
        cushion = plant.cushion_stiffness + s * plant.cushion_damping
        r_ad = r.get("driver_acceleration", r_as * cushion / (cushion + plant.driver_mass * s**2))
        internal = cushion * (r_ad - r_as) / s**2 * trusted
        below = plant.suspension_stiffness + s * (plant.suspension_damping + damping)
        push += np.fft.irfft(plant.frame_mass * r_as - internal + below * r_x, samples)
        if "driver_acceleration" in row:
            lift += np.fft.irfft((plant.driver_mass * r_ad + internal) * trusted, samples)
    left = {name: problem.measured[run][k] - simulated[k] for name, k in row.items()}
    none = np.zeros(samples)
    force = np.fft.irfft(np.fft.rfft(left["damper_force"]) * band, samples) if "damper_force" in row else none
    return force, push + force, lift, left.get("coil_current", none), _kinematic(problem, run, s, band), simulated


def _kinematic(problem: Problem, run: str, s: NDArray[np.complex128], band: NDArray[np.bool_]) -> Array:
    """Return what displacement, frame and floor accelerations contradict each other by, in m/s^2."""
    if not {"suspension_displacement", "frame_acceleration"} <= set(problem.channels):
        return np.zeros(problem.measured[run].shape[1])
    measured = dict(zip(problem.channels, problem.measured[run], strict=True))
    samples = problem.measured[run].shape[1]
    table = problem.recording.table(run)["floor_acceleration"][problem.skip : problem.skip + samples]
    error = s**2 * np.fft.rfft(measured["suspension_displacement"]) - np.fft.rfft(
        measured["frame_acceleration"] - table
    )
    window = band & (np.abs(s) > 2.0 * np.pi * 0.8) & (np.abs(s) < 2.0 * np.pi * 12.0)
    return np.fft.irfft(error * window, samples)


def _mean_damping(problem: Problem, point: Point, run: str) -> float:
    """Return the damping in N s/m by which force and velocity of the simulated damper hang together."""
    if "damper_force" in problem.channels and "suspension_displacement" in problem.channels:
        simulated = dict(zip(problem.channels, problem.simulated(run, point.u, point.effects), strict=True))
        speed = np.gradient(simulated["suspension_displacement"], 1.0 / problem.recording.header.sample_rate)
        return float(max(0.0, np.mean(simulated["damper_force"] * speed) / np.mean(speed**2)))
    return 1000.0


def _padded(problem: Problem, run: str, force: Array) -> Array:
    """Return a force on the rows compared as one on the simulation's steps."""
    floor = problem.floors[run]
    assert floor is not None
    parts = round(1.0 / problem.recording.header.sample_rate / floor.step)
    rows = np.arange(len(floor.acceleration)) / parts
    return np.interp(rows, problem.skip + np.arange(len(force)), force, left=0.0, right=0.0)


def lacking(problem: Problem, point: Point, lack: Missing) -> dict[str, float]:
    """Return how much each block lacks, as a share of what acts in it, beyond what noise alone seems to lack."""
    found, noise = sizes(problem, lack), sizes(problem, missing(twin(problem, point), point))
    return {
        block: float(np.sqrt(max(0.0, size**2 - MARGIN * noise.get(block, 0.0) ** 2))) for block, size in found.items()
    }


def twin(problem: Problem, point: Point) -> Problem:
    """Return the problem with a simulated recording of the rig at a point, with the stated noise."""
    rng = np.random.default_rng(1)
    measured = {}
    for run in problem.runs:
        floor = problem.floors[run]
        assert floor is not None
        level = problem.recording.channels["floor_acceleration"].noise_rms
        shaken = floor._replace(acceleration=floor.acceleration + level * rng.standard_normal(len(floor.acceleration)))
        true = problem.simulated(run, point.u, point.effects, Drive(shaken))
        measured[run] = true + problem.noise[:, None] * rng.standard_normal(true.shape)
    return dataclasses.replace(problem, measured=measured)


def sizes(problem: Problem, lack: Missing) -> dict[str, float]:
    """Return how much each block lacks, as a share of what acts in it."""
    measured = {name: np.concatenate([problem.measured[run][k] for run in problem.runs])
                for k, name in enumerate(problem.channels)}  # fmt: skip
    plant = problem.scenario.plant
    assert plant is not None
    driver = measured.get("driver_acceleration", measured.get("frame_acceleration"))
    weight = plant.driver_mass * float(np.std(driver)) if driver is not None else 100.0
    force = float(np.std(measured["damper_force"])) if "damper_force" in measured else weight
    frame, lift = _joined(lack.frame), _joined(lack.driver)
    found = {
        "damper": _rms(_joined(lack.damper)) / force,
        "suspension": _rms(frame) / force,
        "total": _rms(frame + lift) / force,
        "driver": _rms(lift) / weight,
    }
    if "coil_current" in measured:
        found["coil"] = _rms(_joined(lack.coil)) / float(np.std(measured["coil_current"]))
    if "frame_acceleration" in measured:
        found["sensor"] = _rms(_joined(lack.kinematic)) / float(np.std(measured["frame_acceleration"]))
    return found


def _joined(parts: dict[str, Array]) -> Array:
    return np.concatenate(list(parts.values()))


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
