"""The model discrepancy: the unexplained signal in a block, and the sentences on it.

A force comes from outside the rig where nothing predicts it on a left-out run and it is equally strong in every run. A
rattle is hard to predict too, but its strength follows the motion.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from seatsim.diagnosis.localise.hypotheses import FaultHypothesis
from seatsim.diagnosis.localise.regression import explain_signal
from seatsim.diagnosis.parameters import Parameters
from seatsim.diagnosis.problem import DiagnosisProblem
from seatsim.diagnosis.result import DiscrepancySignal
from seatsim.diagnosis.settings import DiagnosisSettings
from seatsim.diagnosis.settings.examining import LocalisationSettings
from seatsim.schema.arrays import Array


class Discrepancy(NamedTuple):
    """An unexplained signal by run, and the shares of its variance that families of regressors predict.

    `channel` is the one whose error it is; empty for a force, an acceleration or a current. `comparable` is the part of
    the signal that every run shows.
    """

    block: str
    quantity: str
    unit: str
    signals: dict[str, Array]
    shares: dict[str, float]
    channel: str = ""
    comparable: Mapping[str, Array] = MappingProxyType({})

    @property
    def rms(self) -> float:
        """RMS over all runs."""
        return float(np.sqrt(np.mean(np.concatenate(list(self.signals.values())) ** 2)))


def describe_discrepancy(
    problem: DiagnosisProblem, parameters: Parameters, block: str, hypothesis: FaultHypothesis
) -> Discrepancy:
    """Return the unexplained signal in a block of the seat and what predicts it."""
    shares = explain_signal(problem, parameters, hypothesis.signals)
    return Discrepancy(
        block, hypothesis.quantity, hypothesis.unit, hypothesis.signals, shares, hypothesis.channel,
        hypothesis.comparable,
    )  # fmt: skip


def is_from_outside(settings: DiagnosisSettings, found: Discrepancy, rate: float) -> bool:
    """Whether a force comes from outside the rig: it is not predicted, and as strong in every run but for chance.

    `rate` is the sample rate of the signals in Hz.
    """
    steady = _is_steady(settings.localisation, found, settings.validation.block_length * rate)
    return steady and found.shares["everything"] <= settings.localisation.predicted


def _is_steady(settings: LocalisationSettings, found: Discrepancy, length: float) -> bool:
    """Whether the RMS of a signal is about the same in every run, or differs by no more than in its blocks of time.

    A few knocks make a force whose RMS differs from run to run by chance. `length` is that of a block in samples.
    """
    powers = [
        [float(np.mean(block**2)) for block in np.array_split(values, max(2, round(len(values) / length)))]
        for values in (signal - signal.mean() for signal in found.comparable.values())
    ]
    means, errors = np.array([(np.mean(each), np.var(each, ddof=1) / len(each)) for each in powers]).T
    low, high = np.argmin(means), np.argmax(means)
    chance = settings.steady_by_chance * np.sqrt(errors[low] + errors[high])
    return bool(means[high] <= max(settings.steady**2 * means[low], means[low] + chance))


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


def describe_in_words(settings: LocalisationSettings, found: Discrepancy) -> list[str]:
    """Return sentences on an unexplained signal."""
    sentences = [f"The unexplained {found.quantity} in the {found.block} has an RMS of {found.rms:.3g} {found.unit}."]
    families = {family: share for family, share in found.shares.items() if family != "everything"}
    best = max(families, key=lambda family: families[family])
    if families[best] < settings.worth_naming:
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
    words = describe_in_words(problem.settings.localisation, found)
    return DiscrepancySignal(found.block, found.quantity, found.unit, time, found.signals[run], words)
