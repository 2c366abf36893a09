"""Frequency weightings of ISO 2631-1:1997, Annex A, and the others of ISO 8041-1:2017.

With s = 2j pi f and w_k = 2 pi f_k, a weighting is the product of a high-pass, a low-pass, an
acceleration-velocity transition and an upward step; a corner at infinity makes its factor 1:

    H(s)  = Hh(s) Hl(s) Ht(s) Hs(s)
    Hh(s) = s^2 / (s^2 + sqrt(2) w1 s + w1^2)
    Hl(s) = 1 / (1 + sqrt(2) s/w2 + (s/w2)^2)
    Ht(s) = K (1 + s/w3) / (1 + s/(Q4 w4) + (s/w4)^2)
    Hs(s) = (w5/w6)^2 (1 + s/(Q5 w5) + (s/w5)^2) / (1 + s/(Q6 w6) + (s/w6)^2)

A sampled record is weighted by multiplying its spectrum with H itself. The usual bilinear filter squeezes all
frequencies below the Nyquist one: at 500 Hz it is 14 % low at 80 Hz, and 6 % with its low-pass prewarped.
"""

from __future__ import annotations

import math
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import fft

from seatsim.metrics.motion import as_signal, require_finite, require_positive
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError, permit
from seatsim.schema.fields import read_packaged

ComplexArray = NDArray[np.complex128]

_DECAY = 4.8
"""Zeros behind a record in periods of the high-pass: its poles, the slowest, have died down to 1e-9 by then."""


class _UpwardStep(NamedTuple):
    """Upward step: corner frequencies in Hz and their quality factors."""

    f5: float
    Q5: float
    f6: float
    Q6: float


class Weighting(NamedTuple):
    """Constants of one weighting (ISO 8041-1:2017, Table 3): frequencies in Hz, quality factor, gain K."""

    f1: float
    f2: float
    f3: float
    f4: float
    Q4: float
    step: _UpwardStep | None = None
    K: float = 1.0


WEIGHTINGS = read_packaged(Path(__file__).with_name("weightings.yaml"), dict[str, Weighting])
"""All weightings by name."""


class _SecondOrderSection(NamedTuple):
    """A factor of a weighting, `(b0 + b1 s + b2 s^2) / (a0 + a1 s + a2 s^2)` with s in rad/s."""

    numerator: tuple[float, float, float]
    denominator: tuple[float, float, float]


def sections(weighting: str = "Wk") -> tuple[_SecondOrderSection, ...]:
    """Return the factors Hh, Hl, Ht and, where the weighting has one, Hs, for filters with states.

    Raises:
        InputError: no weighting has this name.
    """
    c = _constants(weighting)
    high_pass = _SecondOrderSection((0.0, 0.0, (2 * math.pi * c.f1) ** -2), _coefficients(c.f1, math.sqrt(0.5)))
    low_pass = _SecondOrderSection((1.0, 0.0, 0.0), _coefficients(c.f2, math.sqrt(0.5)))
    transition = _SecondOrderSection((c.K, c.K / (2 * math.pi * c.f3), 0.0), _coefficients(c.f4, c.Q4))
    if c.step is None:
        return high_pass, low_pass, transition
    rise = (c.step.f5 / c.step.f6) ** 2
    b0, b1, b2 = _coefficients(c.step.f5, c.step.Q5)
    return (
        high_pass,
        low_pass,
        transition,
        _SecondOrderSection((rise * b0, rise * b1, rise * b2), _coefficients(c.step.f6, c.step.Q6)),
    )


def _coefficients(corner: float, quality: float) -> tuple[float, float, float]:
    """Return the coefficients of 1 + s/(Q w) + (s/w)^2 in rising powers of s, with w = 2 pi `corner`."""
    omega = 2 * math.pi * corner
    return 1.0, 1 / (quality * omega), omega**-2


