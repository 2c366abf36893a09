"""Answers of the commands that simulate: run, compare, sweep, sweep-report, synthesise, seat-test, export."""

from __future__ import annotations

from typing_extensions import TypedDict

from seatsim.cli.outputs.answers.common import Answer


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

    measures: list[str]
    gain: list[list[float]]
    gamma: float
    lower_bound: float


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
