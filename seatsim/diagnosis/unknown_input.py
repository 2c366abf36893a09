"""An unknown input of one block: what it makes of the channels, and the course that explains what a state leaves.

The input is free at every frequency: a force on the frame (suspension), on the driver (driver), between the two
(cushion), of the damper, which the load cell sees, or a motion of the floor. With r the whitened residuals of the
channels and h what a unit input makes of them, the simulation is driven by the input q and q corrected in turn, from
zero, as long as it helps:

    q(f) += h* r / (|h|^2 + 2 / p(f)),      p(f) the plausible power of an input.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.diagnosis.fit import Engine, Point, State
from seatsim.diagnosis.problem import Drive, Problem
from seatsim.diagnosis.whitening import smoothed
from seatsim.errors import RunError
from seatsim.simulation import Forces

Array = NDArray[np.float64]
Spectra = NDArray[np.complex128]

SIZE = 0.1
"""Size of the random inputs, as a share of the fluctuation of the floor's motion and of the force it means."""
REACH = 10.0
"""Factor from it to the largest plausible input."""
CORNER, WIDE = 2.0, 40.0
"""Hz above which the spectrum of plausible inputs falls, and that of the small ones that probe the channels."""
ROUNDS = 20
"""Most corrections of an input."""
SETTLED = 0.02
"""Corrections end where one lowers what is left by less than this share."""
SHORTER = (1.0, 0.4, 0.15)
"""Fractions of a correction that are tried in turn."""
REGAINED = 1.2
"""Factor on a force that repeats show, for what its filter takes."""


class Input(NamedTuple):
    """Shares of an unknown course that act on frame and driver (N), on the floor (m/s^2) and on the load cell (N)."""

    push: float = 0.0
    lift: float = 0.0
    ground: float = 0.0
    cell: float = 0.0


INPUTS = {
    "damper": Input(push=-1.0, cell=1.0), "suspension": Input(push=1.0), "cushion": Input(push=-1.0, lift=1.0),
    "driver": Input(lift=1.0), "floor": Input(ground=1.0),
}  # fmt: skip


class Probe(NamedTuple):
    """A small random input of a run, its spectrum, and the power of plausible inputs by frequency."""

    course: Array
    spectrum: Spectra
    plausible: Array


class Answer(NamedTuple):
    """What an input leaves of a run, whitened, its ways into the channels (signature, power), and its course."""

    left: Array
    ways: list[tuple[Spectra, Array]]
    course: Array


