"""Issues that an examination finds, and a run under examination: its table, and what its recording states of it."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np

from seatsim.recordings.recording import COMMANDS, Recording
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.fields import read_packaged

Table = Mapping[str, Array]

LATE = 0.05
"""s; least delay of a channel that is a fault of the data, and largest loss of rows; a slow coil may be twice as late.

A smaller delay of a sensor or logger is a cause of a gap (sensor.lag, sensor.clock_skew) for the diagnosis to find.
"""
_AT_REST = 3.0
"""Standard deviation, over the stated noise, up to which a channel is taken to be at rest: noise is stated roughly."""
Severity = Literal["error", "warning", "note"]


class Issue(NamedTuple):
    """One issue; `kind` is a word for it, `channel` and `run` are None where it concerns all of them.

    `sentence` names the place and says what to do about it.
    """

    severity: Severity
    kind: str
    sentence: str
    channel: str | None = None
    run: str | None = None


class _Finding(NamedTuple):
    """What a check says where it finds something: `text` has places for figures."""

    severity: Severity
    kind: str
    text: str


_FINDINGS = read_packaged(Path(__file__).with_name("findings.yaml"), dict[str, _Finding])
"""Findings of all checks by name."""


def _state(name: str, scope: str, channel: str | None, severity: Severity | None, **figures: object) -> Issue:
    """Return a finding with its figures: of a channel, of a scope such as a run, or of both."""
    usual, kind, text = _FINDINGS[name]
    place = ", ".join(filter(None, (scope, channel)))
    return Issue(severity or usual, kind, f"{place}: {text.format(**figures)}", channel)


def doubt(name: str, channel: str, **figures: object) -> Issue:
    """Return a finding of a channel alone."""
    return _state(name, "", channel, None, **figures)


def issue_in_all_runs(
    name: str, channel: str | None = None, severity: Severity | None = None, **figures: object
) -> Issue:
    """Return a finding of all runs together, or of one channel in all of them."""
    return _state(name, "all runs", channel, severity, **figures)


def place_in_run(run: str, issues: Iterable[Issue]) -> list[Issue]:
    """Return issues of channels as those of a run."""
    return [issue._replace(sentence=f"{run}, {issue.sentence}", run=run) for issue in issues]


def settle_refusals(issues: Iterable[Issue], accepted: Sequence[str]) -> list[Issue]:
    """Return issues whose errors are notes where a recording accepts their kind, and say how to accept it elsewhere."""
    return [_settle(issue, accepted) if issue.severity == "error" else issue for issue in issues]


def _settle(error: Issue, accepted: Sequence[str]) -> Issue:
    if error.kind in accepted:
        return error._replace(severity="note", sentence=f"{error.sentence}; accepted by its owner")
    how = f"if it is right as it is, write accept: [{error.kind}] in recording.yaml"
    return error._replace(sentence=f"{error.sentence}; {how}")


def select_errors(issues: Sequence[Issue]) -> list[Issue]:
    """Return the issues because of which a recording cannot be trusted."""
    return [issue for issue in issues if issue.severity == "error"]


def is_at_rest(values: Array, noise: float) -> bool:
    """Say whether values show hardly more than their noise."""
    return float(np.std(values)) <= _AT_REST * noise


class RunUnderTest(NamedTuple):
    """One run under examination: its table, and the statements of the recording about it."""

    name: str
    table: Table
    recording: Recording
    nominal: Scenario

    @property
    def rate(self) -> float:
        """Rows per second."""
        return self.recording.header.sample_rate

    @property
    def rows(self) -> int:
        """Rows of the table."""
        return len(next(iter(self.table.values())))

    @property
    def driver(self) -> str:
        """Channel of the excitation."""
        return "floor_acceleration" if "floor_acceleration" in self.table else "displacement"

    @property
    def opposes_command(self) -> bool:
        """Whether the coil current falls where its command rises."""
        commands = [self.table[name] for name in COMMANDS if name in self.table]
        coil = self.table["coil_current"]
        return any(float(np.cov(coil, each)[0, 1]) < -0.5 * np.std(coil) * np.std(each) for each in commands)

    def noise(self, channel: str) -> float:
        """Return the stated noise of a channel."""
        return self.recording.channels[channel].noise_rms

    def is_still(self, channel: str) -> bool:
        """Say whether a channel shows hardly more than its noise."""
        return is_at_rest(self.table[channel], self.noise(channel))

    def issue(
        self, name: str, channel: str | None = None, severity: Severity | None = None, **figures: object
    ) -> Issue:
        """Return a finding of this run, or of one channel of it."""
        return _state(name, self.name, channel, severity, **figures)._replace(run=self.name)
