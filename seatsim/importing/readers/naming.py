"""What variables of a structured file state beside the channels: units, rates, and how matrices are named."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from seatsim.importing.signals import Signal

RATES = (
    "fs",
    "sample_rate",
    "samplerate",
    "sampling_rate",
    "samplingrate",
    "rate",
    "frequency",
    "sample_rate_hz",
    "fa",
)
STEPS = ("dt", "delta_t", "ts", "sample_time", "increment", "wf_increment", "step")
"""Names under which the sample rate in Hz, or the interval in s, is stated."""
UNITS = ("unit", "units", "unit_string", "einheit", "ylabel_unit")
"""Names under which a unit is stated."""


def stated_rate(values: Mapping[str, object]) -> float | None:
    """Return the sample rate in Hz that stands among named values, None where none does."""
    for names, is_rate in ((RATES, True), (STEPS, False)):
        for key, value in values.items():
            number = scalar(value)
            if key.lower() in names and number is not None and number > 0.0:
                return number if is_rate else 1.0 / number
    return None


def stated_unit(values: Mapping[str, object]) -> str:
    """Return the unit that stands among named values, empty where none does."""
    return next((as_text(value) for key, value in values.items() if key.lower() in UNITS), "")


def scalar(value: object) -> float | None:
    """Return a single number, whatever array it stands in, None where there is none."""
    array = np.asarray(value)
    return float(array.ravel()[0]) if array.size == 1 and array.dtype.kind in "fiu" else None


def as_text(value: object) -> str:
    """Return a text that may be bytes or stand in an array."""
    array = np.asarray(value)
    if array.size != 1:
        return ""
    single = array.ravel()[0]
    return single.decode(errors="replace") if isinstance(single, bytes) else str(single)


def signals_of(
    name: str, array: NDArray[np.generic], unit: str = "", columns: Sequence[str] = (), units: Sequence[str] = ()
) -> list[Signal]:
    """Return the channels of an array of shape (N,), (N, k) or (k, N), k smaller; a matrix is `name#1`, `name#2`."""
    values = np.squeeze(np.asarray(array))
    if values.dtype.kind not in "fiub" or values.ndim not in (1, 2) or values.size < 2:
        return []
    values = values.astype(np.float64)
    if values.ndim == 1:
        return [Signal(name, unit, values)]
    if values.shape[0] < values.shape[1]:
        values = values.T
    count = values.shape[1]
    names = list(columns) if len(columns) == count else [f"{name}#{index + 1}" for index in range(count)]
    stated = list(units) if len(units) == count else [unit] * count
    return [Signal(each, of, values[:, index]) for index, (each, of) in enumerate(zip(names, stated, strict=True))]
