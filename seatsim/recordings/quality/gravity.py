"""Constants of accelerometers: gravity, which is taken out, and offsets, which are said.

What is shaken about a place has no mean acceleration: a sensor with a mean has an offset, and one whose mean is about
9.81 m/s^2, of either sign, reads gravity, which the equations of motion about static equilibrium do not hold. Left in,
the gravity of the floor's accelerometer would pull the simulated suspension down by decimetres.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from types import MappingProxyType

import numpy as np

from seatsim.recordings.quality.issue import Issue, issue_in_all_runs
from seatsim.recordings.quality.run_under_test import RunUnderTest
from seatsim.recordings.recording import Recording
from seatsim.schema.errors import InputError
from seatsim.schema.units import STANDARD_GRAVITY

NEAR = 0.05
"""Share by which a mean may differ from gravity: tilt of the sensor, error of its scale, and its own offset."""
OFFSET = 0.2
"""m/s^2; mean from which an offset is said: a motion of 24 s that has it ends at 5 m/s."""
DISPLACED = 1.0
"""Mean over half the range from the 1st to the 99th percentile above which a channel hardly passes through zero."""
ABOUT_ZERO = ("suspension_displacement", "displacement", "velocity", "damper_force")
"""Other channels that swing about zero, or not far from it."""
ACCELEROMETERS = ("floor_acceleration", "frame_acceleration", "driver_acceleration")


def without_gravity(recording: Recording) -> Recording:
    """Return the recording whose tables have the mean of each accelerometer that reads gravity taken out.

    It states these constants in `removed`. A table that cannot be read is left to the examination.
    """
    try:
        tables = [recording.table(run) for run in recording.runs]
    except InputError:
        return recording
    means = {
        name: float(np.mean(np.concatenate([table[name] for table in tables])))
        for name in ACCELEROMETERS if name in recording.channels
    }  # fmt: skip
    found = {name: mean for name, mean in means.items() if abs(abs(mean) / STANDARD_GRAVITY - 1.0) <= NEAR}
    return dataclasses.replace(recording, removed=MappingProxyType(found)) if found else recording


def check_constants(runs: Sequence[RunUnderTest]) -> Iterator[Issue]:
    """Say which accelerometers read gravity, which was taken out, and which channels have an offset."""
    for channel, mean in runs[0].recording.removed.items():
        text = f"its mean of {mean:.4g} m/s^2 is gravity, which is taken out; the gap and the diagnosis are without it"
        yield issue_in_all_runs("note", "gravity", text, channel)
    for channel in ACCELEROMETERS:
        if channel in runs[0].table:
            mean = float(np.mean(np.concatenate([run.table[channel] for run in runs])))
            if abs(mean) > OFFSET:
                text = (
                    f"its mean is {mean:.3g} m/s^2, an offset: a seat that stays where it is has no mean acceleration"
                )
                yield issue_in_all_runs("note", "offset", text, channel)
    for channel in ABOUT_ZERO:
        if channel in runs[0].table:
            values = np.concatenate([run.table[channel] for run in runs])
            low, high = np.quantile(values, (0.01, 0.99))
            mean, swing = float(np.mean(values)), 0.5 * float(high - low)
            if abs(mean) > DISPLACED * swing > 0.0:
                unit = runs[0].recording.channels[channel].unit
                text = f"its mean is {mean:.3g} {unit}, {abs(mean) / swing:.0%} of its swing; check the sensor's zero"
                yield issue_in_all_runs("note", "offset", text, channel)