def frequency_response(frequency: ArrayLike, weighting: str = "Wk") -> ComplexArray:
    """Return H(2j pi f), dimensionless, at each `frequency` in Hz; same shape as `frequency`.

    Raises:
        InputError: no weighting has this name.
    """
    c = _constants(weighting)
    jf = np.asarray(frequency, dtype=np.complex128) * 1j
    high_pass = jf**2 / (jf**2 + math.sqrt(2) * c.f1 * jf + c.f1**2)
    low_pass = 1 / quadratic(jf, c.f2, math.sqrt(0.5))
    transition = (1 + jf / c.f3) / quadratic(jf, c.f4, c.Q4)
    step: ComplexArray | float = 1.0
    if c.step:
        rise = quadratic(jf, c.step.f5, c.step.Q5) / quadratic(jf, c.step.f6, c.step.Q6)
        step = rise * (c.step.f5 / c.step.f6) ** 2
    h: ComplexArray = high_pass * low_pass * transition * step * c.K
    return h


def _constants(weighting: str) -> Weighting:
    if weighting not in WEIGHTINGS:
        raise InputError(f"no weighting is called '{weighting}'{permit(weighting, WEIGHTINGS)}")
    return WEIGHTINGS[weighting]


def quadratic(jf: ComplexArray, corner: float, quality: float) -> ComplexArray:
    """Return 1 + s/(Q w) + (s/w)^2 at s = 2 pi jf, w = 2 pi `corner`: the factors 2 pi cancel."""
    u: ComplexArray = jf / corner
    return 1 + u / quality + u * u


def weight(signal: ArrayLike, sample_rate: float, weighting: str = "Wk") -> Array:
    """Return the frequency-weighted signal, shape (N,), in the unit of the signal.

    y = F^-1[H(f) F[x](f)], the record being zero before its first sample and followed by so many zeros that
    nothing wraps round. Gain and phase are those of `frequency_response` at every frequency below `sample_rate / 2`.

    Being band-limited, the filter is causal but for a faint ringing: for a few samples ahead of a one-sample
    pulse the output of Wk reaches 0.2 % of its peak at 1 kHz, 0.5 % at 500 Hz, 2.6 % at 200 Hz. It suits finished
    records, not control. Like the analog filter it takes about one period of its high-pass (2 s; Wf 12 s) to forget an
    offset at the start of the record.

    Args:
        signal: acceleration, shape (N,), finite.
        sample_rate: in Hz, at least twice the upper corner of the weighting: 200, for Wf 1.26, for Wh 2518.
        weighting: a name of `WEIGHTINGS`.

    Raises:
        InputError: a sample is not finite, the sample rate is too low, or no weighting has this name.
    """
    x = require_finite(as_signal(signal), "signal")
    constants = _constants(weighting)
    if not can_weight(sample_rate, weighting):
        raise InputError(
            f"sample_rate: is {sample_rate} Hz; weighting {weighting} reaches {constants.f2:.4g} Hz and needs "
            f"{least_rate(weighting):.4g} Hz or more"
        )
    # The product of transforms is a circular convolution: zeros behind the record keep its end out of its start.
    size = fft.next_fast_len(x.size + math.ceil(_DECAY / constants.f1 * sample_rate), real=True)
    weighted: Array = fft.irfft(fft.rfft(x, size) * _response_at_bins(size, float(sample_rate), weighting), size)
    return weighted[: x.size]


def least_rate(weighting: str = "Wk") -> float:
    """Return the lowest sample rate in Hz: the band, which ends at the corner f2, must lie below half of it."""
    return 2 * _constants(weighting).f2


def can_weight(sample_rate: float, weighting: str = "Wk") -> bool:
    """Tell whether a record at this `sample_rate` (Hz) can be weighted; rounding of the rate is forgiven."""
    return require_positive(sample_rate, "sample_rate") >= least_rate(weighting) * (1 - 1e-6)


@lru_cache(maxsize=4)
def _response_at_bins(size: int, sample_rate: float, weighting: str) -> ComplexArray:
    """Return the response at the bins of a transform of `size` samples; kept, as records of a study have one length."""
    return frequency_response(fft.rfftfreq(size, 1 / sample_rate), weighting)
