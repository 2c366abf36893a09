"""What an examination looks at, run by run, and what it finds there."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.recordings.recording import Recording
from seatsim.scenario.scenario import Scenario

Array = NDArray[np.float64]
Table = Mapping[str, Array]
Severity = Literal["error", "warning", "note"]

MOTION = (
    "floor_acceleration", "frame_acceleration", "driver_acceleration", "suspension_displacement", "displacement",
    "velocity", "damper_force",
)  # fmt: skip
LATE = 0.05
"""Seconds by which no channel of a healthy recording is late, and that its rows may lack; a slow coil twice that."""


class Finding(NamedTuple):
    """One thing found; `kind` is a word for it, `channel` and `run` are None where it is about all of them."""

    severity: Severity
    kind: str
    sentence: str
    channel: str | None = None
    run: str | None = None


def at_rest(values: Array, noise: float) -> bool:
    """Say whether values show hardly more than their noise."""
    return float(np.std(values)) <= 3.0 * noise


class Run(NamedTuple):
    """One run under examination: its table, and what the recording says about it."""

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

    def noise(self, channel: str) -> float:
        """Return the stated noise of a channel."""
        return self.recording.channels[channel].noise_rms

    def is_still(self, channel: str) -> bool:
        """Say whether a channel shows hardly more than its noise."""
        return at_rest(self.table[channel], self.noise(channel))

    def finding(self, severity: Severity, kind: str, text: str, channel: str | None = None) -> Finding:
        """Return a finding about this run, or about one channel of it."""
        place = f"{self.name}, {channel}" if channel else self.name
        return Finding(severity, kind, f"{place}: {text}", channel, self.name)


def of_all_runs(severity: Severity, kind: str, text: str, channel: str | None = None) -> Finding:
    """Return a finding about all runs together, or about one channel in all of them."""
    place = f"all runs, {channel}" if channel else "all runs"
    return Finding(severity, kind, f"{place}: {text}", channel)
