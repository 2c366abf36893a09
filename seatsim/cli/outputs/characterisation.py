"""Characterisations on disk and on the terminal: `cycles.csv`, `characterisation.json`, pictures, tables."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

from rich import box
from rich.markup import escape
from rich.table import Table

from seatsim.characterisation.response import Response
from seatsim.characterisation.rows import Row, row_columns
from seatsim.characterisation.summary import Characterisation, contents
from seatsim.cli.outputs.runs import write_pictures
from seatsim.provenance.manifest import write_documented
from seatsim.report.characterisation import report_characterisation
from seatsim.report.rendering import write_html
from seatsim.schema.files import write_json, write_whole
from seatsim.schema.text import disarm

LISTED = 45
"""Most rows of the table on the terminal."""
CROWDED = 14
"""Columns from which on they stand closer."""
WIDEST = 16
"""Letters of a record's name."""


class RowColumn(NamedTuple):
    """A column of the table: heading, value of a row, format."""

    heading: str
    value: Callable[[Row], float]
    form: str


COLUMNS = (
    RowColumn("\\[A]", lambda row: row.current, ".2f"),
    RowColumn("\\[°C]", lambda row: row.temperature, ".0f"),
    RowColumn("\\[mm]", lambda row: 1e3 * row.amplitude, ".1f"),
    RowColumn("\\[Hz]", lambda row: row.frequency, ".3g"),
    RowColumn("\\[m/s]", lambda row: row.peak_speed, ".3f"),
    RowColumn("n", lambda row: row.cycles or math.nan, ".0f"),
    RowColumn("re-\nbound\n\\[N]", lambda row: row.peak_rebound, ".0f"),
    RowColumn("com-\npress.\n\\[N]", lambda row: row.peak_compression, ".0f"),
    RowColumn("energy\n\\[J]", lambda row: row.energy, ".2f"),
    RowColumn("±\n\\[%]", lambda row: 100.0 * row.energy_sd / row.energy if row.energy else math.nan, ".1f"),
    RowColumn("damping\n\\[N s/m]", lambda row: row.damping, ".0f"),
    RowColumn("RMS\n\\[N]", lambda row: math.nan if row.cycles else row.force_rms, ".0f"),
    RowColumn("offset\n\\[N]", lambda row: row.offset, ".1f"),
    RowColumn("asym-\nmetry\n\\[%]", lambda row: 100.0 * row.asymmetry, ".1f"),
    RowColumn("of\nshape\n\\[%]", lambda row: 100.0 * row.asymmetry_of_shape, ".1f"),
)


def write_characterisation(found: Characterisation, folder: Path) -> list[Path]:
    """Write `cycles.csv`, `characterisation.json`, `report.html` and the pictures; return their paths."""
    import pandas as pd

    from seatsim.plots.bench.characterisation import plot_characterisation

    table = pd.DataFrame([row_columns(row) for row in found.rows])
    command = f"seatsim characterise {found.source}" if found.measured else f"seatsim characterise --model {found.name}"
    report = report_characterisation(found, collect_remarks(found), command)
    return write_documented(
        folder,
        lambda part: [
            write_whole(part / "cycles.csv", partial(table.map(disarm).to_csv, index=False)),
            write_json(part / "characterisation.json", contents(found)),
            write_html(report, part / "report.html"),
            *write_pictures(plot_characterisation(found), part),
        ],
    )


def make_tables(found: Characterisation) -> list[Table]:
    """Return the table of the records, and that of the responses to steps where there are any."""
    answer = [_make_row_table(found)]
    return [*answer, _make_step_table(found.responses)] if found.responses else answer


