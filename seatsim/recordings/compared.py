"""Which part of a recording is compared with a simulation: the channels, the first row, the least signal."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from seatsim.schema.arrays import Array
from seatsim.simulation.respond import SEAT_OUTPUTS

LEFT_OUT = 1.0
"""s; start of each run that is left out of the gap, since the simulation starts from rest and has to settle."""
COMPARED = {"seat": SEAT_OUTPUTS, "damper_bench": SEAT_OUTPUTS[-2:]}
"""Recorded outputs that are compared, by rig."""
LEAST_ROWS = 6
"""Rows that must remain after the seconds left out; a quintic spline through a bench's displacement needs as many."""
NOISE_FACTOR = 3.0
"""A channel is compared where its standard deviation is at least this many times its noise."""


def stands_out(values: Array, noise: float) -> bool:
    """Whether a channel is compared: its standard deviation is at least three times its noise."""
    spread = float(np.std(values)) if values.size else 0.0
    return spread > 0.0 and spread >= NOISE_FACTOR * noise


def select_compared(table: Mapping[str, Array], rig: str, sample_rate: float) -> dict[str, Array]:
    """Return the compared channels of a run without the seconds left out, shape (rows - 1 s,) each."""
    skip = round(LEFT_OUT * sample_rate)
    return {name: table[name][skip:] for name in COMPARED[rig] if name in table}
