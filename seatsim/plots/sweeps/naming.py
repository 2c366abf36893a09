"""Names, units and looks of the keys and metrics of a sweep."""

from __future__ import annotations

from collections.abc import Mapping

from seatsim.metrics.table import METRICS
from seatsim.plots.frame import Quantity, describe_quantity
from seatsim.plots.labels import clean_text

LONGEST_KEY = 40
WORDS = {
    "driver_acceleration_weighted": "driver, Wk RMS", "suspension_displacement_rms": "RMS suspension travel",
    "suspension_displacement_peak": "peak suspension travel",
}  # fmt: skip
"""Metrics that have a shorter name in pictures."""
SCREEN = 7.0
"""Height in inches that no picture exceeds: 672 pixels of a screen."""


def describe_column(name: str, units: Mapping[str, str]) -> Quantity:
    """Return how a key, by its name, or a metric, in words, is drawn."""
    quantity = describe_quantity(WORDS.get(name, name), units.get(name, ""))
    return quantity if name in METRICS else quantity._replace(words=clean_text(name, LONGEST_KEY))


def format_level(value: object) -> str:
    """Return the value of a key as text."""
    return f"{value:.4g}" if isinstance(value, float) else str(value)
