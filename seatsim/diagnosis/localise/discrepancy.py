"""What an unexplained force depends on: regression of its course on what the simulated rig does.

The regressors come from the simulation that the measured floor drives, not from measured motion, which the unexplained
force itself has moved. A force that they cannot foretell on a run left out, and that is as strong in every run, comes
from outside the rig: a rattle, too, is hard to foretell, but its strength follows the motion.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.signal import decimate

from seatsim.diagnosis.fit import Point
from seatsim.diagnosis.localise.hypotheses import SLOW, Suspect
from seatsim.diagnosis.problem import Problem

Array = NDArray[np.float64]

RATE = 100.0
"""Hz; rate at which courses are regressed."""
LAGS = 10
"""Past samples of the motion that a linear filter may use."""
RIDGE = 1e-3
"""Ridge, relative to the regressors' power."""
LEAST = 1e-9
"""Least ridge, for regressors that are all at rest, such as a current that never flows."""
FORETOLD = 0.12
"""Share of the variance on left-out runs from which a force belongs to the rig."""
STEADY = 1.4
"""Ratio of its RMS in two runs up to which a force may come from outside."""
MOSTLY = 0.9
"""Share of its power that a wandering zero has below SLOW, at least."""


class Latent(NamedTuple):
    """An unexplained course by run, and the shares of its variance that families of regressors foretell.

    `channel` is the one whose error it is; empty for a force, an acceleration or a current.
    """

    block: str
    quantity: str
    unit: str
    course: dict[str, Array]
    shares: dict[str, float]
    channel: str = ""

    @property
    def from_outside(self) -> bool:
        """Whether a force is none that the rig makes."""
        strengths = [float(np.std(course)) for course in self.course.values()]
        return self.shares["everything"] <= FORETOLD and max(strengths) <= STEADY * min(strengths)

    def wanders(self, rate: float) -> bool:
        """Whether it is the error of a sensor whose zero wanders; `rate` is that of the courses in Hz."""
        slow = power = 0.0
        for course in self.course.values():
            spectrum = np.abs(np.fft.rfft(course)) ** 2
            slow += float(np.sum(spectrum[: int(SLOW * len(course) / rate) + 1]))
            power += float(np.sum(spectrum))
        return self.block == "sensor" and slow > MOSTLY * power


def latent(problem: Problem, point: Point, block: str, suspect: Suspect) -> Latent:
    """Return the unexplained course in a block of the seat and what foretells it."""
    features = {run: _features(problem, point, run) for run in problem.runs}
    target = {run: _thinned(problem, suspect.course[run]) for run in problem.runs}
    families = list(next(iter(features.values())))
    shares = {family: foretold({run: f[family] for run, f in features.items()}, target) for family in families}
    everything = {run: np.concatenate(list(f.values())) for run, f in features.items()}
    shares["everything"] = max(foretold(everything, target), *shares.values())
    return Latent(block, suspect.quantity, suspect.unit, suspect.course, shares, suspect.channel)


def _thinned(problem: Problem, values: Array) -> Array:
    factor = max(1, round(problem.recording.header.sample_rate / RATE))
    return np.asarray(decimate(values, factor, ftype="fir")) if factor > 1 else values


def _features(problem: Problem, point: Point, run: str) -> dict[str, Array]:
    """Return families of regressors at RATE, shape (regressors, samples) each."""
    simulated = dict(zip(problem.channels, problem.simulated(run, point.u, point.effects), strict=True))
    samples = problem.measured[run].shape[1]
    rate = problem.recording.header.sample_rate
    table = problem.recording.table(run)
    floor = table["floor_acceleration"][problem.skip : problem.skip + samples]
    current = simulated.get("coil_current", table.get("coil_current", table.get("current_command", np.zeros(0))))
    current = current[-samples:] if len(current) >= samples else np.zeros(samples)
    x = simulated.get("suspension_displacement")
    if x is None:
        return {"floor motion": _lagged(_thinned(problem, floor))}
    v = np.gradient(x, 1.0 / rate)
    x, v, i, a = (_thinned(problem, values) for values in (x, v, current, floor))
    slow, fast = np.tanh(v / 0.03), np.tanh(v / 0.005)
    return {
        "displacement": np.array([x, x * np.abs(x), x**3]),
        "velocity": np.array([v, v * np.abs(v), v**3, slow, fast]),
        "velocity and current": np.array([i, i * v, i * slow, i * fast, i**2 * slow, i * x, np.gradient(i)]),
        "past motion": np.concatenate([_lagged(x), _lagged(v)]),
        "floor motion": _lagged(a),
    }


def _lagged(values: Array) -> Array:
    return np.array([np.concatenate([np.full(k, values[0]), values[: len(values) - k]]) for k in range(LAGS)])


def foretold(features: dict[str, Array], target: dict[str, Array]) -> float:
    """Return the share of the variance of runs that is foretold by a regression on the others."""
    runs = list(target)
    halves = len(runs) == 1
    missed, power = 0.0, 0.0
    for left in range(2 if halves else len(runs)):
        if halves:
            middle = len(target[runs[0]]) // 2
            test = slice(0, middle) if left == 0 else slice(middle, None)
            train = slice(middle, None) if left == 0 else slice(0, middle)
            inside = features[runs[0]][:, train], target[runs[0]][train]
            outside = features[runs[0]][:, test], target[runs[0]][test]
        else:
            others = [run for k, run in enumerate(runs) if k != left]
            inside = np.hstack([features[r] for r in others]), np.concatenate([target[r] for r in others])
            outside = features[runs[left]], target[runs[left]]
        error = outside[1] - _regressed(*inside) @ outside[0]
        missed, power = missed + float(error @ error), power + float(outside[1] @ outside[1])
    return max(0.0, 1.0 - missed / max(power, 1e-30))


def _regressed(features: Array, target: Array) -> Array:
    scale = np.sqrt(np.mean(features**2, axis=1)) + 1e-12
    scaled = features / scale[:, None]
    gram = scaled @ scaled.T
    ridge = max(RIDGE * np.trace(gram) / len(gram), LEAST) * np.eye(len(gram))
    weights: Array = np.linalg.solve(gram + ridge, scaled @ target) / scale
    return weights


def rms(found: Latent) -> float:
    """Return the RMS of an unexplained course over all runs."""
    return float(np.sqrt(np.mean(np.concatenate(list(found.course.values())) ** 2)))


def described(found: Latent) -> list[str]:
    """Return sentences on an unexplained course."""
    sentences = [f"The unexplained {found.quantity} in the {found.block} has an RMS of {rms(found):.3g} {found.unit}."]
    families = {family: share for family, share in found.shares.items() if family != "everything"}
    best = max(families, key=lambda family: families[family])
    if families[best] < 0.1:
        sentences.append("Nothing that the simulated rig does foretells it on runs left out.")
    else:
        sentences.append(f"It follows {best} best, which foretells {families[best]:.0%} of its power on runs left out.")
    for family, share in sorted(families.items(), key=lambda item: -item[1])[1:3]:
        sentences.append(f"{family.capitalize()} foretells {share:.0%}.")
    return sentences


def evidence(problem: Problem, found: Latent, run: str) -> dict[str, Any]:
    """Return the course on a run, as the report draws it."""
    samples = len(found.course[run])
    time = (problem.skip + np.arange(samples)) / problem.recording.header.sample_rate
    return {
        "block": found.block, "quantity": found.quantity, "unit": found.unit, "time": time,
        "values": found.course[run], "description": described(found),
    }  # fmt: skip
