"""What `seatsim comfort` prints and writes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

from rich import box
from rich.markup import escape
from rich.table import Table

from seatsim.metrics.exposure import DAY, ZONES, Exposure, ValueReached
from seatsim.schema.text import join_names
from seatsim.standards.comfort import AxisAssessment, Comfort


def make_tables(found: Comfort) -> list[Table]:
    """Return the table of the axes, and that of the SEAT factors where there are any."""
    return [_axes(found), *([_seat(found)] if found.seat else [])]


def list_sentences(found: Comfort) -> Iterator[str]:
    """Yield what is said below the tables: sums, the day's exposure, the zones, and what the basic method lacks."""
    totals = ", ".join(f"{point} {value:.3f}" for point, value in found.totals.items())
    yield f"vibration total value a_v [m/s²]: {totals}"
    for axis, assessed in found.axes.items():
        if assessed.shocks:
            reasons = join_names(assessed.shocks)
            yield f"{axis}: report MTVV or VDV beside a_w, as {reasons} (ISO 2631-1, 6.2.2 and 6.3.3)"
    if found.motion_sickness:
        sickness = found.motion_sickness
        yield f"motion sickness (Wf): a_w {sickness.rms:.3f} m/s², MSDV {sickness.msdv:.2f} m/s¹·⁵"
    if found.exposure:
        yield from _say_exposure(found.exposure)


def encode(found: Comfort) -> dict[str, object]:
    """Return the content of `comfort.json`."""
    exposure = found.exposure
    day: dict[str, object] = dict.fromkeys(("a8", "vdv8", "action_value", "limit_value"))
    if exposure:
        day = exposure._asdict() | {"zone_a8_text": ZONES[exposure.zone_a8], "zone_vdv_text": ZONES[exposure.zone_vdv]}
    return {
        "source": Path(found.source).name,
        "runs": found.runs,
        "duration": found.duration,
        "sample_rate": found.sample_rate,
        "axes": {axis: _encode_axis(assessed) for axis, assessed in found.axes.items()},
        "totals": dict(found.totals),
        **day,
        "seat": dict(found.seat),
        "motion_sickness": found.motion_sickness,
        "notes": found.notes,
    }


def _encode_axis(found: AxisAssessment) -> dict[str, object]:
    return {
        "column": found.column,
        "weighting": found.direction.weighting,
        "unit": found.direction.unit,
        "factor_comfort": found.direction.comfort,
        "factor_health": found.direction.health,
        **found.dose._asdict(),
        "method": found.method,
        "reasons": found.shocks,
        "removed_mean": found.removed,
    }


def _axes(found: Comfort) -> Table:
    table = _headed(f"ISO 2631-1 figures of {found.source}, {found.duration:g} s")
    columns = (
        "axis", "weighting", "k comfort", "k health", "a_w\n\\[m/s²]", "VDV\n\\[m/s¹·⁷⁵]", "eVDV\n\\[m/s¹·⁷⁵]",
        "MTVV\n\\[m/s²]", "crest\nfactor", "method\n(6.3)",
    )  # fmt: skip
    for heading in columns:
        table.add_column(
            heading, justify="left" if heading in columns[:2] else "right", vertical="bottom", no_wrap=True
        )
    for axis, each in found.axes.items():
        dose, k = each.dose, each.direction
        factors = (f"{k.comfort:g}", "-" if k.health is None else f"{k.health:g}")
        doses = (f"{dose.rms:.3f}", f"{dose.vdv:.2f}", f"{dose.estimated_vdv:.2f}", f"{dose.mtvv:.3f}")
        table.add_row(axis, k.weighting, *factors, *doses, f"{dose.crest_factor:.1f}", each.method)
    return table


def _seat(found: Comfort) -> Table:
    table = _headed("SEAT factors (ISO 10326-1)")
    for heading in ("axis", "SEAT\n(RMS)", "SEAT\n(VDV)", "of each run", "spread", "three runs\nwithin 5 %"):
        table.add_column(heading, justify="right", vertical="bottom", no_wrap=True)
    verdicts = {True: "yes", False: "no", None: "fewer runs"}
    for axis, seat in found.seat.items():
        runs = ", ".join(f"{value:.3f}" for value in seat.runs)
        spread = f"{1e2 * seat.spread:.1f} %"
        table.add_row(axis, f"{seat.rms:.3f}", f"{seat.vdv:.3f}", runs, spread, verdicts[seat.within_spread])
    return table


def _headed(title: str) -> Table:
    return Table(title=escape(title), title_justify="left", box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0))


def _say_exposure(day: Exposure) -> Iterator[str]:
    vdv8 = f"VDV(8) {day.vdv8:.2f} m/s¹·⁷⁵ ({day.vdv8_axis})"
    yield f"{day.hours:g} h a day: A(8) {day.a8:.3f} m/s² ({day.a8_axis}), {vdv8}"
    yield _say_value("action value", day.action_value)
    yield _say_value("limit value", day.limit_value)
    yield f"ISO 2631-1, annex B, by A(8): {ZONES[day.zone_a8]}; by estimated VDV: {day.zone_vdv}"


def _say_value(name: str, value: ValueReached) -> str:
    by_a8 = _say_reach(f"A(8) {value.a8:g} m/s²", value.exceeded_by_a8, value.hours_to_a8)
    by_vdv = _say_reach(f"VDV {value.vdv:g} m/s¹·⁷⁵", value.exceeded_by_vdv, value.hours_to_vdv)
    return f"{name} of 2002/44/EC: {by_a8}; {by_vdv}"


def _say_reach(value: str, exceeded: bool, hours: float) -> str:
    if not math.isfinite(hours) or hours > DAY:
        return f"{value} not reached in a day"
    return f"{value} {'exceeded' if exceeded else 'not exceeded'}, reached after {hours:.2g} h"
