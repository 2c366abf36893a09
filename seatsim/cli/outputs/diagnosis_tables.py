"""Gaps and diagnoses as tables on the terminal."""

from __future__ import annotations

import math

from rich.table import Table

from seatsim.cli.show_table import make_table
from seatsim.diagnosis.result import Diagnosis
from seatsim.effects.base import EFFECTS
from seatsim.recordings.gap import Forecast, Gap
from seatsim.schema.registry import is_own

_LISTED = 6
"""Causes in the table."""


def make_gap_table(found: Gap) -> Table:
    """Return the gap of each channel and overall: with the noise floor, or beside what was to be expected of it."""
    return _make_forecast_table(found) if isinstance(found, Forecast) else _make_measured_table(found)


def _make_measured_table(found: Gap) -> Table:
    rows = [(name, f"{gap:.4f}", _say_floor(found.floor.channels[name])) for name, gap in found.channels.items()]
    overall = ("overall", f"{found.overall:.4f}", _say_floor(found.floor.overall))
    title = "gap, in standard deviations of what was measured"
    return make_table(title, ("channel", "gap", "noise floor"), [*rows, (), overall])


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


def _say_floor(floor: float) -> str:
    """Return a noise floor as a table shows it; one of 0 is that of a sensor whose noise nobody stated."""
    return f"{floor:.4f}" if floor else "not stated"


def make_tables(diagnosis: Diagnosis) -> list[Table]:
    """Return the gaps, the likeliest causes and, where they were tried, other forms of the damper as tables."""
    forms = [_make_forms_table(diagnosis)] if diagnosis.alternatives else []
    return [_make_gap_table(diagnosis), _make_cause_table(diagnosis), *forms]


def _make_gap_table(diagnosis: Diagnosis) -> Table:
    gap = diagnosis.gap
    columns = (gap.before, gap.calibrated, gap.after)
    rows = [
        (name, *(f"{column.channels[name]:.4f}" for column in columns), _say_floor(gap.floor.channels[name]))
        for name in gap.before.channels
    ]
    overall = ("overall", *(f"{column.overall:.4f}" for column in columns), _say_floor(gap.floor.overall))
    title = f"gap on {', '.join(diagnosis.held_out)}, in standard deviations"
    return make_table(title, ("channel", "nominal", "refitted", "with effects", "noise floor"), [*rows, (), overall])


def _make_cause_table(diagnosis: Diagnosis) -> Table:
    listed = diagnosis.causes[:_LISTED]
    rows = [
        (_label(cause.effect), f"{cause.probability:.2f}", f"{cause.shrink:.2f}", ", ".join(cause.ends))
        for cause in listed
    ]
    rows += [("none", f"{diagnosis.probability_none:.2f}", "", "")]
    rows += [("unknown", f"{diagnosis.probability_unknown:.2f}", "", "")]
    shown = 4 if any(cause.ends for cause in listed) else 3
    headings = ("effect", "probability", "own shrink", "at end of range")[:shown]
    return make_table(f"verdict: {diagnosis.verdict}", headings, [row[:shown] for row in rows], left=(0, 3))


def _label(effect: str) -> str:
    """Return the name of an effect, marked where it is the user's own."""
    return f"{effect} (own)" if effect in EFFECTS.names() and is_own(EFFECTS.find(effect)) else effect


def _make_forms_table(diagnosis: Diagnosis) -> Table:
    replaced = diagnosis.alternatives[0].replaces
    rows = [
        (form.model, ", ".join(form.beside), f"{form.shrink:.2f}", f"{form.refitted:.2f}")
        for form in diagnosis.alternatives[:_LISTED]
    ]
    headings = ("form", "beside", "shrink", f"{replaced} as free")
    return make_table(f"other forms of the damper than {replaced}", headings, rows, left=(0, 1))
