"""Figures of motion, force and energy: plain statistics of signals, and what every metric requires of these."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

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


def rms(signal: ArrayLike) -> float:
    """Return sqrt(mean(x^2)), about zero, in the unit of the signal, shape (N,); NaN where a sample is NaN.

    Raises:
        InputError: the signal is empty or not one-dimensional.
    """
    x = as_signal(signal)
    return math.sqrt(np.mean(np.square(x)))


def peak(signal: ArrayLike) -> float:
    """Return max |x| in the unit of the signal, shape (N,); NaN where a sample is NaN.

    Raises:
        InputError: the signal is empty or not one-dimensional.
    """
    x = as_signal(signal)
    # Both extremes in place of `abs`, which would copy a signal of a million samples.
    return float(max(np.max(x), -np.min(x)))


def end_stop_hits(displacement: ArrayLike, travel: tuple[float, float]) -> int:
    """Count the separate excursions beyond the travel, on either side.

    A hit starts with a sample beyond a limit whose predecessor is not beyond the same limit: staying there is
    one hit, coming back and leaving again is another. A record that starts beyond a limit starts with a hit.

    Args:
        displacement: suspension displacement in m, shape (N,).
        travel: (low, high) in m, low < high; reaching a limit exactly is no hit.

    Raises:
        InputError: `low` is not below `high`, or the displacement is no signal.
    """
    x = as_signal(displacement, "displacement")
    low, high = travel
    if not low < high:
        raise InputError(f"travel: is ({low}, {high}); the first limit must be below the second")
    return _entries(x < low) + _entries(x > high)


def _entries(inside: NDArray[np.bool_]) -> int:
    """Return how often a condition becomes true, the first sample included."""
    return int(inside[0]) + int(np.count_nonzero(inside[1:] & ~inside[:-1]))


def force_tracking_error(wanted: ArrayLike, delivered: ArrayLike) -> tuple[float, float]:
    """Return rms(wanted - delivered) in N, and the same over rms(wanted).

    Samples without a wanted force (NaN) are left out. Both figures are NaN where no force is wanted at all,
    the relative one also where the wanted force is zero throughout.

    Args:
        wanted: force the law asks for in N, shape (N,), NaN where it asks for none.
        delivered: damper force in N, same shape and sign (positive opposes extension).

    Raises:
        InputError: the shapes differ, or one is no signal.
    """
    want, got = as_pair(wanted, delivered, ("wanted", "delivered"))
    asked = ~np.isnan(want)
    if not asked.any():
        return math.nan, math.nan
    error = rms((want - got)[asked])
    return error, ratio(error, rms(want[asked]))


def electrical_energy(current: ArrayLike, resistance: float, sample_rate: float) -> float:
    """Return the heat of the coil, integral of R i^2 dt by the trapezoidal rule, in J.

    Constant resistance: what the coil gains by warming up is not counted, nor are losses of the driver stage.

    Args:
        current: coil current in A, shape (N,).
        resistance: of the coil in ohm, above 0.
        sample_rate: in Hz, above 0.

    Raises:
        InputError: resistance or sample rate is not above 0, or the current is no signal.
    """
    i = as_signal(current, "current")
    step = 1 / require_positive(sample_rate, "sample_rate")
    return require_positive(resistance, "resistance") * float(np.trapezoid(i * i, dx=step))


def energy_residual(supplied: ArrayLike, parts: Sequence[ArrayLike]) -> float:
    """Return how badly an energy balance closes, relative and not negative.

    With every energy counted from its first sample,

        residual = max_t |supplied - sum(parts)| / max_t max(|supplied|, |part_1|, |part_2|, ...)

    and 0 where no energy moves at all.

    Args:
        supplied: energy fed in since the start in J, shape (N,).
        parts: energies dissipated or stored in J, each of the same shape.

    Raises:
        InputError: the shapes differ, or one is no signal.
    """
    whole = as_signal(supplied, "supplied")
    used = [as_pair(part, whole, ("part", "supplied"))[0] for part in parts]
    changes = [energy - energy[0] for energy in (whole, *used)]
    scale = max(peak(change) for change in changes)
    return peak(changes[0] - sum(changes[1:])) / scale if scale != 0 else 0.0
