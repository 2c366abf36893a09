"""The model discrepancy: the unexplained signal in a block, what it depends on, and the sentences on it.

Nothing predicts a force from outside the rig on a run that is left out. The regressors come from the simulation driven
by the measured floor, not from the measured motion, to which the unexplained force itself contributes.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from scipy.signal import decimate, lfilter

from seatsim.diagnosis.localise.localisation import FaultHypothesis
from seatsim.diagnosis.objective import Parameters
from seatsim.diagnosis.problem import DiagnosisProblem
from seatsim.diagnosis.result import DiscrepancySignal, name_signal
from seatsim.diagnosis.settings.examining import LocalisationSettings
from seatsim.diagnosis.uncertainty import BLOCK_LENGTH
from seatsim.schema.arrays import Array

_RATE = 100.0
"""Rate at which signals are regressed [Hz]."""
_LAGS = 10
"""Past samples of the motion that a linear filter may use; more overfit."""
_MEMORIES = (0.05, 0.2, 0.5, 1.0, 2.0, 5.0)
"""Time constants over which motion is remembered, as by a creeping spring [s]."""
_LEAST_POWER = 1e-12
"""Least power whose logarithm is taken, as of a rig that rests."""
_RIDGE, _LEAST_RIDGE = 1e-3, 1e-9
"""Ridge, relative to the regressors' power, and the least one: they may all rest, as a current that never flows."""
_SLOW_SLIP, _FAST_SLIP = 0.03, 0.005
"""Velocity scales of the smooth and the sharp friction among the regressors [m/s]."""
_WORTH_NAMING = 0.1
"""R2 from which a family of regressors is named in the report."""


def explain_signal(
    problem: DiagnosisProblem, parameters: Parameters, signals: Mapping[str, Array]
) -> tuple[dict[str, float], float]:
    """Return the share of a signal that each family of regressors predicts, and how far it follows the motion.

    A share is of the variance about the mean of each run (R2 on runs left out): an offset is no more a sign of the
    motion than a mean current is. `everything` stands for all families together; a family alone may predict better,
    since it overfits less.
    """
    regressors = {run: _list_regressors(problem, parameters, run) for run in problem.runs}
    target = {run: _decimate(problem, signals[run] - np.mean(signals[run])) for run in problem.runs}
    families = list(regressors[problem.runs[0]])
    shares = {
        family: predict_share({run: each[family] for run, each in regressors.items()}, target) for family in families
    }
    everything = {run: np.concatenate(list(each.values())) for run, each in regressors.items()}
    shares["everything"] = max(predict_share(everything, target), *shares.values())
    rows = round(BLOCK_LENGTH * problem.rate / _find_factor(problem))
    return shares, _measure_following(regressors, target, rows)


