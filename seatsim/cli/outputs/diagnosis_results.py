"""What the commands on gaps and diagnoses print and write: gap, diagnose, blind score."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

from seatsim.cli.outputs.writing import write_outputs
from seatsim.cli.show_table import show_report_tables
from seatsim.cli.terminal import conclude, say, warn
from seatsim.diagnosis.result import Diagnosis
from seatsim.recordings.gap import Forecast, Gap
from seatsim.report.blocks import Table, tabulate
from seatsim.report.diagnosis import report_diagnosis, tabulate_diagnosis
from seatsim.report.gap import report_gap, tabulate_gaps
from seatsim.scenario.loading import single
from seatsim.schema.fields import read_packaged
from seatsim.schema.printing import format_percent
from seatsim.schema.yaml_text import dump

if TYPE_CHECKING:
    from seatsim.blind.score.score import Failure, Score
    from seatsim.blind.score.verdicts import Rate


def present_gap(found: Gap, scenario: str, recording: Path, folder: Path) -> None:
    """Print the gap of a replayed scenario; write `gap.json`, and `report.html` where outputs were measured."""
    show_report_tables(_tabulate_forecast(found) if isinstance(found, Forecast) else tabulate_gaps(found))
    warn(found.notes)
    contents: dict[str, object] = {"gap.json": found}
    if found.channels:
        name = f"{Path(scenario).stem} against {recording.resolve().name}"
        command = f"seatsim gap {Path(scenario).name} {recording.name}"
        contents["report.html"] = report_gap(name, found, command)
    conclude(found, folder, write_outputs(folder, contents))


def present_diagnosis(diagnosis: Diagnosis, folder: Path) -> None:
    """Print the gaps, the likely causes, the verdict and the answer in a sentence; write the files of a diagnosis."""
    show_report_tables(tabulate_diagnosis(diagnosis))
    warn(diagnosis.notes)
    say(f"verdict: {diagnosis.verdict}")
    say(diagnosis.sentence)
    conclude(diagnosis, folder, write_diagnosis(diagnosis, folder))


def write_diagnosis(diagnosis: Diagnosis, folder: Path) -> list[Path]:
    """Write `diagnosis.json`, `augmented.yaml`, `report.html`, and `experiment.yaml` where one is proposed.

    Raises:
        InputError: a scenario that was found could not be loaded again, or the folder cannot be written.
    """
    scenarios = {"augmented.yaml": diagnosis.augmented}
    if diagnosis.experiment is not None and diagnosis.experiment.scenario is not None:
        scenarios["experiment.yaml"] = diagnosis.experiment.scenario
    for content in scenarios.values():
        single(content)
    texts = {name: dump(content, line_each=True) for name, content in scenarios.items()}
    return write_outputs(folder, {**texts, "report.html": report_diagnosis(diagnosis), "diagnosis.json": diagnosis})


def _tabulate_forecast(found: Forecast) -> list[Table]:
    """Return the gap to be expected before and after, beside the measured one where outputs are recorded."""
    predicted, measured = found.predicted, found.measured
    low, high = predicted.shrink_interval
    title = f"expected shrink {predicted.shrink:.2f}, 90 % interval {low:.2f} to {high:.2f}"
    gaps = {"overall": [predicted.before, predicted.after]}
    gaps |= {name: list(expected) for name, expected in predicted.channels.items()}
    if measured is not None:
        title += f"; measured {measured.shrink:.2f}"
        for name, row in gaps.items():
            row += [part.get(name, math.nan) for part in (measured.channels, found.channels)]
        gaps["overall"][2:] = [measured.before, found.overall]
    headings = ("channel", "expected before", "expected after", "measured before", "measured after")
    rows = [(name.replace("_", " "), *map(format_percent, row)) for name, row in gaps.items()]
    return tabulate(title, headings[: len(rows[0])], rows)


_FAILURES_LISTED = 12
"""Failures in the table."""


def tabulate_score(score: Score) -> list[Table]:
    """Return the summary of a score and its failures as tables; score.json has more."""
    failures = [_describe(failure) for failure in score.failures[:_FAILURES_LISTED]]
    if (more := len(score.failures) - _FAILURES_LISTED) > 0:
        failures.append((f"and {more} more", *[""] * 6))
    summary = tabulate(f"blind score, {score.cases} cases", "what, share, count, 95 % interval", _summarise(score))
    return [*summary, *tabulate("failures", "case, truth, limit x, missing, verdict, named, where", failures)]


def _cells(rate: Rate) -> tuple[str, str, str]:
    low, high = rate.interval
    return f"{rate.value:.3f}", f"{rate.right}/{rate.total}", f"{low:.2f}-{high:.2f}"


def _summarise(score: Score) -> list[tuple[str, ...]]:
    """Return the rows of the summary: rates of what is right, then figures of probabilities and of the shrink."""
    rates = {"right": score.right} | {f"right: {kind}": value for kind, value in score.kinds.items()}
    named = read_packaged(Path(__file__).with_name("score.yaml"), dict[str, str])
    rates |= {words: getattr(score, name) for words, name in named.items()}
    rows: list[tuple[str, ...]] = [(name, *_cells(rate)) for name, rate in rates.items() if rate.total]
    if score.untouched:
        said = ", ".join(f"{name} {count}" for name, count in score.untouched.items())
        cases = str(sum(score.untouched.values()))
        rows.append(("untouched carriers (not scored)", said, cases, ""))
    figures = {"calibration error (ECE)": f"{score.calibration_error:.4f}", "Brier": f"{score.brier:.4f}"}
    rows += [(name, figure, "", "") for name, figure in figures.items()]
    for word, shrink in (("stated", score.shrink), ("predicted", score.shrink and score.shrink.predicted)):
        if shrink is not None:
            rows.append((f"shrink: |{word} - true|", f"{shrink.mean_difference:.3f}", str(len(shrink.cases)), ""))
            rows.append((f"shrink: {word} - true", f"{shrink.bias:+.3f}", "", ""))
            rows.append((f"shrink: interval {word} covers", *_cells(shrink.coverage)))
    return rows


def _describe(failure: Failure) -> tuple[str, ...]:
    true = ", ".join(failure.effects) or ", ".join(failure.forms) or "none"
    sizes, missing = ", ".join(f"{size:.1f}" for size in failure.materialities), ", ".join(failure.missing)
    named = ", ".join(failure.selected or failure.named[:1])
    return failure.case, true, sizes, missing, failure.verdict, named, ", ".join(failure.where)
