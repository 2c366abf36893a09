"""A run under examination: its table, and the statements of its recording about it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from seatsim.recordings.quality.issue import Issue, Severity
from seatsim.recordings.quality.shapes import flickers, quantum
from seatsim.recordings.recording import Recording
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array

Table = Mapping[str, Array]

MOTION = (
    "floor_acceleration", "frame_acceleration", "driver_acceleration", "suspension_displacement", "displacement",
    "velocity", "damper_force",
)  # fmt: skip
"""Channels of motion and force, which swing about zero and are never at rest for long."""
LATE = 0.05
"""s; least delay of a channel that is a fault of the data, and largest loss of rows; a slow coil may be twice as late.

A smaller delay of a sensor or logger is a cause of a gap (sensor.lag, sensor.clock_skew) for the diagnosis to find.
"""
AT_REST = 3.0
"""Standard deviation, over the stated noise, up to which a channel is taken to be at rest: noise is stated roughly."""


def is_at_rest(values: Array, noise: float) -> bool:
    """Say whether values show hardly more than their noise."""
    return float(np.std(values)) <= AT_REST * noise


class RunUnderTest(NamedTuple):
    """One run under examination: its table, and the statements of the recording about it."""

    name: str
    table: Table
    recording: Recording
    nominal: Scenario

    @property
    def rate(self) -> float:
        """Rows per second."""
        return self.recording.header.sample_rate

    @property
    def rows(self) -> int:
        """Rows of the table."""
        return len(next(iter(self.table.values())))

    @property
    def driver(self) -> str:
        """Channel of the excitation."""
        return "floor_acceleration" if "floor_acceleration" in self.table else "displacement"

    @property
    def opposes_command(self) -> bool:
        """Whether the coil current falls where its command rises."""
        commands = [self.table[name] for name in ("current_command", "command_voltage") if name in self.table]
        coil = self.table["coil_current"]
        return any(float(np.cov(coil, each)[0, 1]) < -0.5 * np.std(coil) * np.std(each) for each in commands)

    def noise(self, channel: str) -> float:
        """Return the stated noise of a channel."""
        return self.recording.channels[channel].noise_rms

    def is_still(self, channel: str) -> bool:
        """Say whether a channel shows hardly more than its noise."""
        return is_at_rest(self.table[channel], self.noise(channel))

    def is_fine(self, channel: str) -> bool:
        """Say whether the noise of a channel, stated and seen, exceeds its resolution: it then changes at each row."""
        values = self.table[channel]
        return self.noise(channel) > quantum(values) and flickers(values, self.rate)

    def issue(self, severity: Severity, kind: str, text: str, channel: str | None = None) -> Issue:
        """Return an issue of this run, or of one channel of it."""
        place = f"{self.name}, {channel}" if channel else self.name
        return Issue(severity, kind, f"{place}: {text}", channel, self.name)
