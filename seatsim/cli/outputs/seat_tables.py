"""What `seatsim comfort` and `seatsim seat-test` print: tables, and a sentence below those of a seat test."""

from __future__ import annotations

from rich.markup import escape
from rich.table import Table

from seatsim.cli.show_table import make_table
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
    """Return the table of the axes, and those of operations and SEAT factors where there are any."""
    axes = []
    for axis, each in found.axes.items():
        k, dose = each.direction, each.dose
        factors = (f"{k.comfort:g}", "-" if k.health is None else f"{k.health:g}")
        figures = (f"{dose.rms:.3f}", f"{dose.vdv:.2f}", f"{dose.estimated_vdv:.2f}", f"{dose.mtvv:.3f}")
        axes.append((axis, k.weighting, *factors, *figures, f"{dose.crest_factor:.1f}", each.method))
    verdicts, seats = {True: "yes", False: "no", None: "-"}, []
    for axis, seat in found.seat.items():
        runs = ", ".join(f"{value:.3f}" for value in seat.runs)
        spread = (f"{1e2 * seat.spread:.1f} %", verdicts[seat.within_spread])
        seats.append((axis, f"{seat.rms:.3f}", f"{seat.vdv:.3f}", runs, *spread))
    over = "the hours of a day" if found.operations else f"{found.duration:g} s"
    tables = [make_table(f"ISO 2631-1 figures of {found.source} over {over}", _AXIS, axes, left=(0, 1))]
    if found.operations:
        tables.append(make_table("Partial exposures", *_list_operations(found)))
    return [*tables, *([make_table("SEAT factors (ISO 10326-1)", _SEAT, seats, left=())] if seats else [])]


def _list_operations(found: Comfort) -> tuple[list[str], list[tuple[str, ...]]]:
    """Return headings and rows of the operations of a day."""
    axes = list(found.operations[0].a8)
    headings = ["operation", "hours", *(f"A(8) {axis}\n[m/s²]" for axis in axes), "share of\nA(8)²"]
    rows = [
        (escape(each.name), f"{each.hours:g}", *(f"{each.a8[axis]:.3f}" for axis in axes), f"{1e2 * each.share:.0f} %")
        for each in found.operations
    ]
    return headings, rows


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