def _measure_following(regressors: Mapping[str, Mapping[str, Array]], target: Mapping[str, Array], rows: int) -> float:
    """Return the share of the changes of a signal's strength in a run (adjusted R2) that those of the motion explain.

    What a wrong law leaves swells and fades with the motion, however little of it any regressor predicts; a force of
    its own does not know the motion. Strengths are logarithms of the power in blocks of so many rows: of the signal, of
    the simulated velocity and of the floor. Runs are compared with themselves alone, since a cause of its own may
    differ from run to run.
    """
    strengths = []
    for run, families in regressors.items():
        motion = [families[name][0] for name in ("velocity", "floor motion") if name in families]
        blocks = [each[: len(each) // rows * rows].reshape(-1, rows) for each in (target[run], *motion)]
        of_run = np.log(np.var(blocks, axis=2) + _LEAST_POWER)
        strengths += [of_run - of_run.mean(axis=1, keepdims=True)] if of_run.size else []
    changes = np.hstack(strengths) if strengths else np.zeros((1, 0))
    signal, motions = changes[0], changes[1:]
    free, power = len(signal) - len(strengths), float(signal @ signal)
    if free <= len(motions) or power == 0.0:
        return 0.0
    error = signal - np.linalg.lstsq(motions.T, signal, rcond=None)[0] @ motions
    return max(0.0, 1.0 - float(error @ error) / power * free / (free - len(motions)))


def predict_share(regressors: Mapping[str, Array], target: Mapping[str, Array]) -> float:
    """Return the share of the runs' variance that a ridge regression on the other runs predicts, at least 0.

    Args:
        regressors: by run, shape (regressors, samples).
        target: by run, shape (samples,); a single run is cut into halves.
    """
    missed, power = 0.0, 0.0
    if len(target) == 1:
        (known,), (values,) = regressors.values(), target.values()
        halves = {"first": slice(0, len(values) // 2), "second": slice(len(values) // 2, None)}
        regressors = {half: known[:, part] for half, part in halves.items()}
        target = {half: values[part] for half, part in halves.items()}
    for left_out, truth in target.items():
        others = [run for run in target if run != left_out]
        known, values = np.hstack([regressors[run] for run in others]), np.concatenate([target[run] for run in others])
        error = truth - _regress(known, values) @ regressors[left_out]
        missed, power = missed + float(error @ error), power + float(truth @ truth)
    return max(0.0, 1.0 - missed / max(power, 1e-30))


def _regress(regressors: Array, target: Array) -> Array:
    """Return the coefficients of a ridge regression, shape (regressors,), each regressor scaled to unit RMS."""
    scale = np.sqrt(np.mean(regressors**2, axis=1)) + 1e-12
    scaled = regressors / scale[:, None]
    normal = scaled @ scaled.T
    ridge = max(_RIDGE * np.trace(normal) / len(normal), _LEAST_RIDGE) * np.eye(len(normal))
    return np.asarray(np.linalg.solve(normal + ridge, scaled @ target) / scale)


def _decimate(problem: DiagnosisProblem, values: Array) -> Array:
    factor = _find_factor(problem)
    return np.asarray(decimate(values, factor, ftype="fir")) if factor > 1 else values


def _find_factor(problem: DiagnosisProblem) -> int:
    return max(1, round(problem.rate / _RATE))


def _list_regressors(problem: DiagnosisProblem, parameters: Parameters, run: str) -> dict[str, Array]:
    """Return families of regressors at the regression's rate, shape (regressors, samples) each."""
    outputs = problem.simulated(run, parameters.deviations, parameters.effects)
    simulated = dict(zip(problem.channels, outputs, strict=True))
    samples, table = problem.measured[run].shape[1], problem.recording.table(run)
    floor = table["floor_acceleration"][problem.skip : problem.skip + samples]
    current = simulated.get("coil_current", table.get("coil_current", table.get("current_command", np.zeros(0))))
    current = current[-samples:] if len(current) >= samples else np.zeros(samples)
    x = simulated.get("suspension_displacement")
    if x is None:
        return {"floor motion": _lag(_decimate(problem, floor))}
    v = np.gradient(x, 1.0 / problem.rate)
    x, v, i, a = (_decimate(problem, values) for values in (x, v, current, floor))
    slow, fast = np.tanh(v / _SLOW_SLIP), np.tanh(v / _FAST_SLIP)
    families = {
        "displacement": np.array([x, x * np.abs(x), x**3]),
        "velocity": np.array([v, v * np.abs(v), v**3, slow, fast]),
        "velocity and current": np.array([i, i * v, i * slow, i * fast, i**2 * slow, i * x, np.gradient(i)]),
        "past motion": np.concatenate([_lag(x), _lag(v)]),
        "remembered motion": np.array([x, v, *(_remember(each, time) for each in (x, v) for time in _MEMORIES)]),
        "floor motion": _lag(a),
    }
    return {family: each - each.mean(axis=1, keepdims=True) for family, each in families.items()}


def _lag(values: Array) -> Array:
    """Return values and their past ones, shape (lags, samples); before the start the first value is repeated."""
    return np.array([np.concatenate([np.full(k, values[0]), values[: len(values) - k]]) for k in range(_LAGS)])


def _remember(values: Array, time: float) -> Array:
    """Return the exponentially weighted mean of present and past values over a time in s, at rest before the start."""
    kept = np.exp(-1.0 / (time * _RATE))
    return np.asarray(lfilter([1.0 - kept], [1.0, -kept], values))


class Discrepancy(NamedTuple):
    """An unexplained signal by run, and the shares of its variance that families of regressors predict.

    `channel` is the one whose error it is; empty for a force, an acceleration or a current. `following` is the share of
    the changes of its strength that those of the motion explain.
    """

    block: str
    quantity: str
    unit: str
    signals: dict[str, Array]
    shares: dict[str, float]
    channel: str = ""
    following: float = 0.0

    @property
    def rms(self) -> float:
        """RMS over all runs."""
        return float(np.sqrt(np.mean(np.concatenate(list(self.signals.values())) ** 2)))


def describe_discrepancy(
    problem: DiagnosisProblem, parameters: Parameters, block: str, hypothesis: FaultHypothesis
) -> Discrepancy:
    """Return the unexplained signal in a block of the seat and what predicts it."""
    signals = hypothesis.signals
    shares, following = explain_signal(problem, parameters, signals)
    return Discrepancy(block, hypothesis.quantity, hypothesis.unit, signals, shares, hypothesis.channel, following)


def is_bias_drift(settings: LocalisationSettings, found: Discrepancy, rate: float, noise: float) -> bool:
    """Whether the discrepancy is the bias drift of a sensor: it is slow, but for noise.

    `rate` is the sample rate of the signals in Hz, `noise` the RMS of the sensor's own noise in their unit.
    """
    slow = power = 0.0
    for signal in found.signals.values():
        spectrum = np.abs(np.fft.rfft(signal)) ** 2
        slow += float(np.sum(spectrum[: int(settings.slow_frequency * len(signal) / rate) + 1]))
        power += float(np.sum(spectrum)) - noise**2 * len(signal) * len(spectrum)
    return found.block == "sensor" and slow > settings.slow_share * power


def describe_in_words(found: Discrepancy) -> list[str]:
    """Return sentences on an unexplained signal."""
    name = name_signal(found.block, found.quantity, "unexplained {} {}")
    sentences = [f"The {name} has an RMS of {found.rms:.3g} {found.unit}."]
    families = {family: share for family, share in found.shares.items() if family != "everything"}
    best = max(families, key=lambda family: families[family])
    if families[best] < _WORTH_NAMING:
        sentences.append("No motion, current or temperature of the simulated rig predicts it on a run left out.")
    else:
        sentences.append(f"It follows {best} best, which predicts {families[best]:.0%} of its power on runs left out.")
    for family, share in sorted(families.items(), key=lambda item: -item[1])[1:3]:
        sentences.append(f"The {family} predicts {share:.0%} of it.")
    return sentences


def show_discrepancy(problem: DiagnosisProblem, found: Discrepancy, run: str) -> DiscrepancySignal:
    """Return the signal on a run, as the report draws it."""
    samples = len(found.signals[run])
    time = (problem.skip + np.arange(samples)) / problem.rate
    return DiscrepancySignal(
        found.block, found.quantity, found.unit, time, found.signals[run], describe_in_words(found)
    )
