"""What `seatsim comfort` and `seatsim seat-test` print: tables, and sentences below them."""

from __future__ import annotations

import math
from collections.abc import Iterator

from rich.markup import escape
from rich.table import Table

from seatsim.cli.show_table import make_table
from seatsim.metrics.exposure import DAY, Exposure, ValueReached
from seatsim.schema.text import join_names
from seatsim.standards.comfort import Comfort
from seatsim.standards.seat_rows import ACCEPTANCE, DAMPING, LIMITS, SeatTest

_AXIS = [
    "axis",
    "weighting",
    "k comfort",
    "k health",
    "a_w\n[m/s²]",
    "VDV\n[m/s¹·⁷⁵]",
    "eVDV\n[m/s¹·⁷⁵]",
    "MTVV\n[m/s²]",
    "crest\nfactor",
    "method\n(6.3)",
]
_SEAT = ["axis", "SEAT\n(RMS)", "SEAT\n(VDV)", "of each run", "spread", "three runs\nwithin 5 %"]


def make_comfort_tables(found: Comfort) -> list[Table]:
    """Return the table of the axes, and that of the SEAT factors where there are any."""
    axes = []
    for axis, each in found.axes.items():
        k, dose = each.direction, each.dose
        factors = (f"{k.comfort:g}", "-" if k.health is None else f"{k.health:g}")
        figures = (f"{dose.rms:.3f}", f"{dose.vdv:.2f}", f"{dose.estimated_vdv:.2f}", f"{dose.mtvv:.3f}")
        axes.append((axis, k.weighting, *factors, *figures, f"{dose.crest_factor:.1f}", each.method))
    verdicts, seats = {True: "yes", False: "no", None: "fewer runs"}, []
    for axis, seat in found.seat.items():
        runs = ", ".join(f"{value:.3f}" for value in seat.runs)
        spread = (f"{1e2 * seat.spread:.1f} %", verdicts[seat.within_spread])
        seats.append((axis, f"{seat.rms:.3f}", f"{seat.vdv:.3f}", runs, *spread))
    tables = [make_table(f"ISO 2631-1 figures of {found.source}, {found.duration:g} s", _AXIS, axes, left=(0, 1))]
    return [*tables, *([make_table("SEAT factors (ISO 10326-1)", _SEAT, seats, left=())] if seats else [])]


def list_comfort_sentences(found: Comfort) -> Iterator[str]:
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


def _say_exposure(day: Exposure) -> Iterator[str]:
    vdv8 = f"VDV(8) {day.vdv8:.2f} m/s¹·⁷⁵ ({day.vdv8_axis})"
    yield f"{day.hours:g} h a day: A(8) {day.a8:.3f} m/s² ({day.a8_axis}), {vdv8}"
    yield _say_value("action value", day.action_value)
    yield _say_value("limit value", day.limit_value)
    yield f"ISO 2631-1, annex B, by A(8): {day.zone_a8_text}; by estimated VDV: {day.zone_vdv}"


def _say_value(name: str, value: ValueReached) -> str:
    by_a8 = _say_reach(f"A(8) {value.a8:g} m/s²", value.exceeded_by_a8, value.hours_to_a8)
    by_vdv = _say_reach(f"VDV {value.vdv:g} m/s¹·⁷⁵", value.exceeded_by_vdv, value.hours_to_vdv)
    return f"{name} of 2002/44/EC: {by_a8}; {by_vdv}"


def _say_reach(value: str, exceeded: bool, hours: float) -> str:
    if not math.isfinite(hours) or hours > DAY:
        return f"{value} not reached in a day"
    return f"{value} {'exceeded' if exceeded else 'not exceeded'}, reached after {hours:.2g} h"


def make_seat_test_tables(found: SeatTest) -> list[Table]:
    """Return a table of the SEAT factors for each seat, and one of the damping test."""
    tables = [_make_seat_table(found, run) for run in dict.fromkeys(row.run for row in found.rows)]
    return [*tables, *([_make_damping_table(found)] if found.damping_rows else [])]


def _make_seat_table(found: SeatTest, run: str) -> Table:
    rows = []
    for row in found.rows:
        if row.run == run:
            who = (row.spectral_class, LIMITS[row.spectral_class].machines, f"{row.mass:g}")
            hits = "-" if row.end_stop_hits is None else str(row.end_stop_hits)
            factors = (f"{row.seat:.2f}", f"{row.limit:.1f}", _say_verdict(row.passed), f"{1e2 * row.spread:.1f}")
            rows.append((*who, *factors, hits))
    headings = ("class", "machine", "driver\n[kg]", "SEAT\n[-]", "limit\n[-]", "pass", "spread\n[%]", "end-stop\nhits")
    return make_table(f"{run}: SEAT factors ({ACCEPTANCE})", headings, rows, left=(0, 1))


def _make_damping_table(found: SeatTest) -> Table:
    """Return the damping test of each run, with the classes of one limit in one row."""
    rows = []
    for run, limit in dict.fromkeys((row.run, row.limit) for row in found.damping_rows):
        alike = [row for row in found.damping_rows if (row.run, row.limit) == (run, limit)]
        figures = (f"{alike[0].resonance:.2f}", f"{alike[0].transmissibility:.2f}", f"{limit:.1f}")
        classes = ", ".join(row.spectral_class for row in alike)
        rows.append((escape(run), classes, *figures, _say_verdict(alike[0].passed)))
    headings = ("run", "classes", "resonance\n[Hz]", "transmissibility\n[-]", "limit\n[-]", "pass")
    return make_table(f"Damping test at resonance ({DAMPING})", headings, rows, left=(0, 1))


def _say_verdict(passed: bool) -> str:
    return "[green]yes[/]" if passed else "[red]no[/]"


def list_seat_test_failures(found: SeatTest) -> list[str]:
    """Return a line for each run that came to no result."""
    return [
        f"{', '.join(filter(None, (each.run, each.spectral_class, each.person)))}: {each.reason}"
        for each in found.failures
    ]


def summarise_seat_test(found: SeatTest) -> str:
    """Return how many of the lines passed, in one sentence."""
    verdicts = [row.passed for row in found.rows] + [row.passed for row in found.damping_rows]
    hits = sum(row.end_stop_hits or 0 for row in found.rows)
    return f"{sum(verdicts)} of {len(verdicts)} lines pass; {hits} hits of the end stops"
