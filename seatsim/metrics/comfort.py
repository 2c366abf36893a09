"""How a person feels vibration: figures of ISO 2631-1:1997 (clause 6) and the SEAT factor.

`weighted` is a frequency-weighted acceleration in m/s^2, shape (N,), as `weight` returns it. Each sample
stands for one sampling interval, so a record of N samples lasts T = N / sample_rate. All functions raise
`InputError` where a signal is empty or not one-dimensional, or where a rate or duration is not above 0.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from seatsim.metrics.motion import as_signal, peak, ratio, require_positive, rms
from seatsim.metrics.weighting import weight
from seatsim.schema.arrays import Array

_WINDOW = 1.0
"""Integration time of the running RMS in s (ISO 2631-1:1997, 6.3)."""

EIGHT_HOURS = 8.0 * 3600.0
"""Reference duration of a day's exposure in s (directive 2002/44/EC)."""


def weighted_rms(acceleration: ArrayLike, sample_rate: float, weighting: str = "Wk") -> float:
    """Return a_w = sqrt(1/T integral a_w(t)^2 dt) in m/s^2 (ISO 2631-1:1997, 6.1).

    Args:
        acceleration: not yet weighted, in m/s^2, shape (N,).
        sample_rate: in Hz, at least 200.
        weighting: such as "Wk" for vertical, "Wd" for horizontal vibration; no axis factor (z: 1) is applied.
    """
    return rms(weight(acceleration, sample_rate, weighting))


def running_rms(weighted: ArrayLike, sample_rate: float) -> Array:
    """Return the running RMS in m/s^2, shape (N,), by *linear* integration over the last second.

        a_w(t0) = sqrt(1/tau integral from t0 - tau to t0 of a_w(t)^2 dt),  tau = 1 s

    (ISO 2631-1:1997, 6.3). Other software averages exponentially instead, which gives other figures. The
    rig counts as at rest before the record, so the first second rises from 0.
    """
    x = as_signal(weighted, "weighted")
    width = max(1, round(_WINDOW * require_positive(sample_rate, "sample_rate")))
    # A difference of running sums costs N operations instead of N times the window, but its rounding error
    # can be negative after a shock of 1e9 m/s^2: hence the maximum with zero before the root.
    energy = np.concatenate((np.zeros(width), np.cumsum(x * x)))
    return np.sqrt(np.maximum(energy[width:] - energy[:-width], 0.0) / width)


def mtvv(weighted: ArrayLike, sample_rate: float) -> float:
    """Return MTVV = max_t0 a_w(t0), the largest `running_rms`, in m/s^2 (ISO 2631-1:1997, 6.3)."""
    return float(np.max(running_rms(weighted, sample_rate)))


def vdv(weighted: ArrayLike, sample_rate: float) -> float:
    """Return the vibration dose value (integral a_w(t)^4 dt)^(1/4) in m/s^1.75 (ISO 2631-1:1997, 6.3).

    It grows with the record's length; `daily_vdv` scales it to a day.
    """
    # Two squarings take a seventh of the time of `** 4`, which numpy hands to `pow`.
    fourth = np.square(np.square(as_signal(weighted, "weighted")))
    return math.pow(np.sum(fourth) / require_positive(sample_rate, "sample_rate"), 0.25)


def estimated_vdv(rms_weighted: float, duration: float) -> float:
    """Return eVDV = 1.4 a_w T^(1/4) in m/s^1.75 for `rms_weighted` a_w in m/s^2 over `duration` T in s.

    An estimate for motion without shocks (crest factor below about 6); for stationary Gaussian motion the
    factor is 3^(1/4) = 1.316, for a sine 1.5^(1/4) = 1.107.
    """
    return 1.4 * rms_weighted * math.pow(require_positive(duration, "duration"), 0.25)


def crest_factor(weighted: ArrayLike) -> float:
    """Return max |a_w(t)| / a_w of the weighted signal, dimensionless (ISO 2631-1:1997, 6.2); NaN at rest."""
    return ratio(peak(weighted), rms(weighted))


_CREST_FACTOR, _MTVV_RATIO, _VDV_RATIO = 9.0, 1.5, 1.75
"""Thresholds of the additional evaluation (ISO 2631-1:1997, 6.2.2 and 6.3.3)."""


class Dose(NamedTuple):
    """Whether a_w alone describes a record: doses, and ratios that grow with shocks (ISO 2631-1, 6.2, 6.3).

    A steady sine has a crest factor of 1.414 and ratios of 1 and 1.107; stationary Gaussian motion has a `vdv_ratio`
    of 1.316. `find_shocks` compares them with the standard's thresholds.
    """

    duration: float
    """T in s."""
    rms: float
    """a_w in m/s^2."""
    vdv: float
    """Vibration dose value in m/s^1.75."""
    estimated_vdv: float
    """1.4 a_w T^(1/4) in m/s^1.75."""
    mtvv: float
    """Maximum transient vibration value in m/s^2."""
    crest_factor: float
    """max |a_w(t)| / a_w."""
    mtvv_ratio: float
    """MTVV / a_w."""
    vdv_ratio: float
    """VDV / (a_w T^(1/4))."""


def dose(weighted: ArrayLike, sample_rate: float) -> Dose:
    """Return all dose figures of one weighted record; ratios are NaN at rest.

    Args:
        weighted: frequency-weighted acceleration in m/s^2, shape (N,).
        sample_rate: in Hz, above 0.
    """
    x = as_signal(weighted, "weighted")
    duration = x.size / require_positive(sample_rate, "sample_rate")
    return _dose(duration, rms(x), vdv(x, sample_rate), mtvv(x, sample_rate), peak(x))


