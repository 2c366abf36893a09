"""Answers of the commands on measurements: gap, diagnose, characterise, identify, import, inspect, comfort, blind."""

from __future__ import annotations

from typing_extensions import TypedDict

from seatsim.cli.outputs.answers.common import Answer, Figures, Gap


class GapAnswer(Answer):
    """A gap, as in `gap.json`."""

    overall: float | None
    channels: Figures
    floor: Gap
    notes: list[str]


class GapsBeforeAndAfter(TypedDict):
    """Gaps of the nominal, the refitted and the augmented scenario, and of the noise alone."""

    before: Gap
    calibrated: Gap
    after: Gap
    floor: Gap
    shrink: float | None
    shrink_interval: list[float | None]


class CauseFound(TypedDict):
    """An effect with its probability and its own shrink."""

    effect: str
    probability: float
    shrink: float | None
    parameters: dict[str, object]
    at_bound: bool


class DiagnosisAnswer(Answer):
    """A diagnosis, as in `diagnosis.json`."""

    verdict: str
    sentence: str
    where: list[dict[str, object]]
    causes: list[CauseFound]
    probability_none: float
    probability_unknown: float
    selected: list[str]
    indistinguishable: list[list[str]]
    experiment: dict[str, object] | None
    held_out: list[str]
    isolable: list[list[str]]
    gap: GapsBeforeAndAfter
    notes: list[str]
    augmented: str


class CharacterisationAnswer(Answer):
    """A characterisation, as in `characterisation.json`."""

    name: str
    source: str
    measured: bool
    records: list[dict[str, object]]
    steps: list[dict[str, object]]
    notes: list[str]


class League(TypedDict):
    """A model of the league, the best first."""

    model: str
    confidence: str
    train_fit_percent: float | None
    test_fit_percent: float | None
    parameters: int
    ns_per_step: float | None
    failed: str


class IdentificationAnswer(Answer):
    """An identification, as in `fit.json`."""

    model: str
    confidence: str
    train: Figures | None
    test: Figures | None
    records: dict[str, dict[str, object]]
    parameters: list[dict[str, object]]
    not_identified: list[str]
    notes: list[str]


class LeagueAnswer(Answer):
    """Several models, as in `league.csv`."""

    league: list[League]


class Doubt(TypedDict):
    """What is to be looked at in data."""

    severity: str
    kind: str
    sentence: str
    channel: str | None
    run: str | None


class ImportAnswer(Answer):
    """A recording that was made, and from which columns."""

    folder: str
    rig: str
    sample_rate: float | None
    runs: list[str]
    channels: dict[str, dict[str, object]]
    proposed: bool
    notes: list[str]
    doubts: list[Doubt]


class ChannelFigures(TypedDict):
    """A channel of a file, in its unit; `channel` is that of a recording which its name means."""

    group: str
    name: str
    unit: str
    channel: str | None
    rate: float | None
    rows: int
    low: float | None
    high: float | None
    mean: float | None
    rms: float | None
    noise: float | None


class InspectionAnswer(Answer):
    """The channels of a file or a recording."""

    source: str
    format: str
    channels: list[ChannelFigures]
    doubts: list[Doubt]


class AxisFigures(TypedDict):
    """ISO 2631-1 figures of an axis."""

    column: str
    weighting: str
    rms: float | None
    vdv: float | None
    mtvv: float | None
    crest_factor: float | None
    method: str


class ComfortAnswer(Answer):
    """An assessment, as in `comfort.json`."""

    axes: dict[str, AxisFigures]
    a8: float | None
    vdv8: float | None
    notes: list[str]


class BlindMakeAnswer(Answer):
    """A sealed set; the key is shown this once."""

    cases: int
    folder: str
    sealed: str
    key: str


class BlindScoreAnswer(Answer):
    """The score of a sealed set, as in `score.json`."""


class BlindPowerAnswer(Answer):
    """The smallest sizes found, as in `power.json`."""

    draws: int
    effects: list[dict[str, object]]
