"""Characterisations, identifications and leagues of dampers as tables on the terminal."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

from rich.markup import escape
from rich.table import Table

from seatsim.characterisation.response import Response
from seatsim.characterisation.rows import Row
from seatsim.characterisation.summary import Characterisation
from seatsim.cli.show_table import format_number, make_table
from seatsim.dampers.base import OWN
from seatsim.identification.assessment import Agreement
from seatsim.identification.identify import Identification
from seatsim.identification.model_benchmark import BenchmarkEntry
from seatsim.identification.specimens import Specimens
from seatsim.plots.labels import shorten

_ROWS_LISTED = 45
"""Most rows of the table of cycles."""
_RECORDS_LISTED = 40
"""Most records of the table of agreements."""
_CROWDED = 14
"""Columns from which on they stand closer."""
_WIDEST = 16
"""Letters of a record's name."""


class _RowColumn(NamedTuple):
    """A column of the table: heading, value of a row, format."""

    heading: str
    value: Callable[[Row], float]
    form: str


_COLUMNS = (
    _RowColumn("[A]", lambda row: row.current, ".2f"),
    _RowColumn("[°C]", lambda row: row.temperature, ".0f"),
    _RowColumn("[mm]", lambda row: 1e3 * row.amplitude, ".1f"),
    _RowColumn("[Hz]", lambda row: row.frequency, ".3g"),
    _RowColumn("[m/s]", lambda row: row.peak_speed, ".3f"),
    _RowColumn("n", lambda row: row.cycles or math.nan, ".0f"),
    _RowColumn("re-\nbound\n[N]", lambda row: row.peak_rebound, ".0f"),
    _RowColumn("com-\npress.\n[N]", lambda row: row.peak_compression, ".0f"),
    _RowColumn("energy\n[J]", lambda row: row.energy, ".2f"),
    _RowColumn("±\n[%]", lambda row: 100.0 * row.energy_sd / row.energy if row.energy else math.nan, ".1f"),
    _RowColumn("damping\n[N s/m]", lambda row: row.damping, ".0f"),
    _RowColumn("RMS\n[N]", lambda row: math.nan if row.cycles else row.force_rms, ".0f"),
    _RowColumn("offset\n[N]", lambda row: row.offset, ".1f"),
    _RowColumn("asym-\nmetry\n[%]", lambda row: 100.0 * row.asymmetry, ".1f"),
    _RowColumn("of\nshape\n[%]", lambda row: 100.0 * row.asymmetry_of_shape, ".1f"),
)
_STEP = [
    "record",
    "from\n[A]",
    "to\n[A]",
    "steps",
    "t5\n[ms]",
    "t90\n[ms]",
    "t95\n[ms]",
    "±\n[ms]",
    "rate\n[1/s]",
    "behind\ndelay\n[1/s]",
    "delay\n[ms]",
    "current\nt95 [ms]",
    "how",
]


def make_characterisation_tables(found: Characterisation) -> list[Table]:
    """Return the table of the records, and that of the responses to steps where there are any."""
    tables = [_make_row_table(found)]
    return [*tables, _make_step_table(found.responses)] if found.responses else tables


def _make_row_table(found: Characterisation) -> Table:
    shown = [column for column in _COLUMNS if any(math.isfinite(column.value(row)) for row in found.rows)]
    rows = [
        [escape(_name_record(row)), *(format_number(column.value(row), column.form) for column in shown)]
        for row in found.rows[:_ROWS_LISTED]
    ]
    of = f"the cycle of each {'record' if found.measured else 'test'}"
    title = of if any(row.cycles for row in found.rows) else "records without cycles"
    more = len(found.rows) - _ROWS_LISTED
    first, headings = int(not found.measured), ["record", *(column.heading for column in shown)]
    shown_rows, left = [row[first:] for row in rows], (0,) if found.measured else ()
    caption = f"{more} more rows in cycles.csv" if more > 0 else None
    table = make_table(f"{found.name}: {title}", headings[first:], shown_rows, left, caption)
    if found.measured and len(shown) >= _CROWDED:
        table.padding = 0
    return table


def _name_record(row: Row) -> str:
    """Return a record's name, cut in the middle, without the current that has a column of its own."""
    return shorten(row.record.replace(f", {row.current:g} A", ""), _WIDEST)


def _make_step_table(answers: Sequence[Response]) -> Table:
    rows = []
    for a in answers:
        times = [format_number(1e3 * t, ".1f") for t in (a.t5, a.t90, a.t95, a.t95_sd)]
        ends = [format_number(a.rate_95, ".0f"), format_number(a.rate, ".0f")]
        ends += [format_number(1e3 * t, ".1f") for t in (a.delay, a.current_t95)]
        steps = (f"{a.before:.2f}", f"{a.after:.2f}", str(a.steps))
        rows.append([escape(shorten(a.record, _WIDEST)), *steps, *times, *ends, a.method or "not determined"])
    first = int(not any(answer.record for answer in answers))
    title = "response of the force to steps of current; rates ln 20 / t95, and behind a delay ln 19 / (t95 - t5)"
    left = [k - first for k in (0, len(_STEP) - 1)]
    return make_table(title, _STEP[first:], [row[first:] for row in rows], left=left)


def make_identification_tables(found: Identification) -> list[Table]:
    """Return the tables of figures and of parameters."""
    each = found.assessments if len(found.assessments) <= _RECORDS_LISTED else []
    figures = [(f"{escape(it.record.name)} ({it.part})", *_format_figures(it.agreement)) for it in each]
    parts = {"train": found.train, "test": found.test, "predicted": found.predicted}
    means = [(f"mean, {part}", *_format_figures(mean)) for part, mean in parts.items() if mean]
    values = []
    for one in found.information.estimates:
        numbers = (f"{one.value:.5g}", f"{1.96 * one.std:.2g}")
        values.append((escape(one.name), *numbers, escape(one.unit), "" if one.identified else "not identified"))
    title, headings = f"{found.model}: agreement with the measured force", ("", "R²", "MD", "RMSE [N]", "fit [%]")
    table, of_values = make_table(title, headings, [*figures, (), *means]), ("", "value", "±", "unit", "")
    title = f"{found.model}: parameters, ±1.96 standard deviations"
    return [table, make_table(title, of_values, values, left=(0, 3, 4))]


def make_specimen_table(found: Specimens) -> Table:
    """Return mean and standard deviation of every value in which specimens differ, and the value of each."""
    columns = (found.mean, found.standard_deviation, *found.specimens.values())
    rows = [(escape(key), *(f"{values[key]:.4g}" for values in columns)) for key in found.mean]
    return make_table(f"{found.model}: specimens", ("", "mean", "sd", *map(escape, found.specimens)), rows)


def _format_figures(figures: Agreement) -> tuple[str, ...]:
    return f"{figures.r2:.4f}", f"{figures.md:.3f}", f"{figures.rmse:.1f}", f"{figures.fit_percent:.1f}"


def make_league_table(places: Sequence[BenchmarkEntry]) -> Table:
    """Return the benchmark of models as a table."""
    rows = []
    for place in places:
        fits = [format_number(fit, ".1f") for fit in (place.train_fit_percent, place.test_fit_percent)]
        rest = [format_number(value, ".0f") for value in (place.ns_per_step, place.bic, place.seconds)]
        count = "-" if place.failed else str(place.parameters)
        rows.append((f"{place.model} ({OWN})" if place.confidence == OWN else place.model, *fits, count, *rest))
    return make_table("league", ("model", "train [%]", "test [%]", "parameters", "ns a step", "BIC", "s"), rows)
