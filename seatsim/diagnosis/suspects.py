"""Which single block could hold what is left: an unknown input in each block in turn, and the evidence for it.

The input is free at every frequency: a force on the frame (suspension), on the driver (driver), between the two
(cushion), of the damper, which the load cell sees, a motion of the floor, or the error of one sensor; a coil errs in
current and force. With r the whitened residuals of the channels and h what a unit input makes of them, the simulation
is driven by the input q and q corrected in turn, from zero, as long as it helps:

    q(f) += h* r / (|h|^2 + 2 / p(f)),      p(f) the input's power.

With p then taken from q itself and S the sensitivities to the nuisance parameters u, minus twice the log evidence is

    min over u of  sum over f  (r - S u)* (I + h h* p / 2)^-1 (r - S u) + 2 log(1 + |h|^2 p / 2)  + prior(u).

The logarithm is Occam's factor: it charges a block for every frequency at which it needs an input of its own.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.diagnosis.fit import Engine, Point, State, solved
from seatsim.diagnosis.problem import POOL, Drive, Problem
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


ERROR = "error of "
"""How the name of a sensor's unknown input begins."""


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


class Answer(NamedTuple):
    """What an input leaves of a run, whitened, its ways into the channels (signature, power), and its course."""

    left: Array
    ways: list[tuple[Spectra, Array]]
    course: Array


class Suspect(NamedTuple):
    """A block that an unknown input may act in: minus twice the log evidence per number compared, less 1.

    `course[run]`, shape (samples,), is the input above its noise, a quantity in its unit.
    """

    doubt: float
    quantity: str
    unit: str
    course: dict[str, Array]


def suspects(engine: Engine, state: State) -> dict[str, Suspect]:
    """Return how an unknown input in each block would explain what a state leaves."""
    problem = engine.problem
    runs = dict(zip(problem.runs, POOL.map(lambda run: _answers(engine, state, run), problem.runs), strict=True))
    found = {}
    for name in next(iter(runs.values())):
        answers = {run: of_run[name] for run, of_run in runs.items()}
        quantity, unit = _nature(problem, name)
        courses = {run: answer.course for run, answer in answers.items()}
        found[name] = Suspect(_doubt(engine, state, answers), quantity, unit, courses)
    sensor = min((found.pop(name) for name in problem.channels), key=lambda suspect: suspect.doubt)
    return found | {"sensor": sensor}


def _nature(problem: Problem, name: str) -> tuple[str, str]:
    if name in problem.channels:
        return f"{ERROR}{name}", problem.recording.channels[name].unit
    return {"coil": ("current", "A"), "floor": ("acceleration", "m/s^2")}.get(name, ("force", "N"))


def _answers(engine: Engine, state: State, run: str) -> dict[str, Answer]:
    """Return the answer to an input in each block, and to an error of each channel's sensor."""
    weights, left = engine.white.weights[run], state.whitened[run]
    errors = _spectra(left) / weights
    found = {}
    for k, name in enumerate(engine.problem.channels):
        unit = np.asarray(np.eye(len(weights))[:, k : k + 1] * weights, dtype=complex)
        found[name] = Answer(left, [(unit, _power(errors[k]))], state.residual[run][k])
    found |= {block: _driven(engine, state, run, where) for block, where in INPUTS.items()}
    if "coil_current" in found:
        sensed, driven = found["coil_current"], found["damper"]
        found["coil"] = Answer(driven.left, [*sensed.ways, *driven.ways], sensed.course)
    return found


