"""What `seatsim seat-test` prints and writes."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich import box
from rich.markup import escape
from rich.table import Table

from seatsim.provenance.manifest import write_documented
from seatsim.recordings.recording import HEADER
from seatsim.report.rendering import write_html
from seatsim.report.seat_test import report_seat_test
from seatsim.schema.files import write_json
from seatsim.standards.seat_rows import (
    ACCEPTANCE,
    DAMPING,
    LIMITS,
    RECALLED,
    SEATED_SHARE,
    DampingRow,
    SeatFailure,
    SeatRow,
    SeatTest,
)


def make_tables(found: SeatTest) -> list[Table]:
    """Return a table of the SEAT factors for each seat, and one of the damping test."""
    runs = dict.fromkeys(row.run for row in found.rows)
    tables = [_seat_table(run, [row for row in found.rows if row.run == run]) for run in runs]
    return [*tables, *([_damping_table(found.damping_rows)] if found.damping_rows else [])]


def write_seat_test(found: SeatTest, source: str, folder: Path) -> list[Path]:
    """Write `seat_test.json` and `report.html`; return their paths."""
    path = Path(source)
    is_measured = (path / HEADER).exists()
    report = report_seat_test(found, path.resolve().stem, is_measured, f"seatsim seat-test {path.name}")
    return write_documented(
        folder,
        lambda part: [
            write_json(part / "seat_test.json", encode(found, source)),
            write_html(report, part / "report.html"),
        ],
    )


def summarise(found: SeatTest) -> str:
    """Return how many of the lines passed, in one sentence."""
    verdicts = [row.passed for row in found.rows] + [row.passed for row in found.damping_rows]
    hits = sum(row.end_stop_hits or 0 for row in found.rows)
    return f"{sum(verdicts)} of {len(verdicts)} lines pass; {hits} hits of the end stops"


def list_failures(found: SeatTest) -> list[str]:
    """Return a line for each run that came to no result."""
    return [
        f"{', '.join(filter(None, (each.run, each.spectral_class, each.person)))}: {each.reason}"
        for each in found.failures
    ]


def encode(found: SeatTest, source: str) -> dict[str, object]:
    """Return the content of `seat_test.json`."""
    return {
        "source": Path(source).name,
        "standard": "ISO 7096:2000 with ISO 10326-1:2016",
        "recalled": RECALLED,
        "classes": [_encode(row) | {"mass_on_seat": SEATED_SHARE * row.mass} for row in found.rows],
        "damping": [_encode(row) for row in found.damping_rows],
        "damping_tests": found.damping,
        "failed": [_encode(failure) for failure in found.failures],
        "notes": found.notes,
    }


def _encode(row: SeatRow | DampingRow | SeatFailure) -> dict[str, object]:
    content = row._asdict()
    return {{"passed": "pass", "spectral_class": "class"}.get(key, key): value for key, value in content.items()}


def _seat_table(run: str, rows: Sequence[SeatRow]) -> Table:
    right = ("driver\n\\[kg]", "SEAT\n\\[-]", "limit\n\\[-]", "pass", "spread\n\\[%]", "end-stop\nhits")
    table = _headed(f"{run}: SEAT factors ({ACCEPTANCE})", ("class", "machine"), right)
    for row in rows:
        hits = "-" if row.end_stop_hits is None else str(row.end_stop_hits)
        figures = (
            f"{row.mass:g}",
            f"{row.seat:.2f}",
            f"{row.limit:.1f}",
            _verdict(row.passed),
            f"{1e2 * row.spread:.1f}",
        )
        table.add_row(row.spectral_class, LIMITS[row.spectral_class].machines, *figures, hits)
    return table


def _damping_table(rows: Sequence[DampingRow]) -> Table:
    right = ("resonance\n\\[Hz]", "transmissibility\n\\[-]", "limit\n\\[-]", "pass")
    table = _headed(f"Damping test at resonance ({DAMPING})", ("run", "classes"), right)
    for run in dict.fromkeys(row.run for row in rows):
        for limit in dict.fromkeys(row.limit for row in rows if row.run == run):
            alike = [row for row in rows if (row.run, row.limit) == (run, limit)]
            classes = ", ".join(row.spectral_class for row in alike)
            first = alike[0]
            figures = (
                f"{first.resonance:.2f}",
                f"{first.transmissibility:.2f}",
                f"{limit:.1f}",
                _verdict(first.passed),
            )
            table.add_row(escape(run), classes, *figures)
    return table


def _verdict(passed: bool) -> str:
    return "[green]yes[/]" if passed else "[red]no[/]"


def _headed(title: str, left: Sequence[str], right: Sequence[str]) -> Table:
    table = Table(title=escape(title), title_justify="left", box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0))
    for heading in left:
        table.add_column(heading, vertical="bottom")
    for heading in right:
        table.add_column(heading, justify="right", vertical="bottom", no_wrap=True)
    return table