def _dose(duration: float, a_w: float, value: float, transient: float, highest: float) -> Dose:
    return Dose(
        duration=duration,
        rms=a_w,
        vdv=value,
        estimated_vdv=estimated_vdv(a_w, duration),
        mtvv=transient,
        crest_factor=ratio(highest, a_w),
        mtvv_ratio=ratio(transient, a_w),
        vdv_ratio=ratio(value, a_w * duration**0.25),
    )


def join_doses(doses: Sequence[Dose]) -> Dose:
    """Return the dose of several stretches of one vibration, as if one followed the other; at least one.

    a_w is energy-equivalent, sqrt(sum a_w^2 T / sum T) (ISO 2631-1:1997, equation B.3), the VDV the fourth root of the
    sum of fourth powers, the MTVV and the peak the largest.
    """
    duration = sum(dose.duration for dose in doses)
    a_w = math.sqrt(sum(dose.rms**2 * dose.duration for dose in doses) / duration)
    highest = max(dose.rms * dose.crest_factor if dose.rms else 0.0 for dose in doses)
    value = math.pow(sum(dose.vdv**4 for dose in doses), 0.25)
    return _dose(duration, a_w, value, max(dose.mtvv for dose in doses), highest)


def find_shocks(dose: Dose) -> list[str]:
    """Return why the basic method, a_w alone, does not suffice for a record; empty where it does.

    A crest factor above 9 asks for the additional evaluation by MTVV or VDV (ISO 2631-1:1997, 6.2.2); these matter for
    the judgement where MTVV / a_w exceeds 1.5 or VDV / (a_w T^(1/4)) exceeds 1.75 (6.3.3; both recalled).
    """
    ratios = {
        "the crest factor": (dose.crest_factor, _CREST_FACTOR),
        "MTVV / a_w": (dose.mtvv_ratio, _MTVV_RATIO),
        "VDV / (a_w T^(1/4))": (dose.vdv_ratio, _VDV_RATIO),
    }
    return [
        f"{name} of {value:.3g} is above {threshold:g}"
        for name, (value, threshold) in ratios.items()
        if value > threshold
    ]


def motion_sickness_dose(rms_weighted: float, duration: float) -> float:
    """Return MSDV_z = sqrt(integral a_w(t)^2 dt) = a_w sqrt(T) in m/s^1.5.

    Args:
        rms_weighted: a_w in m/s^2 of vertical motion weighted with Wf.
        duration: T in s.

    Source: ISO 2631-1:1997, clause 9 and annex D (recalled).
    """
    return rms_weighted * math.sqrt(require_positive(duration, "duration"))


def daily_exposure(rms_weighted: float, exposure: float) -> float:
    """Return A(8) = a_w sqrt(T / 8 h) in m/s^2, the vibration lasting `exposure` T in s a day.

    Directive 2002/44/EC: action is due at 0.5 m/s^2, the limit is 1.15 m/s^2.
    """
    return rms_weighted * math.sqrt(require_positive(exposure, "exposure") / EIGHT_HOURS)


def daily_vdv(value: float, duration: float, exposure: float) -> float:
    """Return VDV (exposure / duration)^(1/4) in m/s^1.75, where `duration` s go on for `exposure` s a day.

    Directive 2002/44/EC: action is due at 9.1 m/s^1.75, the limit is 21 m/s^1.75.
    """
    return value * math.pow(require_positive(exposure, "exposure") / require_positive(duration, "duration"), 0.25)


RUNS = 3
"""Consecutive runs that a test is made of (ISO 10326-1:2016, 10.2.1)."""
SPREAD = 0.05
"""Largest deviation of each of them from their mean, as a share of it (ISO 10326-1:2016, 10.2.1)."""


class SeatTransmission(NamedTuple):
    """SEAT factors along one axis, from the weighted accelerations of several runs."""

    rms: float
    """Mean a_w on the seat over mean a_w at its base (ISO 10326-1:2016, 10.2.2); NaN where the base is at rest."""
    vdv: float
    """Mean VDV on the seat over mean VDV at its base, for motion with shocks (Griffin, Handbook of Human Vibration)."""
    runs: tuple[float, ...]
    """SEAT factor (RMS) of each run."""
    spread: float
    """Largest deviation of a run from the mean, on the seat or at its base, as a share of the mean."""
    within_spread: bool | None
    """Whether at least three runs are within 5 % of their mean; None where there are fewer."""


def seat_transmission(seat: Sequence[Dose], base: Sequence[Dose]) -> SeatTransmission:
    """Return the SEAT factors of runs whose doses on the seat and at its base are given pair by pair, at least one."""
    on_seat, at_base = [dose.rms for dose in seat], [dose.rms for dose in base]
    spread = max(_spread_of(on_seat), _spread_of(at_base))
    return SeatTransmission(
        rms=ratio(sum(on_seat), sum(at_base)),
        vdv=ratio(sum(dose.vdv for dose in seat), sum(dose.vdv for dose in base)),
        runs=tuple(ratio(a, b) for a, b in zip(on_seat, at_base, strict=True)),
        spread=spread,
        within_spread=spread <= SPREAD if len(seat) >= RUNS else None,
    )


def _spread_of(values: Sequence[float]) -> float:
    """Return the largest deviation from the mean of at least one value, as a share of the mean; 0 where that is 0."""
    mean = sum(values) / len(values)
    return max(abs(value - mean) for value in values) / mean if mean > 0 else 0.0
