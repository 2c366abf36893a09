"""What of a recording is compared with a simulation: which channels, from which row on, above which noise."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
LEFT_OUT = 1.0
"""Seconds at the start of each run that no gap counts."""
COMPARED = {
    "seat": (
        "frame_acceleration", "driver_acceleration", "suspension_displacement", "damper_force", "coil_current",
    ),
    "damper_bench": ("damper_force", "coil_current"),
}  # fmt: skip
"""Recorded outputs that are compared, by rig."""
LEAST_ROWS = 6
"""Rows that must remain after the seconds left out."""
NOISE_FACTOR = 3.0
"""A channel is compared where its standard deviation is at least this many times its noise."""


def stands_out(values: Array, noise: float) -> bool:
    """Whether a channel is compared: its standard deviation is at least three times its noise."""
    spread = float(np.std(values)) if values.size else 0.0
    return spread > 0.0 and spread >= NOISE_FACTOR * noise
