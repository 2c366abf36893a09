"""What a diagnosis says: the values behind `diagnosis.json` and the pictures of its report."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Estimate(NamedTuple):
    """A fitted parameter with its standard deviation and unit."""

    value: float
    std: float
    unit: str


class Cause(NamedTuple):
    """An effect: probability of being at work, and what it alone takes off the calibrated gap on held-out runs."""

    effect: str
    probability: float
    shrink: float
    parameters: dict[str, Estimate | str]


class Share(NamedTuple):
    """Share of the gap that lies in a block."""

    block: str
    share: float


@dataclass(frozen=True)
class Gaps:
    """Gaps on held-out runs, each `{"overall": ..., "channels": {...}}`: nominal, refitted, with the effects, noise."""

    before: dict[str, Any]
    calibrated: dict[str, Any]
    after: dict[str, Any]
    floor: dict[str, Any]
    shrink: float
    shrink_interval: tuple[float, float]


@dataclass(frozen=True)
class Trace:
    """A compared channel of a held-out run: time in s and four courses, shape (N,) each."""

    run: str
    channel: str
    unit: str
    noise_rms: float
    time: Array
    measured: Array
    nominal: Array
    calibrated: Array
    after: Array


@dataclass(frozen=True)
class Evidence:
    """What the pictures show.

    `traces`: held-out signals. `motion`: of the measured rig on the held-out run, `velocity` and `displacement` of the
    suspension, `coil_current` and `damper_temperature` where known, shape (N,) each. `latent`: block, what it is, unit,
    and its course in time, where the verdict is unknown. `alikeness`: names of effects and the matrix of how alike
    their traces in this recording are, 0 to 1, after the nuisance parameters are projected out. `comfort`: rows of
    (quantity, unit, measured, nominal, after) on held-out runs, such as the RMS acceleration of the driver.
    """

    traces: list[Trace]
    motion: dict[str, Array]
    latent: dict[str, Any] | None
    alikeness: tuple[list[str], Array]
    comfort: list[tuple[str, str, float, float, float]]


@dataclass(frozen=True)
class Diagnosis:
    """Where the gap between a recording and its nominal simulation lies, which effect causes it, how far it shrinks.

    `sentence` is the answer in one sentence, `notes` are sentences on the data, what the channels forbid, and what to
    mind; `random` is the selected effect whose course is random, else empty; `augmented` is the content of
    `augmented.yaml`, `experiment_scenario` that of a proposed experiment.
    """

    name: str
    verdict: str
    sentence: str
    where: list[Share]
    causes: list[Cause]
    probability_none: float
    probability_unknown: float
    selected: list[str]
    random: str
    indistinguishable: list[list[str]]
    experiment: dict[str, Any] | None
    held_out: list[str]
    isolable: list[list[str]]
    gap: Gaps
    notes: list[str]
    augmented: dict[str, Any]
    experiment_scenario: dict[str, Any] | None
    evidence: Evidence
