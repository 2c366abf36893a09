"""Issues that an examination finds."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Literal, NamedTuple, get_args

from seatsim.recordings.header import Refusal

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


def issue_in_all_runs(severity: Severity, kind: str, text: str, channel: str | None = None) -> Issue:
    """Return an issue of all runs together, or of one channel in all of them."""
    place = f"all runs, {channel}" if channel else "all runs"
    return Issue(severity, kind, f"{place}: {text}", channel)


def place_in_run(run: str, issues: Iterable[Issue]) -> list[Issue]:
    """Return issues of channels as those of a run."""
    return [issue._replace(sentence=f"{run}, {issue.sentence}", run=run) for issue in issues]


def settle_refusals(issues: Iterable[Issue], accepted: Sequence[str]) -> list[Issue]:
    """Return issues whose errors are notes where a recording accepts their kind, and say how to accept it elsewhere."""
    return [_settle(issue, accepted) if issue.severity == "error" else issue for issue in issues]


def _settle(error: Issue, accepted: Sequence[str]) -> Issue:
    if error.kind in accepted:
        return error._replace(severity="note", sentence=f"{error.sentence}; accepted by its owner")
    if error.kind not in get_args(Refusal):
        return error
    how = f"if it is right as it is, write accept: [{error.kind}] in recording.yaml"
    return error._replace(sentence=f"{error.sentence}; {how}")


def select_errors(issues: Sequence[Issue]) -> list[Issue]:
    """Return the issues because of which a recording cannot be trusted."""
    return [issue for issue in issues if issue.severity == "error"]
