"""The report of a seat test: which classes of ISO 7096 a seat passes, and by how much."""

from __future__ import annotations

from collections.abc import Sequence

from seatsim.plots.bench.resonance import plot_damping
from seatsim.plots.labels import UNKNOWN, format_number, format_percent
from seatsim.report.blocks import Block, Report, Section, Table, list_notes, show_pictures
from seatsim.report.credibility.card import say_doubt, show_card
from seatsim.report.credibility.evidence import collect_seat_test
from seatsim.report.formatting import format_sentence
from seatsim.report.method import describe_method
from seatsim.schema.text import join_names
from seatsim.standards.seat_rows import LIMITS, RECALLED, DampingRow, SeatRow, SeatTest

NAMED = 3
"""Failures that the answer names."""
METHOD = (
    "The SEAT factor is the weighted acceleration at the driver over that at the floor, each a mean over the runs of a"
    " class and driver; the spread is the largest deviation of a run from that mean.",
    "The damping test gives the transmissibility at resonance, with an inert mass on the seat.",
    format_sentence(RECALLED),
)


def report_seat_test(found: SeatTest, name: str, is_measured: bool, command: str) -> Report:
    """Return the report of a seat test.

    Args:
        found: its lines.
        name: of the scenario or recording, for the head.
        is_measured: whether the lines are of a recording.
        command: what makes the report again.
    """
    texts = [*found.notes, *(f"{each.run} failed: {each.reason}" for each in found.failures)]
    evidence, curves = collect_seat_test(found, is_measured), show_pictures(plot_damping(found), "damping")
    sections = [
        Section("classes", "SEAT factors", _tabulate_classes(found.rows)),
        Section("damping", "Damping at resonance", [*_tabulate_damping(found.damping_rows), *curves]),
        Section("notes", "Notes", list_notes([format_sentence(text) for text in texts])),
        show_card(evidence),
        describe_method(METHOD, command),
    ]
    about, doubt = f"Seat test: {name}", say_doubt(evidence)
    return Report(about, _say_seat_test(found), [], _advise(found), sections, doubt)


def _say_seat_test(found: SeatTest) -> str:
    """Return in a sentence which lines of the test are passed."""
    rows: list[SeatRow | DampingRow] = [*found.rows, *found.damping_rows]
    failed = list(dict.fromkeys(f"{row.run} on {row.spectral_class}" for row in rows if not row.passed))
    count = f"{sum(row.passed for row in rows)} of {len(rows)} checks are within the limits of ISO 7096"
    others = [f"{len(failed) - NAMED} others"] * (len(failed) > NAMED)
    return f"{count}; {join_names([*failed[:NAMED], *others])} exceed theirs." if failed else f"{count}."


def _advise(found: SeatTest) -> list[str]:
    worst = max(found.rows, key=lambda row: row.seat / row.limit, default=None)
    texts = []
    if worst is not None and not worst.passed:
        texts.append(f"Begin with {worst.run} on {worst.spectral_class} under a driver of {worst.mass:g} kg: its SEAT"
                     f" factor is {format_percent(worst.seat / worst.limit)} of the limit.")  # fmt: skip
    if any(row.end_stop_hits for row in found.rows):
        texts.append("Look at the travel: the seat hits its end stops, for which the standard has no limit.")
    return [*texts, "Try other laws and settings on the floor of a class: excitation: {kind: iso7096} in a scenario."]


def _tabulate_classes(rows: Sequence[SeatRow]) -> list[Block]:
    lines = [
        [row.run, row.spectral_class, LIMITS[row.spectral_class].machines, "yes" if row.passed else "no",
         f"{row.mass:g}", format_number(row.seat), format_number(row.limit), format_percent(row.spread),
         UNKNOWN if row.end_stop_hits is None else str(row.end_stop_hits)]
        for row in rows
    ]  # fmt: skip
    head = [
        "run", "class", "machine", "passed", "driver [kg]", "SEAT factor", "limit", "spread of runs", "end-stop hits",
    ]  # fmt: skip
    strong = [k for k, row in enumerate(rows) if not row.passed]
    caption = "Each class with a light and a heavy driver; in bold what is above its limit"
    return [Table(caption, head, lines, 4, strong)] * bool(lines)


def _tabulate_damping(rows: Sequence[DampingRow]) -> list[Block]:
    lines = [
        [row.run, row.spectral_class, "yes" if row.passed else "no", format_number(row.resonance),
         format_number(row.transmissibility), format_number(row.limit)]
        for row in rows
    ]  # fmt: skip
    head = ["run", "class", "passed", "resonance [Hz]", "transmissibility", "limit"]
    strong = [k for k, row in enumerate(rows) if not row.passed]
    caption = "Transmissibility at the resonance; in bold what is above its limit"
    return [Table(caption, head, lines, 3, strong)] * bool(lines)
