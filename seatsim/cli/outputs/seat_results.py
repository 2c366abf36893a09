"""What `seatsim comfort` and `seatsim seat-test` print and write."""

from __future__ import annotations

from pathlib import Path

from seatsim.cli.outputs.writing import name_pictures, write_outputs
from seatsim.cli.show_table import show_report_tables
from seatsim.cli.terminal import complain, conclude, say, warn
from seatsim.plots.bench.vibration import plot_vibration
from seatsim.report import standards
from seatsim.standards.comfort import Comfort
from seatsim.standards.seat_rows import SeatTest


def present_comfort(found: Comfort, source: Path, folder: Path) -> None:
    """Print the figures of a vibration; write `comfort.json`, `report.html` and the pictures."""
    show_report_tables([*standards.tabulate_axes(found), *standards.tabulate_seat(found)])
    for sentence in standards.list_comfort_sentences(found):
        say(sentence)
    warn(found.notes)
    figures = plot_vibration(found)
    report = standards.report_comfort(found, figures, f"seatsim comfort {source.name}")
    contents = {"comfort.json": found, "report.html": report, **name_pictures(figures)}
    conclude(found, folder, write_outputs(folder, contents))


def present_seat_test(found: SeatTest, source: Path, folder: Path) -> None:
    """Print the lines of a seat test and which came to no result; write `seat_test.json` and `report.html`."""
    show_report_tables([*standards.tabulate_classes(found.rows), *standards.tabulate_damping(found.damping_rows)])
    say(standards.say_seat_test(found))
    for each in found.failures:
        complain(f"failed: {', '.join(filter(None, (each.run, each.spectral_class, each.person)))}: {each.reason}")
    warn(found.notes)
    command = f"seatsim seat-test {source.name}"
    report = standards.report_seat_test(found, source.resolve().stem, command)
    conclude(found, folder, write_outputs(folder, {"seat_test.json": found, "report.html": report}))
