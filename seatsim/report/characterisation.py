"""The report of a characterisation: what a bench shows of a damper before anything is modelled."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from seatsim.characterisation.response import Response
from seatsim.characterisation.rows import Row
from seatsim.characterisation.summary import Characterisation, group_by_setting
from seatsim.report.blocks import Block, Code, Items, Plane, Report, Section, Table, Text
from seatsim.report.credibility.card import show_card
from seatsim.report.credibility.evidence import collect_characterisation
from seatsim.report.formatting import format_number, format_percent, format_quantity, format_sentence
from seatsim.report.method import describe_method
from seatsim.report.packing import Axis, Panel, pack_signals
from seatsim.report.planes import Curve, draw_curves, join_planes

MOST_SETTINGS = 6
"""Settings of amplitude and frequency whose loops are drawn."""
MOST_ROWS = 60
POINTS = 240
ROUNDING = 1e-9
"""Share of the peak force below which an offset is no finding."""
METHOD = (
    "A loop is the mean of a record's steady cycles; energy is its area, damping that of a dashpot that dissipates as"
    " much, E / (π ω X²).",
    "Asymmetry: RMS of the difference from the centrosymmetric loop over that of the force.",
    "t95 is the time from a step of the current to 95 % of the change of force; its ± is one standard deviation by"
    " resampling the steps.",
)


def report_characterisation(found: Characterisation, remarks: Sequence[str], command: str) -> Report:
    """Return the report of a characterisation; `remarks` are sentences on it, `command` makes it again."""
    sections = [
        Section("figures", "Figures of each record", [_make_table(found)]),
        Section("loops", "Loops", _draw_loops(found.rows)),
        Section("steps", "Response to steps of the current", _show_steps(found.responses)),
        Section("notes", "Notes", [Items([format_sentence(text) for text in remarks])] * bool(remarks)),
        show_card(collect_characterisation(found)),
        describe_method(METHOD, command, [Text("What was tested:"), Code(found.source, "What was tested")]),
    ]
    return Report(f"Characterisation: {found.name}", say_character(found), [], _advise(found), sections)


def say_character(found: Characterisation) -> str:
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


def _make_table(found: Characterisation) -> Table:
    rows, named = found.rows, int(found.measured)
    head = [
        *["record"] * named, "motion", "current [A]", "temperature [°C]", "speed [m/s]", "rebound [N]",
        "compression [N]", "energy [J]", "damping [N·s/m]", "offset [N]", "asymmetry",
    ]  # fmt: skip
    lines = [
        [*[row.record] * named, _name_motion(row) if math.isfinite(row.amplitude) else "no steady cycles",
         *map(format_number, (row.current, row.temperature, row.peak_speed, row.peak_rebound, row.peak_compression,
                              row.energy, row.damping, _clean(row))),
         format_percent(row.asymmetry)]
        for row in rows[:MOST_ROWS]
    ]  # fmt: skip
    more = f"; {len(rows) - MOST_ROWS} more in cycles.csv" if len(rows) > MOST_ROWS else ""
    caption = f"Largest forces of rebound and compression, energy and damping of the mean cycle{more}"
    return Table(caption, head, lines, named + 1)


def _clean(row: Row) -> float:
    """Return the offset of a loop, 0 where it is rounding."""
    return 0.0 if abs(row.offset) < ROUNDING * abs(row.peak_rebound) else row.offset


def _draw_loops(rows: Sequence[Row]) -> list[Block]:
    """Return one figure of the loops over velocity and over travel, and one of records without steady cycles."""
    planes: list[Plane] = []
    groups = group_by_setting(rows)[:MOST_SETTINGS]
    names = sorted({round(row.current, 2) for group in groups for row in group})
    looks = {current: k % 8 for k, current in enumerate(names)}
    for group in groups:
        over_velocity, over_travel = [], []
        for row in group[:8]:
            if row.loop is not None:
                name, look, force = f"{row.current:.2f} A", looks[round(row.current, 2)], _thin(row.loop.force)
                over_velocity.append(Curve(name, _thin(row.loop.velocity), force, look))
                over_travel.append(Curve(name, 1e3 * _thin(row.loop.displacement), force, look))
        title = _name_motion(group[0])
        planes.append(draw_curves(title, "", ("velocity [m/s]", "force [N]"), over_velocity))
        planes.append(draw_curves(title, "", ("travel [mm]", "force [N]"), over_travel))
    blocks: list[Block] = [join_planes("Damper force", "Mean cycle at each current.", planes)] if planes else []
    clouds = [row for row in rows if row.cloud is not None][:8]
    if clouds:
        curves = [
            Curve(f"{row.current:.2f} A", row.cloud.velocity, row.cloud.force, k % 8, "dots")
            for k, row in enumerate(clouds) if row.cloud is not None
        ]  # fmt: skip
        axes = ("velocity [m/s]", "force [N]")
        caption = "Samples, by the mean current of the record."
        blocks.append(draw_curves("Records without steady cycles", caption, axes, curves))
    return blocks


def _thin(values: np.ndarray) -> np.ndarray:
    return np.asarray(values)[:: max(1, len(values) // POINTS)]


def _show_steps(answers: Sequence[Response]) -> list[Block]:
    if not answers:
        return []
    rows = [
        [each.record or "model", format_number(each.before), format_number(each.after), str(each.steps),
         *(format_number(1e3 * value) for value in (each.t90, each.t95, each.t95_sd, each.delay)),
         format_number(each.rate_95), each.method or each.note or "not determined"]
        for each in answers
    ]  # fmt: skip
    head = [
        "record", "from [A]", "to [A]", "steps", "t90 [ms]", "t95 [ms]", "± [ms]", "delay [ms]", "rate [1/s]", "how",
    ]  # fmt: skip
    caption = "Time from the step of the current to 90 % and 95 % of the change of force"
    blocks: list[Block] = [Table(caption, head, rows)]
    known = [each for each in answers if each.time is not None and each.share is not None][:8]
    if known:
        time = max((np.asarray(each.time) for each in known), key=len)
        lines = [(f"{each.before:.2f} to {each.after:.2f} A", k % 8) for k, each in enumerate(known)]
        values = [np.interp(time, np.asarray(each.time), np.asarray(each.share)) for each in known]
        panel = Panel("share of the change of force", "-", "", {"": list(values)})
        axis = Axis("time from the step", "ms", {"": 1e3 * time})
        caption = "Force after a step of the current, mean over the steps."
        blocks.append(pack_signals("signals-steps", caption, lines, axis, [panel]))
    return blocks
