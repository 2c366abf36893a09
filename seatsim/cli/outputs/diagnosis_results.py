"""What the commands on gaps and diagnoses print and write: gap, diagnose, blind score."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from rich.table import Table

from seatsim.cli.outputs.writing import write_outputs
from seatsim.cli.show_table import make_table, show_table
from seatsim.cli.terminal import conclude, say, warn
from seatsim.diagnosis.result import Diagnosis
from seatsim.effects.base import EFFECTS
from seatsim.recordings.gap import Forecast, Gap, GapFigures
from seatsim.report.diagnosis import report_diagnosis
from seatsim.report.gap import report_gap
from seatsim.scenario.loading import single
from seatsim.schema.fields import read_packaged
from seatsim.schema.files import write_text
from seatsim.schema.guarded import temporary_folder
from seatsim.schema.registry import is_own
from seatsim.schema.yaml_text import dump

if TYPE_CHECKING:
    from seatsim.blind.score.score import Failure, Score
    from seatsim.blind.score.verdicts import Rate

_LISTED = 6
"""Causes in the table."""


def present_gap(found: Gap, scenario: str, recording: Path, folder: Path) -> None:
    """Print the gap of a replayed scenario; write `gap.json`, and `report.html` where outputs were measured."""
    show_table(_make_gap_table(found))
    warn(found.notes)
    contents: dict[str, object] = {"gap.json": found}
    if found.channels:
        name = f"{Path(scenario).stem} against {recording.resolve().name}"
        command = f"seatsim gap {Path(scenario).name} {recording.name}"
        contents["report.html"] = report_gap(name, found, command)
    conclude(found, folder, write_outputs(folder, contents))


def present_diagnosis(diagnosis: Diagnosis, folder: Path) -> None:
    """Print the gaps, the likeliest causes and the answer in a sentence, and write the files of a diagnosis."""
    show_table(*make_tables(diagnosis))
    warn(diagnosis.notes)
    say(diagnosis.sentence)
    conclude(diagnosis, folder, write_diagnosis(diagnosis, folder))


def write_diagnosis(diagnosis: Diagnosis, folder: Path) -> list[Path]:
    """Write `diagnosis.json`, `augmented.yaml`, `report.html`, and `experiment.yaml` where one is proposed.

    Raises:
        InputError: a scenario that was found could not be loaded again, or the folder cannot be written.
    """
    scenarios = {"augmented.yaml": dump(diagnosis.augmented, line_each=True)}
    if diagnosis.experiment is not None and diagnosis.experiment.scenario is not None:
        scenarios["experiment.yaml"] = dump(diagnosis.experiment.scenario, line_each=True)
    with temporary_folder() as drafts:
        for name, text in scenarios.items():
            single(write_text(Path(drafts) / name, text))
    report = report_diagnosis(diagnosis)
    return write_outputs(folder, {**scenarios, "report.html": report, "diagnosis.json": diagnosis})


def _make_gap_table(found: Gap) -> Table:
    """Return the gap of each channel and overall: with the noise floor, or beside what was to be expected of it."""
    if isinstance(found, Forecast):
        return _make_forecast_table(found)
    title = "gap, in standard deviations of what was measured"
    return _tabulate_gaps(title, {"gap": found}, found.floor)


def _make_forecast_table(found: Forecast) -> Table:
    """Return the gap to be expected before and after, beside the measured one where outputs are recorded."""
    predicted, measured = found.predicted, found.measured
    low, high = predicted.shrink_interval
    title = f"expected shrink {predicted.shrink:.2f}, 90 % interval {low:.2f} to {high:.2f}"
    gaps = {name: list(expected) for name, expected in predicted.channels.items()}
    gaps["overall"] = [predicted.before, predicted.after]
    if measured is not None:
        title += f"; measured {measured.shrink:.2f}"
        for name, row in gaps.items():
            row += [part.get(name, math.nan) for part in (measured.channels, found.channels)]
        gaps["overall"][2:] = [measured.before, found.overall]
    headings = ("channel", "expected before", "expected after", "measured before", "measured after")
    rows = [(name, *(f"{value:.4f}" for value in row)) for name, row in gaps.items()]
    return make_table(title, headings[: len(rows[0])], [*rows[:-1], (), rows[-1]])


def _tabulate_gaps(title: str, gaps: Mapping[str, Gap | GapFigures], floor: GapFigures) -> Table:
    """Return gaps by channel, each in a column under its heading, beside the noise floor; one of 0 is not stated."""
    *columns, noise = ({**each.channels, "overall": each.overall} for each in (*gaps.values(), floor))
    rows = [
        (name, *(f"{column[name]:.4f}" for column in columns), f"{noise[name]:.4f}" if noise[name] else "not stated")
        for name in columns[0]
    ]
    return make_table(title, ("channel", *gaps, "noise floor"), [*rows[:-1], (), rows[-1]])


def make_tables(diagnosis: Diagnosis) -> list[Table]:
    """Return the gaps, the likeliest causes and, where they were tried, other forms of the damper as tables."""
    gap, forms = diagnosis.gap, [_make_forms_table(diagnosis)] if diagnosis.alternatives else []
    gaps = {"nominal": gap.before, "refitted": gap.calibrated, "with effects": gap.after}
    title = f"gap on {', '.join(diagnosis.held_out)}, in standard deviations"
    return [_tabulate_gaps(title, gaps, gap.floor), _make_cause_table(diagnosis), *forms]


def _make_cause_table(diagnosis: Diagnosis) -> Table:
    listed = diagnosis.causes[:_LISTED]
    rows = [(_label(c.effect), f"{c.probability:.2f}", f"{c.shrink:.2f}", ", ".join(c.ends)) for c in listed]
    for name, probability in (("none", diagnosis.probability_none), ("unknown", diagnosis.probability_unknown)):
        rows.append((name, f"{probability:.2f}", "", ""))
    shown = 4 if any(cause.ends for cause in listed) else 3
    headings = ("effect", "probability", "own shrink", "at end of range")[:shown]
    return make_table(f"verdict: {diagnosis.verdict}", headings, [row[:shown] for row in rows], left=(0, 3))


def _label(effect: str) -> str:
    """Return the name of an effect, marked where it is the user's own."""
    return f"{effect} (own)" if effect in EFFECTS.names() and is_own(EFFECTS.find(effect)) else effect


def _make_forms_table(diagnosis: Diagnosis) -> Table:
    replaced, listed = diagnosis.alternatives[0].replaces, diagnosis.alternatives[:_LISTED]
    rows = [(form.model, ", ".join(form.beside), f"{form.shrink:.2f}", f"{form.refitted:.2f}") for form in listed]
    headings = ("form", "beside", "shrink", f"{replaced} as free")
    return make_table(f"other forms of the damper than {replaced}", headings, rows, left=(0, 1))


_FAILURES_LISTED = 12
"""Failures in the table."""


def make_score_tables(score: Score) -> list[Table]:
    """Return the summary of a score and its failures as tables; score.json has more."""
    failures = [_describe(failure) for failure in score.failures[:_FAILURES_LISTED]]
    if (more := len(score.failures) - _FAILURES_LISTED) > 0:
        failures.append((f"and {more} more", *[""] * 6))
    headings = ("case", "truth", "limit x", "missing", "verdict", "named", "where")
    columns = ("what", "share", "count", "95 % interval")
    summary = make_table(f"blind score, {score.cases} cases", columns, _summarise(score))
    return [summary, make_table("failures", headings, failures)]


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
    rows += [(), *((name, figure, "", "") for name, figure in figures.items())]
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
