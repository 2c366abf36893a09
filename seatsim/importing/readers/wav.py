"""WAV files of recorders and analysers, read by scipy: shares of a full scale that the file does not state."""

from __future__ import annotations

import io
import warnings
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.io import wavfile

from seatsim.importing.readers.reading import TextLayout
from seatsim.importing.signals import DataFile, Group, Signal
from seatsim.schema.arrays import Array

_UNSIGNED_ZERO = 128.0
"""What samples of 8 bits, which alone are unsigned, have at rest."""


def read(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the channels, in the order of the file; integers become shares of the full scale, -1 to 1."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", wavfile.WavFileWarning)  # of parts that hold no samples
        warnings.filterwarnings("error", "Reached EOF", wavfile.WavFileWarning)
        rate, samples = wavfile.read(io.BytesIO(content))
    columns = _scale(samples.reshape(len(samples), -1))
    signals = tuple(Signal(f"channel_{k + 1}", "", column) for k, column in enumerate(columns.T))
    note = "a WAV file states neither names nor units: state unit and scale, the value at full scale, in the map"
    return DataFile(path, "", (Group(path.stem, signals, float(rate)),), (note,))


def _scale(samples: NDArray[np.generic]) -> Array:
    """Return samples as shares of the full scale; those of 24 bits fill the upper part of 32."""
    values = samples.astype(np.float64)
    if samples.dtype.kind == "u":
        return (values - _UNSIGNED_ZERO) / _UNSIGNED_ZERO
    return values / 2.0 ** (8 * samples.dtype.itemsize - 1) if samples.dtype.kind == "i" else values
