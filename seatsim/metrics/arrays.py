"""What every metric requires of its input, checked in one place so that each error names the signal."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError


def as_signal(values: ArrayLike, name: str = "signal") -> Array:
    """Return `values` as floats of shape (N,), N >= 1.

    Raises:
        InputError: the values are not numbers, have another number of dimensions than one, or there are none.
    """
    try:
        signal = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name}: must be an array of numbers ({error})") from error
    if signal.ndim != 1 or signal.size == 0:
        raise InputError(f"{name}: has shape {signal.shape}; must have one dimension and at least one sample")
    return signal


def as_pair(first: ArrayLike, second: ArrayLike, names: tuple[str, str]) -> tuple[Array, Array]:
    """Return two signals of the same length, shape (N,) each; `names` are theirs in an error.

    Raises:
        InputError: one of them is no signal, or their lengths differ.
    """
    a, b = as_signal(first, names[0]), as_signal(second, names[1])
    if a.size != b.size:
        raise InputError(f"{names[0]} has {a.size} samples, {names[1]} has {b.size}; must be the same number")
    return a, b


def require_finite(signal: Array, name: str) -> Array:
    """Return the signal unchanged, shape (N,), after checking that all of its samples are finite.

    Raises:
        InputError: a sample is NaN or infinite; the error gives the index of the first.
    """
    numbers = np.isfinite(signal)
    if not numbers.all():
        raise InputError(f"{name}: sample {int(np.argmin(numbers))} is not finite; all must be")
    return signal


def require_positive(value: float, name: str) -> float:
    """Return `value` as a float after checking that it is finite and above zero.

    Raises:
        InputError: it is not.
    """
    if not (math.isfinite(value) and value > 0):
        raise InputError(f"{name}: is {value}; must be finite and above 0")
    return float(value)


def ratio(numerator: float, denominator: float) -> float:
    """Return `numerator / denominator`, NaN where the denominator is zero or NaN."""
    return numerator / denominator if abs(denominator) > 0 else math.nan
