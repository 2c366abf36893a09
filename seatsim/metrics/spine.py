"""What vertical shocks on the seat do to the lumbar spine: dose, stress and risk of ISO 2631-5:2018.

All constants and clauses are read in the source of phonometry 3.3.0 (`phonometry.vibration`), not in the standard. All
functions raise `InputError` where a signal is empty, not one-dimensional or not finite, or where a rate or duration is
not above 0.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy import fft

from seatsim.metrics.motion import as_signal, require_finite, require_positive
from seatsim.metrics.weighting import ComplexArray, quadratic
from seatsim.schema.arrays import Array

_ZERO = (34.0, 0.35)
_POLES = ((31.0, 0.21), (230.0, 0.88), (260.0, 0.80), (320.0, 0.40), (380.0, 0.75), (420.0, 0.65))
"""Natural frequency in rad/s and damping ratio of each quadratic of the transfer function (5.2, formula 1)."""
_DECAY = 5.0
"""s of zeros behind a record: the slowest pole, 6.5 1/s, is at rounding error by then."""
_FACTOR, _EXPONENT = 1.07, 6
"""Factor on the peaks and exponent of fatigue (5.3, formula 3)."""
_GRAVITY = 9.81
_STRENGTH = 6.75
"""MPa; ultimate strength of the lumbar spine, extrapolated to age 0 (annex C, formula C.4)."""
_AGES, _DAYS = range(20, 65), 240.0
"""Working life for which a risk is stated: years of age, and days a year with such an exposure."""


class _Person(NamedTuple):
    """`stress` in MPa per m/s^2, `ageing` in MPa/year, `scale` and `shape` of the risk (C.2, C.4, table C.1)."""

    stress: float
    ageing: float
    scale: float
    shape: float


_PEOPLE = {"man": _Person(0.029, 0.052, 1.613, 2.799), "woman": _Person(0.025, 0.039, 0.959, 3.709)}


class SpinalRisk(NamedTuple):
    """Consequence of a daily dose for a person: daily stress in MPa, its sum R over a working life, and risk of injury.

    The working life is from 20 to 64 years of age, with 240 days of such exposure a year.
    """

    stress: float
    factor: float
    probability: float


class SpinalLoad(NamedTuple):
    """Dose D_z of a record and daily dose D_zd in m/s^2, and the risk of a man and a woman (ISO 2631-5:2018)."""

    dose: float
    daily_dose: float
    risks: Mapping[str, SpinalRisk]


def spine_transfer(frequency: ArrayLike) -> ComplexArray:
    """Return the transfer function from the seat's vertical acceleration to the lumbar spine's, at frequencies in Hz.

    H = (1 + 2 zeta_0 s / w_0 + (s / w_0)^2) / prod over k of (1 + 2 zeta_k s / w_k + (s / w_k)^2),   s = 2 pi j f

    Source: ISO 2631-5:2018, 5.2, formula 1 (read in phonometry 3.3.0).
    """
    s = 2j * np.pi * np.asarray(frequency, dtype=float)
    response: ComplexArray = _mode(s, *_ZERO) / np.prod([_mode(s, *pole) for pole in _POLES], axis=0)
    return response


def _mode(s: ComplexArray, corner: float, damping: float) -> ComplexArray:
    return quadratic(s, corner, 0.5 / damping)


def spine_response(acceleration: ArrayLike, sample_rate: float) -> Array:
    """Return the vertical acceleration of the lumbar spine in m/s^2, shape (N,).

    Args:
        acceleration: on the seat in m/s^2 without its mean (the transfer function is 1 at 0 Hz), shape (N,).
        sample_rate: in Hz; ISO 2631-5 is on shocks up to 80 Hz, so 200 and more.
    """
    x = require_finite(as_signal(acceleration), "acceleration")
    rate = require_positive(sample_rate, "sample_rate")
    size = fft.next_fast_len(x.size + math.ceil(_DECAY * rate), real=True)
    response: Array = fft.irfft(fft.rfft(x, size) * spine_transfer(fft.rfftfreq(size, 1.0 / rate)), size)
    return response[: x.size]


def spinal_dose(response: ArrayLike) -> float:
    """Return D_z = 1.07 (sum of A_i^6)^(1/6) in m/s^2; A_i is the largest value of each stretch above zero.

    Args:
        response: acceleration of the lumbar spine in m/s^2, shape (N,), from `spine_response`.

    Source: ISO 2631-5:2018, 5.3, formula 3 (read in phonometry 3.3.0).
    """
    x = as_signal(response)
    begins = np.flatnonzero(np.diff(np.concatenate([[False], x > 0]).astype(int)) > 0)
    peaks = np.maximum.reduceat(x, begins) if begins.size else np.zeros(1)
    return _FACTOR * float(np.linalg.norm(peaks, _EXPONENT))


def join_spinal_doses(doses: ArrayLike, times: ArrayLike = 1.0) -> float:
    """Return (sum of D_j^6 t_j)^(1/6): with `times` exposure over measurement, each, the daily dose of all together.

    Source: ISO 2631-5:2018, 5.3, formulas 4 and 5 (read in phonometry 3.3.0).
    """
    return float(np.sum(np.asarray(doses) ** _EXPONENT * np.asarray(times)) ** (1 / _EXPONENT))


def assess_spine(daily_dose: float) -> dict[str, SpinalRisk]:
    """Return the consequence of a daily dose in m/s^2 for a man and for a woman.

    S_d = m_z D_zd,   R = (sum over years of (S_d N^(1/6) / (6.75 - ageing age - 9.81 m_z))^6)^(1/6),
    P = 1 - exp(-(R / scale)^shape)

    Source: ISO 2631-5:2018, annex C, formulas C.1 to C.5 (read in phonometry 3.3.0).
    """
    return {name: _assess(person, daily_dose) for name, person in _PEOPLE.items()}


def _assess(person: _Person, daily_dose: float) -> SpinalRisk:
    stress = person.stress * daily_dose
    strength = _STRENGTH - person.ageing * np.array(_AGES) - person.stress * _GRAVITY
    factor = join_spinal_doses(stress / strength, _DAYS)
    return SpinalRisk(stress, factor, 1.0 - math.exp(-((factor / person.scale) ** person.shape)))
