"""The reports of vibration judged by standards: of a measured one by ISO 2631, of a seat's test by ISO 7096."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from seatsim.excitations.iso7096 import CLASSES
from seatsim.metrics.exposure import DAY
from seatsim.plots.bench.vibration import plot_damping
from seatsim.report.blocks import Block, Figures, Report, Table, show_pictures
from seatsim.report.composing import compose
from seatsim.report.formatting import choose_advice, format_sentence, show_table
from seatsim.schema.printing import format_percent
from seatsim.schema.text import join_names
from seatsim.standards.comfort import Comfort
from seatsim.standards.seat_rows import ACCEPTANCE, DAMPING, RECALLED, DampingRow, SeatRow, SeatTest


def report_comfort(found: Comfort, figures: Figures, command: str) -> Report:
    """Return the report of a measured vibration.

    Args:
        found: its assessment.
        figures: pictures by name (`seatsim.plots.bench.vibration`).
        command: what makes the report again.
    """
    answer = [_say_comfort(found), *map(format_sentence, list_comfort_sentences(found))]
    sections: dict[str, Sequence[Block]] = {
        "axes": [*tabulate_axes(found), *show_pictures(figures, "running_rms", "spectra")],
        "seat": tabulate_seat(found),
    }
    about, advice = f"Vibration of {found.name}", _advise_on_comfort(found)
    return compose("comfort", about, answer, advice, sections, found.notes, command)


def list_comfort_sentences(found: Comfort) -> Iterator[str]:
    """Yield what is said of all axes: sums, the day's exposure, the zones, and what the basic method lacks."""
    totals = ", ".join(f"{point} {value:.3f}" for point, value in found.totals.items())
    yield f"vibration total value a_v [m/s²]: {totals}"
    for axis, reasons in ((axis, join_names(each.shocks)) for axis, each in found.axes.items() if each.shocks):
        yield f"{axis}: report MTVV or VDV beside a_w, as {reasons} (ISO 2631-1, 6.2.2 and 6.3.3)"
    if (sickness := found.motion_sickness) is not None:
        yield f"motion sickness (Wf): a_w {sickness.rms:.3f} m/s², MSDV {sickness.msdv:.2f} m/s¹·⁵"
    if (load := found.spine) is not None:
        named = ((name, risk.factor, format_percent(risk.probability)) for name, risk in load.risks.items())
        risks = ", ".join(f"{name} R {factor:.2f}, risk {probability}" for name, factor, probability in named)
        doses = f"dose D_z {load.dose:.2f} m/s², of a day {load.daily_dose:.2f} m/s²"
        yield f"lumbar spine (ISO 2631-5:2018): {doses}; after work from 20 to 64 years of age: {risks}"
    if (day := found.exposure) is not None:
        vdv8 = f"VDV(8) {day.vdv8:.2f} m/s¹·⁷⁵ ({day.vdv8_axis})"
        yield f"{day.hours:g} h a day: A(8) {day.a8:.3f} m/s² ({day.a8_axis}), {vdv8}"
        for name, value in (("action value", day.action_value), ("limit value", day.limit_value)):
            by_a8 = _say_reach(f"A(8) {value.a8:g} m/s²", value.exceeded_by_a8, value.hours_to_a8)
            by_vdv = _say_reach(f"VDV {value.vdv:g} m/s¹·⁷⁵", value.exceeded_by_vdv, value.hours_to_vdv)
            yield f"{name} of 2002/44/EC: {by_a8}; {by_vdv}"
        zones = f"{day.zone_a8} it by A(8), {day.zone_vdv} it by the estimated VDV"
        yield f"health guidance caution zone of ISO 2631-1, annex B: {zones}"


def _say_reach(value: str, exceeded: bool, hours: float) -> str:
    if not math.isfinite(hours) or hours > DAY:
        return f"{value} not reached in a day"
    return f"{value} {'exceeded' if exceeded else 'not exceeded'}, reached after {hours:.2g} h"


def _say_comfort(found: Comfort) -> str:
    """Return in a sentence how a day compares with directive 2002/44/EC, or how strong the vibration is."""
    day = found.exposure
    if day is None:
        return f"The vibration total value is {found.totals['overall']:.2f} m/s²."
    action = f"the action value of {day.action_value.a8:g} m/s²"
    limit = f"the limit value of {day.limit_value.a8:g} m/s²"
    judged = f"above {action} and below {limit}" if day.action_value.exceeded_by_a8 else f"below {action}"
    judged = f"above {limit}" if day.limit_value.exceeded_by_a8 else judged
    return f"{day.hours:g} h a day of this vibration give A(8) = {day.a8:.2f} m/s² along {day.a8_axis}, {judged}."


