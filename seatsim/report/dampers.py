"""The reports of an identified damper, and of a characterised one: what its model, and what the bench itself shows."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from seatsim.characterisation.rows import Row
from seatsim.characterisation.sheet import BenchSheet, list_tables
from seatsim.characterisation.summary import Characterisation, group_by_setting
from seatsim.identification.assessment import Assessment
from seatsim.identification.identify import Identification
from seatsim.metrics.motion import ratio
from seatsim.plots.bench.identification import PARTS, name_records, select_records
from seatsim.report.blocks import Block, Code, Figures, Report, Table, Text, show_pictures, tabulate
from seatsim.report.composing import compose
from seatsim.report.formatting import choose_advice, format_quantity, read_words, show_table
from seatsim.report.packing import MEASURED, Panel, pack_signals
from seatsim.scenario.describe import name_model
from seatsim.schema.content import list_written
from seatsim.schema.fields import head_columns
from seatsim.schema.printing import format_number, format_unit

ROWS = 3000
"""Most rows of a record that are drawn over time, from the stretch with the highest speed."""
GOOD, _FAIR = 90.0, 75.0
"""Fits in per cent from which on a model is called good, or usable."""


def report_identification(found: Identification, figures: Figures, command: str) -> Report:
    """Return the report of an identified damper; `command` makes it again."""
    sections: dict[str, Sequence[Block]] = {
        "figures": [*show_pictures(figures, "loops"), *tabulate_fit(found)],
        "signals": [_show_time(select_records(found.assessments))],
        "parameters": tabulate_parameters(found),
    }
    loose, mean = [each.name for each in found.information.estimates if not each.identified], found.assessed
    advice = choose_advice(
        hold_out=found.test is None,
        other_models=mean is not None and mean.fit_percent < _FAIR,
        undetermined=loose,
        copy=True,
    )
    about = f"Identification: {name_model(found.model)}"
    return compose("identification", about, [_say_fit(found)], advice, sections, found.notes, command)


def _say_fit(found: Identification) -> str:
    """Return in a sentence how well a model predicts the force, on held-out records where there are some."""
    mean = found.assessed
    if mean is None:
        return f"{found.model} was fitted, but no record assesses it."
    word = "well" if mean.fit_percent >= GOOD else "usably" if mean.fit_percent >= _FAIR else "poorly"
    held_out, fitted = "that took no part in the fit", "it was fitted to; none was held out"
    where = f"on records {held_out}" if found.test else f"on the records {fitted}"
    return (
        f"{found.model} predicts the damper's force {word}: a fit of {format_number(mean.fit_percent)} %, an error of"
        f" {format_quantity(mean.rmse, 'N')} RMS, {where}."
    )


def tabulate_fit(found: Identification) -> list[Table]:
    """Return the table of the agreement on each record, and of its means."""
    named = zip(name_records(found.assessments), found.assessments, strict=True)
    judged = [(name, PARTS[each.part], each.record.mean_current, each.agreement) for name, each in named]
    parts = zip(PARTS.values(), (found.train, found.test), strict=True)
    means = [(f"mean, {words}", words, "", mean) for words, mean in parts if mean]
    every = [*judged, *means]
    rows = [(*name, each.fit_percent, format_number(each.r2, 5), each.rmse, each.md) for *name, each in every]
    return show_table("fit", rows, 2, range(len(judged), len(rows)))


def _show_time(chosen: Sequence[Assessment]) -> Block:
    times, force, current = {}, {}, {}
    for k, (each, called) in enumerate(zip(chosen, name_records(chosen), strict=True), 1):
        name, part = f"{k}: {called}", slice(*each.record.liveliest(ROWS))
        times[name] = each.record.time[part]
        force[name] = [each.record.force[part], each.predicted[part]]
        current[name] = [each.record.current[part], None]
    panels = [Panel("damper force", "N", force), Panel("current", "A", current)]
    lines = [("measured", MEASURED), ("predicted", 1)]
    return pack_signals("The part of each record with the highest speed.", lines, times, panels)


def tabulate_parameters(found: Identification) -> list[Table]:
    """Return the table of the parameters."""
    estimates, rows = found.information.estimates, []
    for each in estimates:
        figures = (format_number(each.value, 5), format_number(1.96 * each.std, 2))
        rows.append((each.name + " (not determined)" * (not each.identified), format_unit(each.unit), *figures))
    return show_table("parameters", rows, 2, [k for k, each in enumerate(estimates) if not each.identified])


MOST_ROWS = 60
ROUNDING = 1e-9
"""Share of the peak force below which an offset is no finding."""


def report_characterisation(found: Characterisation, figures: Figures, command: str) -> Report:
    """Return the report of a characterisation; `command` makes it again."""
    tested: list[Block] = [Text("What was tested:"), Code(found.source, "What was tested")]
    sections: dict[str, Sequence[Block]] = {
        "loops": show_pictures(figures, "loops", "energy"),
        "figures": tabulate_rows(found),
        "limits": _tabulate_sheet(found.sheet, {"limits": "Worst figure against each limit"}),
        "steps": [*show_pictures(figures, "steps"), *tabulate_responses(found.sheet)],
        "sheet": _tabulate_sheet(found.sheet, read_words().captions),
    }
    advice = choose_advice(
        identify=True,
        record_steps=not found.sheet.response,
        record_currents=len({round(row.current, 2) for row in found.rows}) < 3,
    )
    kind, about = "characterisation", f"Characterisation: {found.name}"
    return compose(kind, about, [_say_character(found)], advice, sections, found.remarks, command, tested)


def _say_character(found: Characterisation) -> str:
    """Return in a sentence what the damper does: how its force grows with current, and how fast it follows."""
    group = max(group_by_setting(found.rows), key=lambda rows: len({row.current for row in rows}), default=[])
    said = f"{len(found.rows)} records were characterised"
    if group:
        low, high = min(group, key=lambda row: row.current), max(group, key=lambda row: row.current)
        force = f"up to {format_quantity(high.peak_rebound, 'N')} at {high.current:.3g} A"
        said = f"Moved by {_name_motion(high)}, the damper gives {force}"
        if high.current > low.current and low.peak_rebound > 0:
            growth = format_number(high.peak_rebound / low.peak_rebound, 2)
            said += f", {growth} times its force at {low.current:.3g} A"
    if times := [row.t90 for row in found.sheet.response if math.isfinite(row.t90)]:
        said += f"; it follows a step of the current to 90 % within {format_number(1e3 * float(np.median(times)))} ms"
    return f"{said}."


def _name_motion(row: Row) -> str:
    """Return amplitude and frequency of a row in words; a record without cycles has no frequency."""
    steady = f" at {row.frequency:.3g} Hz" if row.cycles else ", no steady cycles"
    return f"±{1e3 * row.amplitude:.3g} mm{steady}"


_COLUMNS: Mapping[str, Callable[[Row], float]] = {
    "current [A]": lambda row: row.current,
    "temperature [°C]": lambda row: row.temperature,
    "speed [m/s]": lambda row: row.peak_speed,
    "cycles": lambda row: row.cycles or math.nan,
    "rebound [N]": lambda row: row.peak_rebound,
    "compression [N]": lambda row: row.peak_compression,
    "energy [J]": lambda row: row.energy,
    "± of energy [%]": lambda row: 100.0 * ratio(row.energy_sd, row.energy),
    "damping [N·s/m]": lambda row: row.damping,
    # What is rounding, beside the forces, is no offset.
    "offset [N]": lambda row: row.offset if abs(row.offset) >= ROUNDING * abs(row.peak_rebound) else 0.0,
    "asymmetry [%]": lambda row: 100.0 * round(row.asymmetry, 9),
}
"""Figures of the rows by the heading of their column, which a table without any of them leaves out."""


def tabulate_rows(found: Characterisation) -> list[Table]:
    """Return the table of the records."""
    left, rows = len(found.rows) - MOST_ROWS, found.rows[:MOST_ROWS]
    more = f"; {left} more in characterisation.json" if left > 0 else ""
    shown = {head: read for head, read in _COLUMNS.items() if any(math.isfinite(read(row)) for row in rows)}
    lines = [(row.record, _name_motion(row), *(read(row) for read in shown.values())) for row in rows]
    caption = f"Largest forces of rebound and compression, energy and damping of the mean cycle{more}"
    return tabulate(caption, ["record", "motion", *shown], lines, 2)


def tabulate_responses(sheet: BenchSheet) -> list[Table]:
    """Return the table of the responses to steps of the current."""
    caption = "Response from the current's own 10 % on; recovery from below 90 %; shares of the change"
    return _tabulate_sheet(sheet, {"response": caption})


def _tabulate_sheet(sheet: BenchSheet, captions: Mapping[str, str]) -> list[Table]:
    """Return the tables with these names that have rows."""
    tables, blocks = list_tables(sheet), list[Table]()
    for name, caption in captions.items():
        record, rows = tables[name]
        head = [text.replace("_", " ") for text in head_columns(record, format_unit)]
        values = [[getattr(row, each.name) for each in list_written(record)] for row in rows[:MOST_ROWS]]
        lines = [[("FAIL", "pass")[value] if isinstance(value, bool) else value for value in row] for row in values]
        more = f"; {len(rows) - MOST_ROWS} more in characterisation.xlsx" if len(rows) > MOST_ROWS else ""
        blocks += tabulate(f"{caption}{more}", head, lines)
    return blocks
