"""Which single block could hold what is left: an unknown input in each block in turn, and the evidence for it.

Beside the inputs of `unknown_input` there is the error of one sensor. With r the whitened residuals without the input,
h what a unit of it makes of the channels about the course found, p the power of that course and S the sensitivities to
the nuisance parameters u, minus twice the log evidence is

    min over u of  sum over f  (r - S u)* (I + h h* p / 2)^-1 (r - S u) + 2 log(1 + |h|^2 p / 2)  + prior(u).

The logarithm is Occam's factor: it charges a block for every frequency at which it needs an input of its own.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.diagnosis.fit import Engine, State, solved
from seatsim.diagnosis.localise.input_estimate import INPUTS, Answer, driven, driven_by_log, power, spectra, unit_error
from seatsim.diagnosis.problem import POOL
from seatsim.recordings.quality.floor_sensor import FLOOR, follows_floor

Array = NDArray[np.float64]

SLOW = 0.5
"""Hz below which the zero of a sensor wanders, and no floor moves so much that it matters."""


class Suspect(NamedTuple):
    """A block that an unknown input may act in: minus twice the log evidence per number compared, less 1.

    `course[run]`, shape (samples,), is the input above its noise, a quantity in its unit; `channel` is the one that
    errs, for a sensor.
    """

    doubt: float
    quantity: str
    unit: str
    course: dict[str, Array]
    channel: str = ""


def suspects(engine: Engine, state: State) -> dict[str, Suspect]:
    """Return how an unknown input in each block would explain what a state leaves."""
    problem = engine.problem
    runs = dict(zip(problem.runs, POOL.map(lambda run: _answers(engine, state, run), problem.runs), strict=True))
    found = {}
    for name in next(iter(runs.values())):
        answers = {run: of_run[name] for run, of_run in runs.items()}
        courses = {run: answer.course for run, answer in answers.items()}
        quantity, unit = {"coil": ("current", "A"), "floor": ("acceleration", "m/s^2")}.get(name, ("force", "N"))
        found[name] = Suspect(_doubt(engine, state, answers), quantity, unit, courses)
    errors = [
        found.pop(name)._replace(quantity=f"error of {name}", unit=problem.recording.channels[name].unit, channel=name)
        for name in problem.channels
    ]
    errors.append(_of_sensor(found.pop(FLOOR)))
    if not follows_floor(problem.recording):
        errors.append(_of_sensor(found.pop("floor")))
    return found | {"sensor": min(errors, key=lambda suspect: suspect.doubt)}


def _of_sensor(motion: Suspect) -> Suspect:
    """Return a motion of the floor that its accelerometer does not see as the error of that."""
    course = {run: -values for run, values in motion.course.items()}
    return motion._replace(course=course, quantity=f"error of {FLOOR}", unit="m/s^2", channel=FLOOR)


def _answers(engine: Engine, state: State, run: str) -> dict[str, Answer]:
    """Return the answer to an input in each block, and to an error of each channel's sensor."""
    weights, left = engine.white.weights[run], state.whitened[run]
    errors = spectra(left) / weights
    found = {}
    for k, name in enumerate(engine.problem.channels):
        found[name] = Answer(left, unit_error(weights, k), power(errors[k]), state.residual[run][k])
    merged = "damper_force" not in engine.problem.channels
    for block, where in INPUTS.items():
        same = merged and block == "suspension"
        found[block] = found["damper"] if same else driven(engine, state, run, where)
    found[FLOOR] = driven(engine, state, run, INPUTS["floor"], SLOW)
    if "coil_current" in engine.problem.channels:
        found["coil"] = driven_by_log(engine, state, run)
    return found


def _doubt(engine: Engine, state: State, answers: dict[str, Answer]) -> float:
    """Return minus twice the log evidence per number compared, less 1, the nuisances refitted to first order."""
    count = len(state.point.u)
    matrix, right, cost, rows = np.zeros((count, count)), np.zeros(count), 0.0, 0
    for run, answer in answers.items():
        shape = answer.left.shape
        whole = spectra(np.concatenate([answer.left[None], engine.slopes[run].reshape(-1, *shape)]))
        rest = whole
        size = np.sum(np.abs(answer.way) ** 2, axis=0)
        along = np.sum(answer.way.conj() * rest, axis=1, keepdims=True) / (size + 2.0 / answer.power)
        rest = rest - answer.way * along
        cost += float(np.sum(2.0 * np.log1p(0.5 * size * answer.power)))
        gram = (whole.reshape(count + 1, -1) @ rest.reshape(count + 1, -1).conj().T).real
        matrix, right, cost = matrix + gram[1:, 1:], right + gram[1:, 0], cost + gram[0, 0]
        rows += answer.left.size
    ones = np.ones(count)
    step = solved(matrix, right, count, state.point.u, -ones, ones)
    return float(cost - 2.0 * step @ right + step @ matrix @ step) / rows - 1.0