def _driven(engine: Engine, state: State, run: str, where: Input) -> Answer:
    """Return the answer to an input that matches the channels as well as it can.

    What a small input makes of the channels is taken anew about each course: a strong one changes how the damper slips.
    """
    problem, bins = engine.problem, engine.white.bins[run]
    samples = problem.measured[run].shape[1]
    course, answer = np.zeros(samples), problem.measured[run] - state.residual[run]
    left = state.whitened[run]
    for _ in range(ROUNDS):
        before = float(np.sum(left**2))
        signature, plausible = _signature(engine, state, run, where, (course, answer))
        size = np.sum(np.abs(signature) ** 2, axis=0)
        step = np.zeros(samples // 2 + 1, dtype=complex)
        step[:bins] = np.sum(signature.conj() * _spectra(left), axis=0) / (size + 2.0 / plausible)
        tried = [course + fraction * np.fft.irfft(step, samples) for fraction in SHORTER]
        course, answer, left = _better(engine, state, run, where, tried, (course, answer, left))
        if np.sum(left**2) > (1.0 - SETTLED) * before:
            break
    spectrum = np.fft.rfft(course)
    power = _power(spectrum[:bins])
    spectrum[:bins] *= _share_above_noise(size * power)
    return Answer(left, [(signature, power)], np.fft.irfft(spectrum, samples))


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


def _signature(
    engine: Engine, state: State, run: str, where: Input, about: tuple[Array, Array]
) -> tuple[Spectra, Array]:
    """Return what a unit input makes of the whitened channels, (channels, frequencies), and its plausible power.

    `about` is the course that it is added to, with the channels that this one gives.
    """
    problem, bins = engine.problem, engine.white.bins[run]
    floor, plant = problem.floors[run], problem.scenario.plant
    assert floor is not None
    assert plant is not None
    course, answer = about
    scale = SIZE * float(np.std(floor.acceleration)) * (1.0 if where.ground else plant.driver_mass)
    samples, rate = problem.measured[run].shape[1], problem.recording.header.sample_rate
    test, likely = (scale * _red(samples, rate, corner) for corner in (WIDE, CORNER))
    change = np.fft.rfft(_simulated(problem, state.point, run, where, course + test) - answer)
    signature = engine.white.weights[run] * _response(change, np.fft.rfft(test))[:, :bins]
    return signature, REACH**2 * _power(np.fft.rfft(likely)[:bins])


def unrepeated(engine: Engine, state: State) -> dict[str, Array] | None:
    """Return a random force on the frame by run, shape (samples,), by which repeated runs differ; None without repeats.

    The difference of two repeats holds twice the power of what does not repeat.
    """
    problem = engine.problem
    for run, entry in problem.recording.runs.items():
        first = problem.measured.get(entry.repeat_of or "", np.zeros(0))
        second = problem.measured[run]
        if first.shape == second.shape:
            still = np.zeros(second.shape[1]), second - state.residual[run]
            signature, plausible = _signature(engine, state, run, INPUTS["suspension"], still)
            left = _spectra(engine.white((first - second) / np.sqrt(2.0), run))
            size = np.sum(np.abs(signature) ** 2, axis=0)
            course = np.sum(signature.conj() * left, axis=0) / (size + 2.0 / plausible)
            course *= REGAINED * _share_above_noise(size * _power(course))
            force = np.fft.irfft(course, first.shape[1])
            return {name: np.resize(force, values.shape[1]) for name, values in problem.measured.items()}
    return None


def _spectra(whitened: Array) -> Spectra:
    """Return whitened numbers, shape (..., 2 frequencies), as complex ones, shape (..., frequencies)."""
    half = whitened.shape[-1] // 2
    return np.asarray(whitened[..., :half] + 1j * whitened[..., half:])


def _share_above_noise(power: Array) -> Array:
    """Return Wiener's filter for a whitened power spectrum, in which noise has 2."""
    return np.maximum(0.0, 1.0 - 2.0 / power)


def _power(spectrum: Spectra) -> Array:
    return np.asarray(smoothed(np.abs(spectrum[None]) ** 2)[0] + 1e-30)


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


def _doubt(engine: Engine, state: State, answers: dict[str, Answer]) -> float:
    """Return minus twice the log evidence per number compared, less 1, the nuisances refitted to first order."""
    count = len(state.point.u)
    matrix, right, cost, rows = np.zeros((count, count)), np.zeros(count), 0.0, 0
    for run, answer in answers.items():
        shape = answer.left.shape
        spectra = _spectra(np.concatenate([answer.left[None], engine.slopes[run].reshape(-1, *shape)]))
        rest = spectra
        for signature, power in answer.ways:
            size = np.sum(np.abs(signature) ** 2, axis=0)
            rest = rest - signature * np.sum(signature.conj() * rest, axis=1, keepdims=True) / (size + 2.0 / power)
            cost += float(np.sum(2.0 * np.log1p(0.5 * size * power)))
        gram = (spectra.reshape(count + 1, -1) @ rest.reshape(count + 1, -1).conj().T).real
        matrix, right, cost = matrix + gram[1:, 1:], right + gram[1:, 0], cost + gram[0, 0]
        rows += answer.left.size
    ones = np.ones(count)
    step = solved(matrix, right, count, state.point.u, -ones, ones)
    return float(cost - 2.0 * step @ right + step @ matrix @ step) / rows - 1.0
