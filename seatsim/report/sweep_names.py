"""What keys and metrics of a sweep are called on its report."""

from __future__ import annotations

from collections.abc import Mapping

from seatsim.metrics.table import METRICS, SHORT
from seatsim.plots.quantities import Quantity
from seatsim.report.formatting import describe_channel, format_number

COMFORT, TRAVEL = "driver_acceleration_weighted", "suspension_displacement_rms"


def describe_column(name: str, units: Mapping[str, str]) -> Quantity:
    """Return how a key, by its name, or a metric, in words, is shown."""
    shown = describe_channel(SHORT.get(name, name), units.get(name, ""))
    return shown if name in METRICS else shown._replace(words=name)


def format_level(value: object) -> str:
    """Return the value of a key as text."""
    return format_number(value, 4) if isinstance(value, float) else str(value)
