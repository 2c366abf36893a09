"""What each command prints with `--json`: one object, whose JSON Schema `seatsim schema COMMAND` prints.

An object may have more keys than stand here. Numbers that do not exist are null.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import cast

from pydantic import TypeAdapter
from typing_extensions import TypedDict

Figures = dict[str, float | None]


class Answer(TypedDict):
    """What all commands print: the files that were written."""

    files: list[str]


class Gap(TypedDict):
    """A gap in standard deviations of the measured signals."""

    overall: float | None
    channels: Figures


class MetricFigure(TypedDict):
    """A metric of a run."""

    value: float | None
    unit: str
    meaning: str


class RunSummary(TypedDict):
    """A run: its scenario, what sets it apart (variant, swept values), its metrics by name, why they are unverified."""

    scenario: str
    label: dict[str, object]
    metrics: dict[str, MetricFigure]
    warnings: list[str]
    unverified: list[str]
    notes: list[str]


class RunResult(TypedDict):
    """The runs of a table."""

    runs: list[RunSummary]


class RunAnswer(Answer):
    """Results, one for each file (`run`) or one of all files (`compare`); `failed` says which runs failed, and why."""

    results: list[RunResult]
    failed: list[str]


class RunCounts(TypedDict):
    """Runs of a sweep by state."""

    runs: int
    done: int
    failed: int
    unverified: int
    pending: int


class SweepAnswer(Answer):
    """A sweep, as in `manifest.json`; `failed` says which runs failed, and why."""

    identity: str
    counts: RunCounts
    failed: list[str]


class SlurmAnswer(Answer):
    """A script for an array of tasks, which run a sweep of so many runs."""

    runs: int


class LimitExceeded(TypedDict):
    """How many of the runs of a group (texts that were varied) exceed a limit; the Wilson interval of the share."""

    group: dict[str, object]
    metric: str
    unit: str
    limit: float
    exceeding: int
    runs: int
    share: float
    low: float
    high: float


class KeySensitivity(TypedDict):
    """Sobol indices of a key with intervals, as in `sensitivity.csv`."""

    metric: str
    key: str
    first: float | None
    total: float | None
    explained: float | None


class SweepReportAnswer(Answer):
    """The report of a sweep."""

    sentence: str
    exceeded: list[LimitExceeded]
    sensitivities: list[KeySensitivity]


class SynthesisAnswer(Answer):
    """A design, as in `design.yaml`."""

    gain: list[list[float]]
    gamma: float
    lower_bound: float


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


class Name(TypedDict):
    """A name that can stand in a scenario."""

    name: str
    kind: str
    title: str
    text: str
    source: str
    own: bool
    keys: list[dict[str, object]]


class DescriptionAnswer(Answer):
    """All names, or the one that was asked for."""

    names: list[Name]


class NewAnswer(Answer):
    """What was written."""

    kind: str


class CheckAnswer(Answer):
    """A file without errors."""

    file: str
    kind: str
    holds: list[str]
    warnings: list[str]


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


class SeatTestAnswer(Answer):
    """A seat test, as in `seat_test.json`."""

    source: str
    standard: str
    classes: list[dict[str, object]]
    damping: list[dict[str, object]]
    failed: list[dict[str, object]]
    notes: list[str]


class ExportedVariable(TypedDict):
    """A parameter, input or output of what was exported."""

    name: str
    causality: str
    unit: str
    meaning: str
    start: float | int | bool


class ExportAnswer(Answer):
    """What was exported, with its step in s."""

    name: str
    step: float
    variables: list[ExportedVariable]
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


class ExploreAnswer(Answer):
    """A page that is served until the command is interrupted."""

    address: str


class RunCost(TypedDict):
    """What something costs, and its ratio to the cost of what stands in `beside`."""

    part: str
    what: str
    value: float
    unit: str
    ratio: float
    beside: str


class BenchAnswer(Answer):
    """Costs of runs on this machine, and the parts that were left out with the reason."""

    costs: list[RunCost]
    left_out: dict[str, str]


class DifferenceFound(TypedDict):
    """An input or a file that is not as it was."""

    path: str
    problem: str


class ReproduceAnswer(Answer):
    """What came of running a command again, as in `reproduce.json`."""

    command: str
    identical: bool
    compared: list[str]
    differences: list[DifferenceFound]
    versions: list[str]


class ErrorAnswer(TypedDict):
    """What any command prints where it ends with an error."""

    error: str


ANSWERS: Mapping[str, object] = {
    "run": RunAnswer, "compare": RunAnswer, "sweep": SweepAnswer | SlurmAnswer, "sweep-report": SweepReportAnswer,
    "synthesise": SynthesisAnswer, "gap": GapAnswer,
    "diagnose": DiagnosisAnswer, "characterise": CharacterisationAnswer,
    "identify": IdentificationAnswer | LeagueAnswer, "describe": DescriptionAnswer, "new": NewAnswer,
    "check": CheckAnswer, "import": ImportAnswer, "inspect": InspectionAnswer, "comfort": ComfortAnswer,
    "seat-test": SeatTestAnswer, "export": ExportAnswer, "blind-make": BlindMakeAnswer, "blind-score": BlindScoreAnswer,
    "blind-power": BlindPowerAnswer, "bench": BenchAnswer, "explore": ExploreAnswer, "reproduce": ReproduceAnswer,
    "error": ErrorAnswer,
}  # fmt: skip
"""What each command prints; `error` is what any of them prints where it fails."""


def answer_schema(command: str) -> dict[str, object]:
    """Return the JSON Schema of what a command prints with `--json`."""
    return {"title": f"seatsim {command} --json", **TypeAdapter(cast("type", ANSWERS[command])).json_schema()}