def _advise_on_comfort(found: Comfort) -> list[str]:
    day = found.exposure
    shorter = f"{day.action_value.hours_to_a8:.2g}" if day and day.action_value.exceeded_by_a8 else ""
    return choose_advice(shorten=shorter, other_seats=bool(found.seat), measure_floor=not found.seat)


def tabulate_axes(found: Comfort) -> list[Table]:
    """Return the table of the axes, with the weighting, the factors and the figures of each."""
    rows = []
    for axis, each in found.axes.items():
        k, dose = each.direction, each.dose
        figures = (dose.rms, dose.vdv, dose.estimated_vdv, dose.mtvv, dose.crest_factor)
        rows.append((axis, each.column, k.weighting, each.method, k.comfort, k.health, *figures))
    return show_table("axes", rows, 4, over=f"over {found.duration:.3g} s")


def tabulate_seat(found: Comfort) -> list[Table]:
    """Return the table of the SEAT factors, where seat and floor were recorded."""
    said = {True: "yes", False: "no", None: "no three repeats"}
    rows = [
        (axis, ", ".join(f"{run:.3f}" for run in each.runs), said[each.within_spread], each.rms, each.vdv,
         format_percent(each.spread))
        for axis, each in found.seat.items()
    ]  # fmt: skip
    return show_table("seat", rows, 3)


_PASSED = ("no", "yes")
NAMED = 3
"""Failures that the answer names."""


def report_seat_test(found: SeatTest, name: str, command: str) -> Report:
    """Return the report of a seat test.

    Args:
        found: its lines.
        name: of the scenario or recording, for the head.
        command: what makes the report again.
    """
    notes = [*found.notes, *(f"{each.run} failed: {each.reason}" for each in found.failures)]
    sections: dict[str, Sequence[Block]] = {
        "classes": tabulate_classes(found.rows),
        "damping": [*tabulate_damping(found.damping_rows), *show_pictures(plot_damping(found), "damping")],
    }
    about, answer, advice = f"Seat test: {name}", [say_seat_test(found)], _advise_on_seat_test(found)
    recalled = format_sentence(RECALLED)
    return compose("seat_test", about, answer, advice, sections, notes, command, recalled=recalled)


def say_seat_test(found: SeatTest) -> str:
    """Return in a sentence which lines of the test are passed."""
    rows: list[SeatRow | DampingRow] = [*found.rows, *found.damping_rows]
    failed = list(dict.fromkeys(f"{row.run} on {row.spectral_class}" for row in rows if not row.passed))
    count = f"{sum(row.passed for row in rows)} of {len(rows)} checks are within the limits of ISO 7096"
    others = [f"{len(failed) - NAMED} others"] * (len(failed) > NAMED)
    return f"{count}; {join_names([*failed[:NAMED], *others])} exceed theirs." if failed else f"{count}."


def _advise_on_seat_test(found: SeatTest) -> list[str]:
    worst = max(found.rows, key=lambda row: row.seat / row.limit, default=None)
    texts = []
    if worst is not None and not worst.passed:
        where = f"{worst.run} on {worst.spectral_class} under a driver of {worst.mass:g} kg"
        share = format_percent(worst.seat / worst.limit)
        texts.append(f"Begin with {where}: its SEAT factor is {share} of the limit.")
    return texts + choose_advice(end_stops=any(row.end_stop_hits for row in found.rows), other_laws=True)


def tabulate_classes(rows: Sequence[SeatRow]) -> list[Table]:
    """Return the table of the SEAT factors, a row for each class and driver."""
    lines = []
    for row in rows:
        tested = (row.run, row.spectral_class, CLASSES[row.spectral_class].machines, _PASSED[row.passed])
        figures = (f"{row.mass:g}", row.seat, row.limit, row.corrected, format_percent(row.spread), row.end_stop_hits)
        lines.append((*tested, *figures))
    return show_table("classes", lines, 4, [k for k, row in enumerate(rows) if not row.passed], clause=ACCEPTANCE)


def tabulate_damping(rows: Sequence[DampingRow]) -> list[Table]:
    """Return the table of the damping test, a row for each seat and limit."""
    groups = dict[tuple[str, float, float], list[DampingRow]]()
    for row in rows:
        groups.setdefault((row.run, row.transmissibility, row.limit), []).append(row)
    lines = []
    for alike in groups.values():
        classes, one = join_names([row.spectral_class for row in alike]), alike[0]
        lines.append((one.run, classes, _PASSED[one.passed], one.resonance, one.transmissibility, one.limit))
    strong = [k for k, alike in enumerate(groups.values()) if not alike[0].passed]
    return show_table("damping", lines, 3, strong, clause=DAMPING)
