"""What is wrong with a recording, said before anything is fitted.

An `error` would lead to a wrong confident verdict, so that the diagnosis refuses; a `warning` is said and the diagnosis
goes on; a `note` is worth knowing. Thresholds are gross, because the gap between a rig and its simulation is no damage.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from seatsim.recordings.quality.channels import ranges, shapes
from seatsim.recordings.quality.consistency import contradictions, exchanged_currents
from seatsim.recordings.quality.floor import floor
from seatsim.recordings.quality.issue import Finding, Run
from seatsim.recordings.quality.runs import clock, together
from seatsim.recordings.recording import Recording
from seatsim.scenario.loading import single
from seatsim.schema.errors import InputError

ORDER = ("error", "warning", "note")


@dataclass(frozen=True)
class Examination:
    """All findings, errors first."""

    findings: list[Finding]

    @property
    def errors(self) -> list[Finding]:
        """Findings for which the diagnosis must refuse."""
        return _errors(self.findings)


def _errors(findings: Sequence[Finding]) -> list[Finding]:
    return [finding for finding in findings if finding.severity == "error"]


def examine(recording: Recording) -> Examination:
    """Look at all runs of a recording and say what is wrong with them; a later check asks only where none found errors.

    Raises:
        InputError: the nominal scenario is wrong.
    """
    runs, findings = _read(recording)
    if not _errors(findings):
        findings += together(runs)
    if not _errors(findings):
        findings += _merged([finding for run in runs for finding in _each(run)], len(runs))
    return Examination(sorted(findings, key=lambda finding: ORDER.index(finding.severity)))


def refuse(examination: Examination) -> None:
    """Raise what stands against a diagnosis, in one sentence.

    Raises:
        InputError: there is an error among the findings.
    """
    errors = examination.errors
    if errors:
        more = f" (and {len(errors) - 1} more)" if len(errors) > 1 else ""
        raise InputError(f"{errors[0].sentence}{more}")


def _read(recording: Recording) -> tuple[list[Run], list[Finding]]:
    """Return the runs that can be read, and what is wrong with their clocks or forbids reading them."""
    nominal = single(recording.nominal)
    runs, findings = [], []
    for name in recording.runs:
        try:
            run = Run(name, recording.table(name), recording, nominal)
        except InputError as error:
            findings.append(Finding("error", "unreadable", str(error), run=name))
        else:
            runs.append(run)
            findings += clock(run)
    return runs, findings


def _each(run: Run) -> list[Finding]:
    """Return what is wrong with one run; a later check asks only where the earlier ones found no error."""
    findings: list[Finding] = []
    for check in (ranges, exchanged_currents, shapes, floor, contradictions):
        findings += check(run)
        if _errors(findings):
            break
    return findings


def _merged(findings: Sequence[Finding], runs: int) -> list[Finding]:
    """Return the findings with those that all runs share said once."""
    groups: dict[tuple[str, str, str | None], list[Finding]] = {}
    for finding in findings:
        groups.setdefault((finding.severity, finding.kind, finding.channel), []).append(finding)
    merged = []
    for group in groups.values():
        if runs > 1 and len({finding.run for finding in group}) == runs:
            first = group[0]
            text = first.sentence.replace(str(first.run), f"all runs (shown: {first.run})", 1)
            merged.append(first._replace(sentence=text, run=None))
        else:
            merged += group
    return merged
