"""Records that their owner smoothed by a moving average: motion sharpened again, predictions smoothed as they were."""

from __future__ import annotations

import numpy as np

from seatsim.recordings.bench_tables import BenchRecord
from seatsim.schema.arrays import Array

RECOVERED = 0.85
"""Frequency up to which motion is sharpened, over the first one that a moving average removes altogether."""


def smooth(y: Array, rows: int) -> Array:
    """Return the centred moving average of y, shape (N,), over `rows` rows; ends are held."""
    from scipy.ndimage import uniform_filter1d

    return np.asarray(uniform_filter1d(y, rows, mode="nearest"), dtype=float) if rows > 1 else y


def sharpen(record: BenchRecord, rows: int) -> BenchRecord:
    """Return the record with its motion as it was before a centred moving average over `rows` rows.

    Divided by the average's response, `sin(pi f n / r) / (n sin(pi f / r))` at the frequency f and the rate r, up to
    85 % of its first zero r / n; nothing is left above. The record begins and ends at rest, else its ends are wrong.
    The force stays as it is.
    """
    if rows < 2:
        return record
    x, rate = record.displacement, record.rate
    # Mirrored, so that the periodic continuation that a Fourier transform implies has no jump.
    mirrored = np.concatenate([x, x[::-1]])
    frequency = np.fft.rfftfreq(len(mirrored), 1.0 / rate)
    with np.errstate(invalid="ignore", divide="ignore"):
        response = np.sin(np.pi * frequency * rows / rate) / (rows * np.sin(np.pi * frequency / rate))
    response[0] = 1.0  # sin(0) / sin(0) was not a number
    kept = frequency < RECOVERED * rate / rows
    spectrum = np.where(kept, np.fft.rfft(mirrored) / np.where(kept, response, 1.0), 0.0)
    sharp = np.fft.irfft(spectrum, len(mirrored))[: len(x)]
    return record._replace(displacement=sharp, velocity=np.gradient(sharp, 1.0 / rate))
