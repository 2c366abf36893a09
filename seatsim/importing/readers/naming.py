"""What variables of a structured file state beside the channels: units, rates, and how matrices are named."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from seatsim.importing.signals import Signal

RATES = (
    "fs", "samplerate", "samplingrate", "rate", "frequency", "sampleratehz", "fa", "samplefrequency",
    "samplingfrequency", "abtastrate",
)  # fmt: skip
STEPS = (
    "dt", "deltat", "ts", "sampletime", "increment", "wfincrement", "step", "samplingperiod", "sampleinterval",
    "samplinginterval", "dx", "deltax", "xdelta", "xinc", "xincrement",
)  # fmt: skip
"""Names, without their underscores, under which the sample rate in Hz, or the interval in s, is stated."""
NUMBER = re.compile(r"\s*\d+([.,]\d*)?([eE][-+]?\d{1,2})?\s*")
"""A number as a text."""
UNITS = ("unit", "units", "unitstring", "einheit", "ylabelunit", "yunit", "unity", "nunit")
"""Names under which a unit is stated."""


def bare(name: str) -> str:
    """Return a name in lower case and without underscores and blanks: `Sample_Rate` is `samplerate`."""
    return name.lower().replace("_", "").replace(" ", "")


def stated_rate(values: Mapping[str, object], seconds: float = 1.0) -> float | None:
    """Return the sample rate in Hz that stands among named values, None where none does.

    `seconds` is the unit of intervals in s.
    """
    for names, is_rate in ((RATES, True), (STEPS, False)):
        for key, value in values.items():
            number = scalar(value) if bare(key) in names else None
            if number is not None and 0.0 < number < np.inf:
                return number if is_rate else 1.0 / (seconds * number)
    return None


def stated_unit(values: Mapping[str, object]) -> str:
    """Return the unit that stands among named values, empty where none does."""
    return next((as_text(value) for key, value in values.items() if bare(key) in UNITS), "")


def scalar(value: object) -> float | None:
    """Return a single number, whatever array or text it stands in, None where there is none."""
    if isinstance(value, Mapping | list | tuple):
        return None
    array = np.asarray(value)
    if array.size == 1 and array.dtype.kind in "USO" and NUMBER.fullmatch(as_text(array)):
        return float(as_text(array).replace(",", "."))
    return float(array.ravel()[0]) if array.size == 1 and array.dtype.kind in "fiu" else None


def as_text(value: object) -> str:
    """Return a text that may be bytes or stand in an array; it is empty where there is none."""
    if value is None or isinstance(value, Mapping | list | tuple):
        return ""
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
