"""The driver's figures of many runs at once, on the processor or on the device that holds their accelerations."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import numpy as np

from seatsim.metrics.comfort import WINDOW
from seatsim.metrics.weighting import can_weight, transform_of


def measure_drivers(acceleration: Any, step: float, arrays: ModuleType = np) -> dict[str, Any]:
    """Return the metrics of L drivers by name, shape (L,) each: those of `seatsim.metrics.METRICS` but for rounding.

    Args:
        acceleration: of the drivers in m/s^2, shape (N, L).
        step: time between samples in s.
        arrays: numpy, or a module with its functions, such as cupy, to which `acceleration` belongs.

    Without the weighted figures where the sample rate is too low for the weighting; a driver whose acceleration is not
    finite has figures that are not either.
    """
    a = arrays.ascontiguousarray(acceleration.T)
    rate, samples = 1.0 / step, a.shape[1]
    found = {"driver_acceleration_rms": _rms(a, arrays), "driver_acceleration_peak": arrays.abs(a).max(axis=1)}
    if samples > 1:
        found["driver_jerk_rms"] = _rms(arrays.diff(a, axis=1) * rate, arrays)
    if not can_weight(rate):
        return found
    response, size = transform_of(samples, rate)
    weighted = arrays.fft.irfft(arrays.fft.rfft(a, size) * arrays.asarray(response), size)[:, :samples]
    rms, square = _rms(weighted, arrays), arrays.square(weighted)
    width = max(1, round(WINDOW * rate))
    energy = arrays.cumsum(square, axis=1)
    if width < samples:
        # The rig counts as at rest before the record: the first second is no difference.
        energy[:, width:] -= energy[:, :-width].copy()
    return found | {
        "driver_acceleration_weighted": rms,
        "driver_vdv": (arrays.square(square).sum(axis=1) / rate) ** 0.25,
        "driver_mtvv": arrays.sqrt(arrays.maximum(energy, 0.0).max(axis=1) / width),
        "driver_crest_factor": arrays.abs(weighted).max(axis=1) / arrays.where(rms > 0.0, rms, np.nan),
    }


def _rms(signals: Any, arrays: ModuleType) -> Any:
    return arrays.sqrt(arrays.square(signals).mean(axis=1))
