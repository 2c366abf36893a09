"""Names, units and looks of the keys and metrics of a sweep."""

from __future__ import annotations

from collections.abc import Mapping

from seatsim.plots.frame import Quantity, describe_quantity

WORDS = {
    "driver_acceleration_weighted": "driver, Wk RMS", "suspension_displacement_rms": "RMS suspension travel",
    "suspension_displacement_peak": "peak suspension travel",
}  # fmt: skip
"""Metrics that have a shorter name in pictures."""
SCREEN = 7.0
"""Height in inches that no picture exceeds: 672 pixels of a screen."""


def describe_column(name: str, units: Mapping[str, str]) -> Quantity:
    """Return how a key or a metric is drawn."""
    return describe_quantity(WORDS.get(name, name), units.get(name, ""))


def format_level(value: object) -> str:
    """Return the value of a key as text."""
    return f"{value:.4g}" if isinstance(value, float) else str(value)
