"""Sizes that quantities of a seat or a damper have, and the units in which larger values would be such."""

from __future__ import annotations

import numpy as np

from seatsim.schema.arrays import Array
from seatsim.schema.units import find_conversion

PLAUSIBLE = {
    "m/s^2": (0.0, 500.0), "m": (0.0, 1.0), "m/s": (0.0, 5.0), "N": (0.0, 30_000.0), "A": (0.0, 30.0),
    "V": (0.0, 60.0), "degC": (-50.0, 200.0),
}  # fmt: skip
"""Range of the size of values by their SI unit, of the values themselves for temperatures."""
ALTERNATIVES = {
    "m/s^2": ("mm/s^2", "cm/s^2"), "m": ("mm", "cm"), "m/s": ("mm/s",), "N": ("mN",), "A": ("mA",), "V": ("mV",),
    "degC": ("K", "degF"),
}  # fmt: skip
"""Units to which values outside the range point, the likeliest first."""


def say_implausible(values: Array, unit: str) -> str:
    """Return what is said of values in an SI unit that no seat reaches, empty where a seat may reach them."""
    if unit not in PLAUSIBLE:
        return ""
    if _is_plausible(values, unit):
        return ""
    extreme = float(values[np.argmax(np.abs(values))])
    shown = abs(extreme) if PLAUSIBLE[unit][0] == 0.0 else extreme
    fitting = [other for other in ALTERNATIVES[unit] if _is_plausible(_read_as(values, other, unit), unit)]
    guess = f"; is it in {' or '.join(fitting)}?" if fitting else ""
    return f"reaches {shown:.4g} in SI units, more than a seat does{guess}"


def _is_plausible(values: Array, unit: str) -> bool:
    low, high = PLAUSIBLE[unit]
    if low == 0.0:
        return float(np.max(np.abs(values))) <= high
    return bool(low <= np.min(values) and np.max(values) <= high)


def _read_as(values: Array, unit: str, wanted: str) -> Array:
    found = find_conversion(unit, wanted)
    return values if found is None else found.factor * values + found.zero
