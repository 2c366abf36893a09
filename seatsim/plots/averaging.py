"""Spectra averaged over bands of equal width on a logarithmic axis."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from seatsim.schema.arrays import Array


def average_bands(
    frequency: Array, power: Array, lowest: float, per_octave: int
) -> tuple[Array, Array, NDArray[np.int64]]:
    """Return mean frequency, mean density and number of lines of bands of equal width on a logarithmic axis."""
    inside = frequency >= lowest
    band = np.floor(per_octave * np.log2(frequency[inside] / lowest)).astype(int)
    _, index, count = np.unique(band, return_inverse=True, return_counts=True)
    return np.bincount(index, frequency[inside]) / count, np.bincount(index, power[inside]) / count, count
