"""The gap of a simulation, as the terminal shows it."""

from __future__ import annotations

from rich.table import Table

from seatsim.recordings.gap import Gap


def gap_table(found: Gap) -> Table:
    """Return the gap as a table: each channel and the overall figure, with the noise floor."""
    table = Table(title="gap, in standard deviations of what was measured", title_justify="left")
    for heading in ("channel", "gap", "noise floor"):
        table.add_column(heading, justify="left" if heading == "channel" else "right")
    for name, value in found.channels.items():
        table.add_row(name, f"{value:.4f}", f"{found.floor['channels'][name]:.4f}")
    table.add_section()
    table.add_row("overall", f"{found.overall:.4f}", f"{found.floor['overall']:.4f}")
    return table
