"""Effects of the floor: excitation that no channel records."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np

from seatsim.effects.base import effect
from seatsim.schema.arrays import Array
from seatsim.schema.fields import param


@effect(
    "floor.unmeasured_input",
    source="a random force of flat spectrum in a band, and a tone",
    off={"low": 0.5, "high": 20.0, "frequency": 10.0},
)
class UnmeasuredInput(NamedTuple):
    """A force on the frame that no channel records: random between two frequencies, and a tone.

    A recording determines its spectrum only; the random part is drawn from the scenario's seed.
    """

    rms: Annotated[float, param("N", "RMS of the random force", low=0, high=1e5)]
    low: Annotated[float, param("Hz", "lowest frequency of the random force", above=0, high=1e3)] = 0.5
    high: Annotated[float, param("Hz", "highest frequency of the random force", above=0, high=1e3)] = 20.0
    tone: Annotated[float, param("N", "amplitude of the tone", low=0, high=1e5)] = 0.0
    frequency: Annotated[float, param("Hz", "frequency of the tone", above=0, high=1e3)] = 10.0
    phase: Annotated[float, param("rad", "phase of the tone at time zero", low=-10, high=10)] = 0.0

    def frame_force(self, time: Array, seed: int) -> Array:
        """Return the force on the frame in N at times of equal distance in s, shape (N,)."""
        steady = self.tone * np.sin(2.0 * math.pi * self.frequency * time + self.phase)
        if self.rms <= 0.0 or len(time) < 2:
            return steady
        spectrum = np.fft.rfft(np.random.default_rng(seed).standard_normal(len(time)))
        frequency = np.fft.rfftfreq(len(time), time[1] - time[0])
        noise = np.fft.irfft(np.where((frequency >= self.low) & (frequency <= self.high), spectrum, 0.0), len(time))
        spread = float(np.std(noise))
        return steady + (self.rms / spread * noise if spread > 0.0 else 0.0)