def driven(engine: Engine, state: State, run: str, where: Input) -> Answer:
    """Return the answer to an input that matches the channels as well as it can.

    What a small input makes of the channels is taken anew about each course: a strong one changes how the damper slips.
    """
    problem, bins, probe = engine.problem, engine.white.bins[run], _probe(engine, run, where)
    samples = len(probe.course)
    course, answer = np.zeros(samples), problem.measured[run] - state.residual[run]
    left = state.whitened[run]
    for _ in range(ROUNDS):
        before = float(np.sum(left**2))
        signature = _signature(engine, state, run, where, probe, (course, answer))
        size = np.sum(np.abs(signature) ** 2, axis=0)
        step = np.zeros(samples // 2 + 1, dtype=complex)
        step[:bins] = np.sum(signature.conj() * spectra(left), axis=0) / (size + 2.0 / probe.plausible)
        tried = [course + fraction * np.fft.irfft(step, samples) for fraction in SHORTER]
        course, answer, left = _better(engine, state, run, where, tried, (course, answer, left))
        if np.sum(left**2) > (1.0 - SETTLED) * before:
            break
    spectrum = np.fft.rfft(course)
    used = power(spectrum[:bins])
    spectrum[:bins] *= _share_above_noise(size * used)
    return Answer(left, [(signature, used)], np.fft.irfft(spectrum, samples))


def unrepeated(engine: Engine, state: State) -> dict[str, Array] | None:
    """Return a random force on the frame by run, shape (samples,), by which repeated runs differ; None without repeats.

    The difference of two repeats holds twice the power of what does not repeat.
    """
    problem, where = engine.problem, INPUTS["suspension"]
    for run, entry in problem.recording.runs.items():
        first = problem.measured.get(entry.repeat_of or "", np.zeros(0))
        second = problem.measured[run]
        if first.shape == second.shape:
            probe, still = _probe(engine, run, where), (np.zeros(second.shape[1]), second - state.residual[run])
            signature = _signature(engine, state, run, where, probe, still)
            left = spectra(engine.white((first - second) / np.sqrt(2.0), run))
            size = np.sum(np.abs(signature) ** 2, axis=0)
            course = np.sum(signature.conj() * left, axis=0) / (size + 2.0 / probe.plausible)
            course *= REGAINED * _share_above_noise(size * power(course))
            force = np.fft.irfft(course, first.shape[1])
            return {name: np.resize(force, values.shape[1]) for name, values in problem.measured.items()}
    return None


def spectra(whitened: Array) -> Spectra:
    """Return whitened numbers, shape (..., 2 frequencies), as complex ones, shape (..., frequencies)."""
    half = whitened.shape[-1] // 2
    return np.asarray(whitened[..., :half] + 1j * whitened[..., half:])


def power(spectrum: Spectra) -> Array:
    """Return the smoothed power of a spectrum, never zero."""
    return np.asarray(smoothed(np.abs(spectrum[None]) ** 2)[0] + 1e-30)


def _probe(engine: Engine, run: str, where: Input) -> Probe:
    problem = engine.problem
    floor, plant = problem.floors[run], problem.scenario.plant
    assert floor is not None
    assert plant is not None
    scale = SIZE * float(np.std(floor.acceleration)) * (1.0 if where.ground else plant.driver_mass)
    samples, rate = problem.measured[run].shape[1], problem.recording.header.sample_rate
    small, likely = (scale * _red(samples, rate, corner) for corner in (WIDE, CORNER))
    return Probe(small, np.fft.rfft(small), REACH**2 * power(np.fft.rfft(likely)[: engine.white.bins[run]]))


def _signature(
    engine: Engine, state: State, run: str, where: Input, probe: Probe, about: tuple[Array, Array]
) -> Spectra:
    """Return what a unit input makes of the whitened channels, shape (channels, frequencies).

    `about` is the course that the probe is added to, with the channels that this one gives.
    """
    course, answer = about
    change = _simulated(engine.problem, state.point, run, where, course + probe.course) - answer
    response = _response(np.fft.rfft(change), probe.spectrum)
    return np.asarray(engine.white.weights[run] * response[:, : engine.white.bins[run]])


def _better(
    engine: Engine, state: State, run: str, where: Input, courses: list[Array], best: tuple[Array, Array, Array]
) -> tuple[Array, Array, Array]:
    """Return the course that leaves the least, with its channels and what it leaves; `best` is such a triple so far."""
    measured = engine.problem.measured[run]
    for course in courses:
        answer = _simulated(engine.problem, state.point, run, where, course)
        left = engine.white(measured - answer, run)
        if np.sum(left**2) < np.sum(best[2] ** 2):
            best = course, answer, left
    return best


def _simulated(problem: Problem, point: Point, run: str, where: Input, course: Array) -> Array:
    """Return the channels of a run with a course on its places, shape (channels, samples)."""
    floor = problem.floors[run]
    assert floor is not None
    rows = np.arange(len(floor.acceleration)) / problem.parts
    full = np.interp(rows, problem.skip + np.arange(len(course)), course, left=0.0, right=0.0)
    base = floor._replace(acceleration=floor.acceleration + where.ground * full)
    try:
        drive = Drive(base, Forces(where.push * full, where.lift * full))
        answer = problem.simulated(run, point.u, point.effects, drive)
    except RunError:
        return np.full(problem.measured[run].shape, 1e6 * problem.spread[:, None])
    if where.cell and "damper_force" in problem.channels:
        answer[problem.channels.index("damper_force")] += where.cell * course
    return answer


def _red(samples: int, rate: float, corner: float) -> Array:
    """Return random numbers of unit size whose spectrum falls above a corner in Hz."""
    frequency = np.fft.rfftfreq(samples, 1.0 / rate)
    white = np.random.default_rng(1).standard_normal(samples)
    course = np.fft.irfft(np.fft.rfft(white) / (1.0 + frequency / corner), samples)
    return np.asarray(course / np.std(course))


def _response(answer: Spectra, cause: Spectra) -> Spectra:
    """Return the best linear approximation of what turns one spectrum into others."""
    crossed = answer * cause.conj()
    power = smoothed(np.abs(cause[None]) ** 2)
    return np.asarray((smoothed(crossed.real) + 1j * smoothed(crossed.imag)) / power)


def _share_above_noise(power: Array) -> Array:
    """Return Wiener's filter for a whitened power spectrum, in which noise has 2."""
    return np.maximum(0.0, 1.0 - 2.0 / power)
