"""The report of a seat test: which classes of ISO 7096 a seat passes, and by how much."""

from __future__ import annotations

from collections.abc import Sequence

from seatsim.plots.bench.resonance import plot_damping
from seatsim.plots.labels import format_percent
from seatsim.report.blocks import Block, Report, Section, show_pictures, tabulate
from seatsim.report.composing import Closing, compose
from seatsim.report.credibility import Factor, count_variations, state_intervals, trace_inputs
from seatsim.report.formatting import format_sentence
from seatsim.schema.text import join_names
from seatsim.standards.seat_rows import LIMITS, RECALLED, DampingRow, SeatRow, SeatTest

PASSED = ("no", "yes")
NAMED = 3
"""Failures that the answer names."""


def report_seat_test(found: SeatTest, name: str, is_measured: bool, command: str) -> Report:
    """Return the report of a seat test.

    Args:
        found: its lines.
        name: of the scenario or recording, for the head.
        is_measured: whether the lines are of a recording.
        command: what makes the report again.
    """
    notes = [*found.notes, *(f"{each.run} failed: {each.reason}" for each in found.failures)]
    curves = show_pictures(plot_damping(found), "damping")
    sections = [
        Section("classes", "SEAT factors", _tabulate_classes(found.rows)),
        Section("damping", "Damping at resonance", [*_tabulate_damping(found.damping_rows), *curves]),
    ]
    answer, closing = [_say_seat_test(found)], Closing(notes, _judge(found, is_measured), command)
    recalled = format_sentence(RECALLED)
    return compose("seat_test", f"Seat test: {name}", answer, _advise(found), sections, closing, recalled=recalled)


def _judge(found: SeatTest, is_measured: bool) -> list[Factor]:
    """Return how far a seat test may be trusted."""
    has_spread = any(row.within_spread is not None for row in found.rows)
    several = len({row.person for row in found.rows}) > 1
    return [
        trace_inputs([*found.notes, *(failure.reason for failure in found.failures)], is_measured=is_measured),
        state_intervals(["the SEAT factors, by the spread of their runs"] * has_spread),
        count_variations(len(found.rows), ["spectral class", "mass of the test person"] * several),
    ]


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
        where = f"{worst.run} on {worst.spectral_class} under a driver of {worst.mass:g} kg"
        share = format_percent(worst.seat / worst.limit)
        texts.append(f"Begin with {where}: its SEAT factor is {share} of the limit.")
    if any(row.end_stop_hits for row in found.rows):
        texts.append("Look at the travel: the seat hits its end stops, for which the standard has no limit.")
    return [*texts, "Try other laws and settings on the floor of a class: excitation: {kind: iso7096} in a scenario."]


def _tabulate_classes(rows: Sequence[SeatRow]) -> list[Block]:
    lines = []
    for row in rows:
        tested = (row.run, row.spectral_class, LIMITS[row.spectral_class].machines, PASSED[row.passed])
        figures = (f"{row.mass:g}", row.seat, row.limit, row.corrected, format_percent(row.spread), row.end_stop_hits)
        lines.append((*tested, *figures))
    caption = "Each class with a light and a heavy driver; in bold what is above its limit"
    head = (
        "run, class, machine, passed, driver [kg], SEAT factor, limit, a_w at the intended input [m/s²], spread of"
        " runs, end-stop hits"
    )
    return tabulate(caption, head, lines, 4, [k for k, row in enumerate(rows) if not row.passed])


def _tabulate_damping(rows: Sequence[DampingRow]) -> list[Block]:
    lines = [
        (row.run, row.spectral_class, PASSED[row.passed], row.resonance, row.transmissibility, row.limit)
        for row in rows
    ]
    caption = "Transmissibility at the resonance; in bold what is above its limit"
    head = "run, class, passed, resonance [Hz], transmissibility, limit"
    return tabulate(caption, head, lines, 3, [k for k, row in enumerate(rows) if not row.passed])
