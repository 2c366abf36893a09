"""The gap of a simulation, and the one to be expected, as the terminal shows them."""

from __future__ import annotations

import math

from rich.table import Table

from seatsim.recordings.forecast import Forecast
from seatsim.recordings.gap import Gap


def gap_table(found: Gap) -> Table:
    """Return the gap as a table: each channel and the overall figure, with the noise floor."""
    table = Table(title="gap, in standard deviations of what was measured", title_justify="left")
    for heading in ("channel", "gap", "noise floor"):
        table.add_column(heading, justify="left" if heading == "channel" else "right")
    for name, value in found.channels.items():
        table.add_row(name, f"{value:.4f}", show_floor(found.floor.channels[name]))
    table.add_section()
    table.add_row("overall", f"{found.overall:.4f}", show_floor(found.floor.overall))
    return table


def show_floor(floor: float) -> str:
    """Return a noise floor as a table shows it; one of 0 is that of a sensor whose noise nobody stated."""
    return f"{floor:.4f}" if floor else "not stated"


def forecast_table(found: Forecast) -> Table:
    """Return the gap to be expected before and after, beside the measured one where outputs are recorded."""
    predicted, measured = found.predicted, found.measured
    low, high = predicted.shrink_interval
    title = f"expected shrink {predicted.shrink:.2f}, 90 % interval {low:.2f} to {high:.2f}"
    if measured is not None:
        title += f"; measured {measured.shrink:.2f}"
    table = Table(title=title, title_justify="left")
    headings = ("channel", "expected before", "expected after")
    for heading in (*headings, "measured before", "measured after") if measured else headings:
        table.add_column(heading, justify="left" if heading == "channel" else "right")
    for name, expected in predicted.channels.items():
        gaps = [part.get(name, math.nan) for part in (measured.channels, found.channels)] if measured else []
        table.add_row(name, *(f"{value:.4f}" for value in (*expected, *gaps)))
    table.add_section()
    overall = (measured.before, measured.after) if measured else ()
    table.add_row("overall", *(f"{value:.4f}" for value in (predicted.before, predicted.after, *overall)))
    return table
