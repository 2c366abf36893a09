"""The result of a diagnosis: the values behind `diagnosis.json` and the figures of its report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Literal, NamedTuple

from seatsim.recordings.gap import GapFigures
from seatsim.recordings.model_error import ModelError
from seatsim.recordings.validation import ErrorBudget
from seatsim.schema.arrays import Array
from seatsim.schema.content import Form, IfAny, Unwritten, show_record

Content = Mapping[str, object]
"""What a YAML file holds: sections by key."""


class Estimate(NamedTuple):
    """A fitted parameter with its standard deviation and unit, the range of its fit, and whether it is at an end of it.

    A parameter that is off, such as a drift of 0, is at no end.
    """

    value: float
    std: float
    unit: str
    bound: tuple[float, float] | None = None
    at_bound: bool = False


class Cause(NamedTuple):
    """An effect: its probability, and the share by which it alone reduces the calibrated gap on held-out runs.

    `at_bound` says whether all of its size lies at an end of its range.
    """

    effect: str
    probability: float
    shrink: float
    parameters: dict[str, Estimate | str]
    at_bound: bool = False


class Share(NamedTuple):
    """Share of the gap that lies in a block."""

    block: str
    share: float


class RunGaps(NamedTuple):
    """Gaps of one run: nominal, with refitted parameters, with the effects, of the noise alone; what it shrinks by."""

    run: str
    before: GapFigures
    calibrated: GapFigures
    after: GapFigures
    floor: GapFigures
    shrink: float


class CalibratedParameter(NamedTuple):
    """A nuisance parameter of the rig stated, by dotted key, between its bounds."""

    name: str
    nominal: float
    value: float
    bound: tuple[float, float]
    at_bound: bool
    unit: str = "-"


@dataclass(frozen=True)
class Gaps:
    """Gaps on held-out runs: nominal, with refitted parameters, with the effects, and that of the noise alone.

    `shrink` is from before to after; `shrink_interval` is its 90 % interval on other runs of the kind; `by_run` are the
    gaps of every run under the same scenarios.
    """

    before: GapFigures
    calibrated: GapFigures
    after: GapFigures
    floor: GapFigures
    shrink: float
    shrink_interval: tuple[float, float]
    by_run: Sequence[RunGaps] = ()


@dataclass(frozen=True)
class Trace:
    """A compared channel of a held-out run: time in s, measured, and simulated three times, shape (N,) each."""

    run: str
    channel: str
    unit: str
    noise_rms: float
    time: Array
    measured: Array
    nominal: Array
    calibrated: Array
    after: Array


def name_signal(block: str, quantity: str, words: str) -> str:
    """Return what an unexplained signal in a block is called: that of a sensor its error, else words on what and where.

    A force from outside on the frame, which no channel records, is counted among what comes by the floor.
    """
    shown = quantity.replace("_", " ")
    if block == "sensor":
        return f"error of the {shown.removeprefix('error of ')}'s sensor"
    return words.format(shown, "on the frame" if (block, quantity) == ("floor", "force") else f"in the {block}")


class DiscrepancySignal(NamedTuple):
    """An unexplained signal on the held-out run, shape (N,) as `time` in s, with sentences on it."""

    block: str
    quantity: str
    unit: str
    time: Array
    values: Array
    description: list[str]

    @property
    def words(self) -> str:
        """What it is called, in a picture and in the report."""
        return name_signal(self.block, self.quantity, "{} that the simulation lacks {}")


class Collinearity(NamedTuple):
    """Effects, and how collinear their sensitivities are, shape (effects, effects), 0 to 1.

    Sensitivities are taken in this recording, about the calibrated rig, with the nuisance parameters projected out.
    """

    effects: list[str]
    matrix: Array


class ComfortFigure(NamedTuple):
    """An RMS figure on held-out runs: measured, of the nominal rig and of the augmented one."""

    quantity: str
    unit: str
    measured: float
    nominal: float
    after: float


@dataclass(frozen=True)
class Evidence:
    """What the pictures show.

    `traces`: held-out signals; `other_traces`: those of the runs that were fitted, with the same rigs.
    `motion`: of the measured rig on the held-out run, `velocity` and `displacement` of the suspension, `coil_current`
    and `damper_temperature` where known, shape (N,) each. `discrepancy`: the unexplained signal, if any. `comfort`:
    figures such as the RMS acceleration of the driver.
    """

    traces: list[Trace]
    motion: dict[str, Array]
    discrepancy: DiscrepancySignal | None
    collinearity: Collinearity
    comfort: list[ComfortFigure]
    other_traces: list[Trace] = field(default_factory=list)


@dataclass(frozen=True)
class ProposedExperiment:
    """An experiment that distinguishes equivalent effects; likeness of their worst pair before and after it, 0 to 1.

    `scenario` is the content of a scenario that runs the excitation, where the rig is a seat; `set` is what a recording
    states of a run with the rig changed so.
    """

    kind: Literal["excitation", "intervention", "none"]
    name: str
    reason: str
    likeness_now: Annotated[float, Form(key="alikeness_now")]
    likeness_then: Annotated[float, Form(key="alikeness_then")]
    scenario: Annotated[Content | None, Form(key="file", file="experiment.yaml", if_any=True)] = None
    set: IfAny[Mapping[str, float]] = field(default_factory=dict)


class DamperForm(NamedTuple):
    """Another model of the damper in the place of the nominal's, free of its tolerance, fitted without held-out runs.

    model: its registered name; `replaces`: that of the nominal scenario. beside: effects that it stands beside, none
    where it stands instead of any. shrink: of the overall gap on held-out runs, from the calibrated rig to the rig with
    this damper and these effects. refitted: the same for the nominal's own model, fitted as freely. parameters: of the
    model, by name; a law in the current by its coefficients.
    """

    model: str
    replaces: str
    beside: tuple[str, ...]
    shrink: float
    refitted: float
    parameters: dict[str, float | str | tuple[float, ...]]


@dataclass(frozen=True)
class Diagnosis:
    """Where the gap between a recording and its nominal simulation lies, which effect causes it, how far it shrinks.

    It is the content of `diagnosis.json`.

    `sentence` is the answer in one sentence. `notes` are sentences on the data, what the channels cannot distinguish,
    and on cautions. `stochastic` is the selected effect whose signal is random, else empty. `augmented` is the content
    of `augmented.yaml`, `model_error` what that leaves. `alternatives` are other models of the damper, the best first.
    """

    name: Unwritten[str]
    verdict: Literal["none", "known", "ambiguous", "unknown"]
    sentence: str
    where: list[Share]
    causes: list[Cause]
    probability_none: float
    probability_unknown: float
    selected: list[str]
    stochastic: Unwritten[str]
    indistinguishable: list[list[str]]
    experiment: ProposedExperiment | None
    held_out: list[str]
    isolable: list[list[str]]
    gap: Gaps
    notes: list[str]
    augmented: Annotated[Content, Form(file="augmented.yaml")]
    evidence: Unwritten[Evidence]
    alternatives: Sequence[DamperForm] = ()
    parameters: Annotated[list[CalibratedParameter], Form(key="calibrated_parameters")] = field(default_factory=list)
    model_error: ModelError | None = None
    error_budget: list[ErrorBudget] = field(default_factory=list)

    def __repr__(self) -> str:
        """Say what was found."""
        return f"<Diagnosis {self.verdict}: {', '.join(self.selected) or 'no effect'}; {self.sentence}>"

    def _repr_html_(self) -> str:
        return show_record(self, "verdict", "sentence", "probability_none", "probability_unknown", "where", "causes")
