"""Examination of a recording for faults, before anything is fitted.

An `error` would lead to a confident wrong verdict, so diagnosis and gap refuse the recording, unless `recording.yaml`
accepts it by its kind. A `warning` is stated and they continue. A `note` is for information. What an effect of the
library or chance can produce is no error, because a gap between a rig and its simulation is not a fault of the data.
"""

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import chain
from typing import NamedTuple

from seatsim.recordings.quality.channels import check_damage, check_ranges, check_shapes, check_sizes
from seatsim.recordings.quality.issue import Issue, RunUnderTest, place_in_run, select_errors, settle_refusals
from seatsim.recordings.quality.relations import check_consistency, check_exchanged_currents, doubt_relations
from seatsim.recordings.quality.runs import check_all_runs, check_clock, check_rows
from seatsim.recordings.quality.sensors import check_floor_sensor, without_gravity
from seatsim.recordings.recording import Recording
from seatsim.recordings.replay import note_unused_log
from seatsim.scenario.numbers import list_doubts
from seatsim.schema.errors import InputError

_ORDER = ("error", "warning", "note")


class Examination(NamedTuple):
    """All issues of a recording, errors first."""

    issues: list[Issue]

    @property
    def errors(self) -> list[Issue]:
        """Issues for which diagnosis and gap must refuse."""
        return select_errors(self.issues)

    @property
    def sentences(self) -> list[str]:
        """A sentence for the user on each issue."""
        return [issue.sentence for issue in self.issues]


def examine(recording: Recording) -> Examination:
    """Return the issues of all runs of a recording; later checks run only where the earlier ones found no error.

    Gravity in its accelerometers is taken out before anything else is looked at.

    Raises:
        InputError: the nominal scenario is wrong.
    """
    runs, issues = _read(without_gravity(recording))
    if not select_errors(issues):
        issues += settle_refusals(check_all_runs(runs), recording.header.accept)
    if not select_errors(issues):
        # Most of their time goes into simulations, which leave the interpreter free.
        with ThreadPoolExecutor() as pool:
            issues += merge_issues(list(chain.from_iterable(pool.map(_each, runs))), len(runs))
    return Examination(sorted(issues, key=lambda issue: _ORDER.index(issue.severity)))


def refuse(examination: Examination) -> None:
    """Raise an error, in one sentence, where a recording cannot be trusted.

    Raises:
        InputError: there is an error among the issues.
    """
    errors = examination.errors
    if errors:
        more = f" (and {len(errors) - 1} more)" if len(errors) > 1 else ""
        raise InputError(f"{errors[0].sentence}{more}")


def _read(recording: Recording) -> tuple[list[RunUnderTest], list[Issue]]:
    """Return the runs that can be read, and the issues of their clocks and of the runs that cannot be read."""
    nominal = recording.nominal
    runs, issues = [], [Issue("warning", "implausible", sentence) for sentence in list_doubts(nominal)]
    issues += [Issue("warning", "unused", sentence) for sentence in note_unused_log(nominal, recording)]
    for name in recording.runs:
        try:
            run = RunUnderTest(name, recording.table(name), recording, recording.scenario_of(name, nominal))
        except InputError as error:
            issues.append(Issue("error", "unreadable", str(error), run=name))
        else:
            runs.append(run)
            issues += settle_refusals(check_clock(run), recording.header.accept)
    return runs, issues


def _each(run: RunUnderTest) -> list[Issue]:
    """Return the issues of one run; later checks run only where the earlier ones found no error."""
    issues: list[Issue] = []
    for check in CHECKS:
        issues += settle_refusals(check(run), run.recording.header.accept)
        if select_errors(issues):
            break
    return issues


CHECKS: tuple[Callable[[RunUnderTest], Iterable[Issue]], ...] = (
    check_ranges,
    check_exchanged_currents,
    check_shapes,
    check_damage,
    check_rows,
    check_floor_sensor,
    check_consistency,
    check_sizes,
    # signs and units that contradict the laws of motion, whatever the nominal scenario says
    lambda run: place_in_run(run.name, doubt_relations(run.table, run.rate)),
)
"""Checks of one run, in their order."""


def merge_issues(issues: Sequence[Issue], runs: int) -> list[Issue]:
    """Return the issues; one that all runs share is stated once."""
    groups: dict[tuple[str, str, str | None], list[Issue]] = {}
    for issue in issues:
        groups.setdefault((issue.severity, issue.kind, issue.channel), []).append(issue)
    merged = []
    for group in groups.values():
        if runs > 1 and len({issue.run for issue in group}) == runs:
            first = group[0]
            text = first.sentence.replace(str(first.run), f"all runs (shown: {first.run})", 1)
            merged.append(first._replace(sentence=text, run=None))
        else:
            merged += group
    return merged
