"""What the time loop keeps of a run: rows of channels here, sums in `seatsim.kernel.sums`.

A recorder is a record whose methods the loop calls at every sample. What it gathers in numbers is passed from sample to
sample as `kept`, and returned at the end of the run.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from seatsim.kernel import channels
from seatsim.kernel.hooks import hook
from seatsim.kernel.inverse import CELLS
from seatsim.kernel.rig import Rig
from seatsim.kernel.step import IntegratorState
from seatsim.rig.state import (
    CUSHION_DISPLACEMENT,
    CUSHION_VELOCITY,
    CUSHION_WORK,
    DAMPER_WORK,
    DISPLACEMENT,
    FLOOR_WORK,
    SUSPENSION_WORK,
    VELOCITY,
    State,
)
from seatsim.schema.arrays import Array


class Sample(NamedTuple):
    """What is known at a sample beside the state of the rig: in m/s^2, N (NaN: no force is wanted), A and degC."""

    floor: float
    wanted: float
    served: float
    current: float
    command: float
    temperature: float


class Recorder(Protocol):
    """What the loop asks of a recorder."""

    @property
    def room(self) -> Array:
        """Room for the inverse, shape (CELLS + 1,)."""

    def nothing(self) -> State:
        """Return what is kept before the first sample."""

    def keep(self, kept: State, rig: Rig, k: int, now: IntegratorState, sample: Sample) -> State:
        """Return what is kept after sample `k`."""

    def command_at(self, k: int) -> float:
        """Return the command in A of an earlier sample, as far back as the coil's delay reaches."""


class Rows(NamedTuple):
    """Keeps every channel of every sample in a row of `out`, shape (N, len(CHANNELS))."""

    out: Array
    room: Array

    def nothing(self) -> State:
        """Return nothing: all is in the rows."""
        return ()

    def keep(self, kept: State, rig: Rig, k: int, now: IntegratorState, sample: Sample) -> State:
        """Write sample `k` into its row."""
        s, row = now.state, self.out[k]
        row[channels.FLOOR_ACCELERATION] = sample.floor
        row[channels.FRAME_ACCELERATION] = now.rates[VELOCITY] + sample.floor
        row[channels.DRIVER_ACCELERATION] = now.rates[VELOCITY] + sample.floor + now.rates[CUSHION_VELOCITY]
        row[channels.SUSPENSION_DISPLACEMENT] = s[DISPLACEMENT]
        row[channels.SUSPENSION_VELOCITY] = s[VELOCITY]
        row[channels.CUSHION_DISPLACEMENT] = s[CUSHION_DISPLACEMENT]
        row[channels.CUSHION_VELOCITY] = s[CUSHION_VELOCITY]
        row[channels.DAMPER_FORCE] = now.forces.damper_force
        row[channels.WANTED_FORCE] = sample.wanted
        row[channels.FORCE_SERVED] = sample.served
        row[channels.COIL_CURRENT] = sample.current
        row[channels.CURRENT_COMMAND] = sample.command
        row[channels.DAMPER_TEMPERATURE] = sample.temperature
        row[channels.ENERGY_FLOOR] = s[FLOOR_WORK]
        row[channels.ENERGY_DAMPER] = s[DAMPER_WORK]
        row[channels.ENERGY_SUSPENSION] = s[SUSPENSION_WORK]
        row[channels.ENERGY_CUSHION] = s[CUSHION_WORK]
        return kept

    def command_at(self, k: int) -> float:
        """Return the command of a row."""
        command: float = self.out[k, channels.CURRENT_COMMAND]
        return command


def keep_rows(out: Array) -> Rows:
    """Return what keeps every channel in `out`, with its room for the inverse."""
    return Rows(out, np.empty(CELLS + 1))


nothing = hook(Recorder.nothing)
keep = hook(Recorder.keep)
command_at = hook(Recorder.command_at)
