"""A recorded run as excitation: its floor motion, its command or current, its temperature."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from seatsim.excitations.base import Floor, excitation
from seatsim.recordings.recording import load_recording
from seatsim.schema.arrays import Array
from seatsim.schema.bounds import check_steps
from seatsim.schema.errors import InputError

_CORNER = 0.05
"""Hz; below it the floor velocity, an integral of a measured acceleration, is attenuated as unreliable."""


@excitation("recording")
class RecordedRun(NamedTuple):
    """A run of a recording: floor acceleration linear between rows, command constant from its row until the next.

    Coil current and temperature are linear between rows. The floor's velocity and displacement are leaky integrals of
    its acceleration (corner 0.05 Hz). `path` is the recording's folder, `run` the run's name; both are filled in where
    a scenario is replayed against a recording.
    """

    path: str = ""
    run: str = ""

    def floor(self, step: float, seed: int) -> Floor:
        """Return the motion of the floor and the recorded inputs, sampled every `step` seconds from row 0.

        Raises:
            InputError: the recording cannot be read, or its row interval is not a multiple of `step`.
        """
        if not (self.path and self.run):
            raise InputError(
                "excitation: a recording needs 'path' (its folder) and 'run'; state both, or replay the scenario with"
                " 'seatsim gap SCENARIO RECORDING'"
            )
        recording = load_recording(self.path)
        table = recording.table(self.run)
        interval = 1.0 / recording.header.sample_rate
        parts = round(interval / step)
        if parts < 1 or abs(parts * step - interval) > 1e-6 * interval:
            best = interval / max(1, math.ceil(interval / step - 1e-9))
            raise InputError(
                f"{self.path}: rows every {interval:g} s are no multiple of solver.step {step:g}; set it to {best:.9g}"
            )
        return interpolate_floor(table, parts, step)


def interpolate_floor(table: Mapping[str, Array], parts: int, step: float) -> Floor:
    """Return the recorded inputs of a seat, sampled every `step` seconds, `parts` of which are a row of the table."""
    check_steps(float(parts) * len(table["floor_acceleration"]))
    floor, command = _linear(table["floor_acceleration"], parts), table.get("current_command")
    velocity = _leaky_integral(floor, step)
    finer = {name: _linear(table[name], parts) for name in ("coil_current", "damper_temperature") if name in table}
    return Floor(
        step,
        floor,
        velocity,
        _leaky_integral(velocity, step),
        None if command is None else np.append(np.repeat(command[:-1], parts), command[-1]),
        finer.get("coil_current"),
        finer.get("damper_temperature"),
    )


def _linear(values: Array, parts: int) -> Array:
    """Return the values with `parts - 1` linearly interpolated ones between each pair."""
    rows = np.arange(len(values))
    return np.interp(np.arange((len(values) - 1) * parts + 1) / parts, rows, values)


def _leaky_integral(values: Array, step: float) -> Array:
    """Return the integral with a memory of 1 / (2 pi _CORNER) seconds, by the trapezoidal rule."""
    from scipy.signal import lfilter

    leak = math.pi * _CORNER * step
    gain = 0.5 * step / (1 + leak)
    result: Array = lfilter([gain, gain], [1.0, -(1 - leak) / (1 + leak)], values)
    return result
