"""An unknown input of one block: what it makes of the channels, and the course that explains what a state leaves.

The input is free at every frequency: a force on the frame (suspension), on the driver (driver), between the two
(cushion), of the damper, which the load cell sees, or a motion of the floor. With r the whitened residuals of the
channels and h what a unit input makes of them, the simulation is driven by the input q and q corrected in turn, from
zero, as long as it helps:

    q(f) += h* r / (|h|^2 + 2 / p(f)),      p(f) the plausible power of an input.

A coil's is the current by which its log differs from the simulation: what a current does to a force follows the motion,
so that there is no h to correct it by.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.diagnosis.fit import Engine, Point, State
from seatsim.diagnosis.noise import Whitening, smoothed
from seatsim.diagnosis.problem import Problem
from seatsim.schema.errors import RunError
from seatsim.simulation.inputs import Forces, SeatInputs
from seatsim.simulation.respond import respond

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
SETTLED, FRUITLESS = 0.02, 2
"""Corrections end where this many in a row lower what is left by less than that share, or where only noise is left."""
SHORTER = (1.0, 0.4, 0.15, 0.05)
"""Fractions of a correction that are tried in turn."""
REGAINED = 1.2
"""Factor on a force that repeats show, for what its filter takes."""


class Input(NamedTuple):
    """Shares of an unknown course that act on frame, driver, load cell (N), floor (m/s^2) and as a current (A)."""

    push: float = 0.0
    lift: float = 0.0
    ground: float = 0.0
    cell: float = 0.0
    current: float = 0.0


INPUTS = {
    "damper": Input(push=-1.0, cell=1.0), "suspension": Input(push=1.0), "cushion": Input(push=-1.0, lift=1.0),
    "driver": Input(lift=1.0), "floor": Input(ground=1.0),
}  # fmt: skip


class Answer(NamedTuple):
    """What a block's input has to explain in a run, whitened, what a unit of it explains, its power, and its course.

    Where the simulation is driven, `left` is what that leaves, and what the course explains by the last `way`.
    """

    left: Array
    way: Spectra
    power: Array
    course: Array


@dataclass(frozen=True)
class Driven:
    """A run of a rig that an input is added to; `current` is that of its coil without it, every step."""

    problem: Problem
    white: Whitening
    point: Point
    run: str
    where: Input
    current: Array

    @property
    def samples(self) -> int:
        """How many samples a course has."""
        return int(self.problem.measured[self.run].shape[1])

    def channels(self, course: Array) -> Array:
        """Return the channels with a course, shape (channels, samples)."""
        problem, where, inputs = self.problem, self.where, self.problem.inputs[self.run]
        assert isinstance(inputs, SeatInputs)
        floor = inputs.floor
        rows = np.arange(len(floor.acceleration)) / problem.parts
        full = np.interp(rows, problem.skip + np.arange(self.samples), course, left=0.0, right=0.0)
        floor = floor._replace(acceleration=floor.acceleration + where.ground * full)
        if where.current:
            floor = floor._replace(command=None, coil_current=np.maximum(self.current + where.current * full, 0.0))
        inputs = inputs._replace(floor=floor, forces=Forces(where.push * full, where.lift * full))
        try:
            answer = problem.simulated(self.run, self.point.u, self.point.effects, inputs)
        except RunError:
            return np.full(problem.measured[self.run].shape, 1e6 * problem.spread[:, None])
        if where.cell and "damper_force" in problem.channels:
            answer[problem.channels.index("damper_force")] += where.cell * course
        return answer

    def random(self, corner: float, seed: int) -> Array:
        """Return a small random course whose spectrum falls above a corner in Hz."""
        inputs, plant = self.problem.inputs[self.run], self.problem.scenario.plant
        assert isinstance(inputs, SeatInputs)
        assert plant is not None
        scale = SIZE * float(np.std(inputs.floor.acceleration)) * (1.0 if self.where.ground else plant.driver_mass)
        return scale * _red(self.samples, self.problem.recording.header.sample_rate, corner, seed)

    def plausible(self) -> Array:
        """Return the power of plausible courses, shape (frequencies,)."""
        return REACH**2 * power(np.fft.rfft(self.random(CORNER, 1))[: self.white.bins[self.run]])

    def signature(self, about: tuple[Array, Array], seed: int = 1) -> Spectra:
        """Return what a unit input makes of the whitened channels, shape (channels, frequencies).

        `about` is the course that a small random one is added to, with the channels that it gives.
        """
        course, answer = about
        probe = self.random(WIDE, seed)
        response = _response(np.fft.rfft(self.channels(course + probe) - answer), np.fft.rfft(probe))
        return np.asarray(self.white.weights[self.run] * response[:, : self.white.bins[self.run]])

    def left(self, answer: Array) -> Array:
        """Return what channels leave of the measured ones, whitened."""
        return self.white(self.problem.measured[self.run] - answer, self.run)

    def better(self, courses: list[Array], best: tuple[Array, Array, Array]) -> tuple[Array, Array, Array]:
        """Return the first course that leaves less than the best so far; with its channels and what it leaves."""
        for course in courses:
            answer = self.channels(course)
            left = self.left(answer)
            if np.sum(left**2) < np.sum(best[2] ** 2):
                return course, answer, left
        return best


def driven(engine: Engine, state: State, run: str, where: Input, highest: float = np.inf) -> Answer:
    """Return the answer to an input, below a highest frequency in Hz, that matches the channels as well as it can.

    What a small input makes of the channels is taken anew about each course, with another random one each time: a
    strong course changes how the damper slips, and what one probe misleads the next may mend.
    """
    rig = _driven(engine, state, run, where)
    plausible, bins = rig.plausible(), engine.white.bins[run]
    allowed = np.fft.rfftfreq(rig.samples, 1.0 / engine.problem.recording.header.sample_rate)[:bins] <= highest
    course, fruitless = np.zeros(rig.samples), 0
    answer = rig.channels(course)
    left = rig.left(answer)
    for seed in range(1, ROUNDS + 1):
        before = float(np.sum(left**2))
        signature = rig.signature((course, answer), seed)
        size = np.sum(np.abs(signature) ** 2, axis=0)
        step = np.zeros(rig.samples // 2 + 1, dtype=complex)
        step[:bins] = allowed * np.sum(signature.conj() * spectra(left), axis=0) / (size + 2.0 / plausible)
        tried = [course + fraction * np.fft.irfft(step, rig.samples) for fraction in SHORTER]
        course, answer, left = rig.better(tried, (course, answer, left))
        fruitless = fruitless + 1 if np.sum(left**2) > (1.0 - SETTLED) * before else 0
        if fruitless == FRUITLESS or np.sum(left**2) < left.size:
            break
    spectrum = np.fft.rfft(course)
    used, explained = power(spectrum[:bins]), signature * spectrum[:bins]
    spectrum[:bins] *= _share_above_noise(size * used)
    whole = left + np.concatenate([explained.real, explained.imag], axis=1)
    return Answer(whole, signature, used, np.fft.irfft(spectrum, rig.samples))


def driven_by_log(engine: Engine, state: State, run: str) -> Answer:
    """Return the answer to the current that was logged, in place of the one that the simulated coil has."""
    k, samples = engine.problem.channels.index("coil_current"), engine.problem.measured[run].shape[1]
    weights, bins = engine.white.weights[run], engine.white.bins[run]
    error, spectrum = spectra(state.whitened[run])[k], np.zeros(samples // 2 + 1, dtype=complex)
    spectrum[:bins] = error / weights[k] * _share_above_noise(power(error))
    course = np.fft.irfft(spectrum, samples)
    rig = _driven(engine, state, run, Input(current=1.0))
    left = rig.left(rig.channels(course))
    left[k] = state.whitened[run][k]
    return Answer(left, unit_error(weights, k), power(error / weights[k]), course)


def unit_error(weights: Array, k: int) -> Spectra:
    """Return what a unit error of channel `k` makes of the whitened channels, shape (channels, frequencies)."""
    return np.asarray(np.eye(len(weights))[:, k : k + 1] * weights, dtype=complex)


def unrepeated(engine: Engine, state: State) -> dict[str, Array] | None:
    """Return a random force on the frame by run, shape (samples,), by which repeated runs differ; None without repeats.

    The difference of two repeats holds twice the power of what does not repeat.
    """
    problem = engine.problem
    for run, entry in problem.recording.runs.items():
        first = problem.measured.get(entry.repeat_of or "", np.zeros(0))
        second = problem.measured[run]
        if first.shape == second.shape:
            rig = _driven(engine, state, run, INPUTS["suspension"])
            signature = rig.signature((np.zeros(rig.samples), second - state.residual[run]))
            left = spectra(engine.white((first - second) / np.sqrt(2.0), run))
            size = np.sum(np.abs(signature) ** 2, axis=0)
            course = np.sum(signature.conj() * left, axis=0) / (size + 2.0 / rig.plausible())
            course *= REGAINED * _share_above_noise(size * power(course))
            force = np.fft.irfft(course, rig.samples)
            return {name: np.resize(force, values.shape[1]) for name, values in problem.measured.items()}
    return None


def _driven(engine: Engine, state: State, run: str, where: Input) -> Driven:
    problem, point = engine.problem, state.point
    current = np.zeros(0)
    if where.current:
        inputs = problem.inputs[run]
        assert isinstance(inputs, SeatInputs)
        every_step = inputs._replace(interval=inputs.floor.step)
        scenario = problem.augmented(point.u, point.effects)
        current = respond(scenario, every_step, carry_all_effects=True)["coil_current"]
    return Driven(problem, engine.white, point, run, where, current)


def spectra(whitened: Array) -> Spectra:
    """Return whitened numbers, shape (..., 2 frequencies), as complex ones, shape (..., frequencies)."""
    half = whitened.shape[-1] // 2
    return np.asarray(whitened[..., :half] + 1j * whitened[..., half:])


def power(spectrum: Spectra) -> Array:
    """Return the smoothed power of a spectrum, never zero."""
    return np.asarray(smoothed(np.abs(spectrum[None]) ** 2)[0] + 1e-30)


def _red(samples: int, rate: float, corner: float, seed: int) -> Array:
    """Return random numbers of unit size whose spectrum falls above a corner in Hz."""
    frequency = np.fft.rfftfreq(samples, 1.0 / rate)
    white = np.random.default_rng(seed).standard_normal(samples)
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