def collect_remarks(found: Characterisation) -> list[str]:
    """Return the notes on the tables in sentences, records with the same note together."""
    affected: dict[str, list[str]] = {}
    for row in found.rows:
        for note in row.notes:
            affected.setdefault(note, []).append(row.record)
    for answer in found.responses:
        if answer.note:
            who = f"step {answer.before:.2f} to {answer.after:.2f} A"
            affected.setdefault(answer.note, []).append(f"{answer.record}, {who}" if answer.record else who)
    lines = [f"{_list_names(names)}: {note}" for note, names in affected.items()]
    return [*found.notes, *lines]


def _list_names(names: Sequence[str]) -> str:
    return ", ".join(names) if len(names) <= 3 else f"{names[0]} and {len(names) - 1} more"


def _make_row_table(found: Characterisation) -> Table:
    shown = [column for column in COLUMNS if any(math.isfinite(column.value(row)) for row in found.rows)]
    caption = f"{len(found.rows) - LISTED} more rows in cycles.csv" if len(found.rows) > LISTED else None
    cyclic = any(row.cycles for row in found.rows)
    title = f"the cycle of each {'record' if found.measured else 'test'}" if cyclic else "records without cycles"
    table = _make_table(f"{found.name}: {title}", caption)
    if found.measured:
        table.add_column("record", vertical="bottom", no_wrap=True)
    for column in shown:
        table.add_column(column.heading, justify="right", vertical="bottom", no_wrap=True)
    if found.measured and len(shown) >= CROWDED:
        table.padding = 0
    for row in found.rows[:LISTED]:
        cells = [_format_number(column.value(row), column.form) for column in shown]
        table.add_row(*([escape(_name_record(row))] if found.measured else []), *cells)
    return table


def _name_record(row: Row) -> str:
    """Return a record's name, cut in the middle, without the current that has a column of its own."""
    name = row.record.replace(f", {row.current:g} A", "")
    return _shorten(name)


def _shorten(name: str) -> str:
    """Return a name of at most `WIDEST` letters, cut in the middle, since names of a series differ at their ends."""
    half = WIDEST // 2
    return name if len(name) <= WIDEST else f"{name[: half - 1]}…{name[-half:]}"


def _make_step_table(answers: Sequence[Response]) -> Table:
    title = "response of the force to steps of current; rates ln 20 / t95, and behind a delay ln 19 / (t95 - t5)"
    table = _make_table(title)
    recorded = any(answer.record for answer in answers)
    if recorded:
        table.add_column("record", vertical="bottom", no_wrap=True)
    headings = (
        "from\n\\[A]", "to\n\\[A]", "steps", "t5\n\\[ms]", "t90\n\\[ms]", "t95\n\\[ms]", "±\n\\[ms]", "rate\n\\[1/s]",
        "behind\ndelay\n\\[1/s]", "delay\n\\[ms]", "current\nt95 \\[ms]",
    )  # fmt: skip
    for heading in headings:
        table.add_column(heading, justify="right", vertical="bottom", no_wrap=True)
    table.add_column("how", vertical="bottom", overflow="fold")
    for a in answers:
        times = [_format_number(1e3 * t, ".1f") for t in (a.t5, a.t90, a.t95, a.t95_sd)]
        ends = [_format_number(a.rate_95, ".0f"), _format_number(a.rate, ".0f")]
        ends += [_format_number(1e3 * t, ".1f") for t in (a.delay, a.current_t95)]
        who = [escape(_shorten(a.record))] if recorded else []
        how = a.method or "not determined"
        table.add_row(*who, f"{a.before:.2f}", f"{a.after:.2f}", str(a.steps), *times, *ends, how)
    return table


def _make_table(title: str, caption: str | None = None) -> Table:
    return Table(
        title=escape(title), caption=caption, padding=(0, 1, 0, 0), title_justify="left", caption_justify="left",
        box=box.SIMPLE_HEAD,
    )  # fmt: skip


def _format_number(value: float, form: str) -> str:
    text = f"{value:{form}}" if math.isfinite(value) else "-"
    # A value that rounds to zero loses its sign: -0.0 looks like a finding.
    return text.replace("-", "", 1) if text.strip("-0.") == "" and text != "-" else text
