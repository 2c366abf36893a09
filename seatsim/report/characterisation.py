"""The report of a characterisation: what a bench shows of a damper before anything is modelled."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from seatsim.characterisation.response import Response
from seatsim.characterisation.rows import Row
from seatsim.characterisation.sheet import BenchSheet, list_tables
from seatsim.characterisation.summary import Characterisation, group_by_setting
from seatsim.dampers.base import DAMPERS
from seatsim.plots.labels import format_number, format_percent, format_unit
from seatsim.report.blocks import Block, Code, Report, Section, Text, show_pictures, tabulate
from seatsim.report.composing import Closing, compose
from seatsim.report.credibility import Factor, count_variations, state_intervals, trace_inputs
from seatsim.report.formatting import format_quantity
from seatsim.schema.columns import head_columns
from seatsim.schema.content import list_written

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_ROWS = 60
ROUNDING = 1e-9
"""Share of the peak force below which an offset is no finding."""
_CAPTIONS = {
    "peak_forces": "Force at the peak speed, mean of the repeats with the larger standard deviation of them",
    "beside": "The same of the model beside",
    "gas_force": "Gas force: mean of both directions at mid-stroke of the slowest test, and its slope over the stroke",
    "friction": "Friction: half the difference of both directions at mid-stroke of the slowest test",
    "dynamic_range": "Dynamic range: force at the largest current over that at the smallest",
    "linearity": "Linearity in current: 0 is the softest force, 1 the hardest",
    "hysteresis": "Hysteresis: difference of the forces at which a cycle passes a speed of 0, and half its peak speed",
    "energy": "Energy of a cycle and equivalent damping",
    "current_hysteresis": "Hysteresis in the current: force at one current where it rises, and where it falls",
    "fade": "Fade: relative change of the force with temperature, and with the energy that a record absorbs",
    "response": "Response from the current's own 10 % on; recovery after a dip below 90 %; shares of the change",
}
"""Captions of the tables, in their order."""


def report_characterisation(
    found: Characterisation, figures: Mapping[str, Figure], remarks: Sequence[str], command: str
) -> Report:
    """Return the report of a characterisation; `remarks` are sentences on it, `command` makes it again."""
    tested: list[Block] = [Text("What was tested:"), Code(found.source, "What was tested")]
    steps = [*show_pictures(figures, "steps"), *_tabulate_steps(found.responses)]
    sections = [
        Section(
            "loops", "Force, energy and damping", show_pictures(figures, "loops", "energy", "asymmetry", "warm_up")
        ),
        Section("figures", "Figures of each record", _tabulate_rows(found)),
        Section("limits", "Limits", _tabulate_sheet(found.sheet, ["limits"])),
        Section("steps", "Response to steps of the current", steps),
        Section("sheet", "Tables of the bench sheet", _tabulate_sheet(found.sheet, [*_CAPTIONS])),
    ]
    about, closing = f"Characterisation: {found.name}", Closing(remarks, _judge(found), command, tested)
    return compose("characterisation", about, [_say_character(found)], _advise(found), sections, closing)


def _judge(found: Characterisation) -> list[Factor]:
    """Return how far the figures of a bench's records, or of a model's tests, may be trusted."""
    models = [] if found.measured or found.name not in DAMPERS.names() else [DAMPERS.find(found.name)]
    doubts = dict.fromkeys([*found.notes, *(note for row in found.rows for note in row.notes)])
    return [
        trace_inputs(list(doubts), models, is_measured=found.measured),
        state_intervals(["the response times"] * any(math.isfinite(each.t95_sd) for each in found.responses)),
        count_variations(len(found.rows)),
    ]


def _say_character(found: Characterisation) -> str:
    """Return in a sentence what the damper does: how its force grows with current, and how fast it follows."""
    group = max(group_by_setting(found.rows), key=lambda rows: len({row.current for row in rows}), default=[])
    said = f"{len(found.rows)} records were characterised"
    if group:
        low, high = min(group, key=lambda row: row.current), max(group, key=lambda row: row.current)
        force = f"up to {format_quantity(high.peak_rebound, 'N')} at {high.current:.3g} A"
        said = f"Moved by {_name_motion(high)}, the damper gives {force}"
        if high.current > low.current and low.peak_rebound > 0:
            ratio = format_number(high.peak_rebound / low.peak_rebound, 2)
            said += f", {ratio} times its force at {low.current:.3g} A"
    times = [answer.t95 for answer in found.responses if math.isfinite(answer.t95)]
    if times:
        said += f"; it follows a step of the current within {format_number(1e3 * float(np.median(times)))} ms"
    return f"{said}."


def _advise(found: Characterisation) -> list[str]:
    if not found.measured:
        return ["Compare it with a measured damper: seatsim characterise takes a folder of bench tables, too."]
    texts = ["Fit a model to these records: seatsim identify takes the same folder."]
    if not any(math.isfinite(answer.t95) for answer in found.responses):
        texts.append("Record steps of the current at constant speed: nothing here shows how fast the force follows.")
    if len({round(row.current, 2) for row in found.rows}) < 3:
        texts.append("Record at three currents or more: the force's growth with current is a curve.")
    return texts


def _name_motion(row: Row) -> str:
    """Return amplitude and frequency of a row in words."""
    return f"±{1e3 * row.amplitude:.3g} mm at {row.frequency:.3g} Hz"


def _tabulate_rows(found: Characterisation) -> list[Block]:
    left, named = len(found.rows) - MOST_ROWS, int(found.measured)
    more = f"; {left} more in cycles.csv" if left > 0 else ""

    def list_cells(row: Row) -> list[str | float]:
        motion = _name_motion(row) if math.isfinite(row.amplitude) else "no steady cycles"
        forces = (row.peak_rebound, row.peak_compression, row.energy, row.damping, _clean(row))
        where = (motion, row.current, row.temperature, row.peak_speed)
        return [*[row.record] * named, *where, *forces, format_percent(row.asymmetry)]

    caption = f"Largest forces of rebound and compression, energy and damping of the mean cycle{more}"
    head = (
        "record, " * named + "motion, current [A], temperature [°C], speed [m/s], rebound [N], compression [N],"
        " energy [J], damping [N·s/m], offset [N], asymmetry"
    )
    return tabulate(caption, head, map(list_cells, found.rows[:MOST_ROWS]), named + 1)


def _clean(row: Row) -> float:
    """Return the offset of a loop, 0 where it is rounding."""
    return 0.0 if abs(row.offset) < ROUNDING * abs(row.peak_rebound) else row.offset


def _tabulate_sheet(sheet: BenchSheet, names: Sequence[str]) -> list[Block]:
    """Return the tables with these names that have rows."""
    tables, blocks = list_tables(sheet), list[Block]()
    for name in names:
        record, rows = tables[name]
        head = [text.replace("_", " ") for text in head_columns(record, format_unit)]
        lines = [[_say(getattr(row, each.name)) for each in list_written(record)] for row in rows[:MOST_ROWS]]
        more = f"; {len(rows) - MOST_ROWS} more in characterisation.xlsx" if len(rows) > MOST_ROWS else ""
        blocks += tabulate(f"{_CAPTIONS.get(name, 'Worst figure against each limit')}{more}", head, lines)
    return blocks


def _say(value: object) -> str:
    if isinstance(value, bool):
        return "pass" if value else "FAIL"
    return format_number(value) if isinstance(value, float) else str(value)


def _tabulate_steps(answers: Sequence[Response]) -> list[Block]:
    rows = []
    for each in answers:
        times = (1e3 * time for time in (each.t90, each.t95, each.t95_sd, each.delay))
        how = each.method or each.note or "not determined"
        rows.append((each.record or "model", each.before, each.after, each.steps, *times, each.rate_95, how))
    caption = "Time from the step of the current to 90 % and 95 % of the change of force"
    head = "record, from [A], to [A], steps, t90 [ms], t95 [ms], ± [ms], delay [ms], rate [1/s], how"
    return tabulate(caption, head, rows)
