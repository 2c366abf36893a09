"""One rig under test and its protocol: what a run is, with or without faults, and what its channels read."""

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.signal import bilinear, lfilter, lfilter_zi

from seatsim.blind.truth.excitation import NoiseColour, coloured_noise, frame_force
from seatsim.blind.truth.faults import NEIGHBOUR, Changes, FrameForce, SensorFault
from seatsim.blind.truth.rig import EXCITATION_RATE, INTEGRATION_STEP, SAMPLE_RATE, Inputs, RigMotion, simulate
from seatsim.blind.truth.state import parameter_record
from seatsim.schema.arrays import Array
from seatsim.schema.fields import read_packaged

Readings = dict[str, Array]
"""What each channel reads in a run, shape (rows,) each."""
_ROUNDING = 1e-6
"""Of a row: a time that lies on a row but for rounding counts as that row."""
_EVEN_RUN_DRIFT = 0.6
"""Share of the clock's drift in runs of even number: a fault that is the same in all runs is easier to find."""


def read_sensors(motion: RigMotion, floor: Array, faults: Iterable[SensorFault], run: int) -> Readings:
    """Return what each channel reads, without noise; `floor` is the run's acceleration at 2 kHz, m/s^2."""
    time = np.arange(motion.frame.size) / motion.sample_rate
    floor_at_rows = np.interp(time * EXCITATION_RATE, np.arange(floor.size), floor)
    true = dict(zip(CHANNELS, (floor_at_rows, *motion[:7]), strict=True))
    read = {name: values.copy() for name, values in true.items()}
    for fault in faults:
        if fault.kind == "skew":
            read["current_command"], read["coil_current"] = _read_late_log(motion, fault, run)
        else:
            other = true[NEIGHBOUR[fault.channel]]
            read[fault.channel] = apply_fault(read[fault.channel], other, fault, run, motion.sample_rate)
    return read


def _read_late_log(motion: RigMotion, fault: SensorFault, run: int) -> tuple[Array, Array]:
    """Return command and coil current as logged `size` seconds late; `detail` is the share that drifts away.

    The command is held between rows; the current is read between the steps of the integration.
    """
    time = np.arange(motion.frame.size) / motion.sample_rate
    late = fault.size * (1.0 - fault.detail * time / time[-1] * (1.0 if run % 2 else _EVEN_RUN_DRIFT))
    at = np.clip(time - late, 0.0, time[-1])
    rows = np.floor(at * motion.sample_rate + _ROUNDING).astype(int)
    fine = np.arange(motion.fine_current.size) * (motion.command.size / (motion.sample_rate * motion.fine_current.size))
    return motion.command[rows], np.interp(at, fine, motion.fine_current)


def apply_fault(u: Array, other: Array, fault: SensorFault, run: int, rate: float = SAMPLE_RATE) -> Array:
    """Return a channel `u` read through a fault; `other` is what couples into it.

    gain `(1 + g) u`; gain_bent `(1 + g) u` whose g fades with size; bias: offset plus drift; wander: offset plus slow
    noise; lag_second: a second-order low-pass; lag_average: mean over a window; quantise, clip, backlash, crosstalk.
    """
    size = fault.size
    time = np.arange(u.size) / rate
    if size == 0.0:
        return u
    rng = np.random.default_rng([fault.seed, run])
    reading: Mapping[str, Callable[[], Array]] = {
        "gain": lambda: u * (1.0 + size),
        "gain_bent": lambda: u * (1.0 + size / (1.0 + 0.1 * fault.detail * (u / fault.scale) ** 2)),
        "bias": lambda: u + size * (1.0 + (fault.detail - 0.4) * time / time[-1]),
        "wander": lambda: u + size * (0.6 + coloured_noise(rng, u.size, 0.02, 0.1 + 0.1 * fault.detail, -1.0, rate)),
        "lag_second": lambda: _low_pass(u, size, rate),
        "lag_average": lambda: _moving_average(u, size, rate),
        "quantise": lambda: np.round(u / size) * size,
        "clip": lambda: np.clip(u, -size, size),
        "backlash": lambda: _follow_with_play(u, size),
        "crosstalk": lambda: u + size * other,
    }
    return np.asarray(reading[fault.kind]())


def _low_pass(u: Array, delay: float, rate: float) -> Array:
    """Return u through `w^2 / (s^2 + 1.6 w s + w^2)`, whose delay at low frequency is `1.6 / w = delay`, s.

    The corner stays below 0.9 of the Nyquist frequency, where the bilinear transform is still of use.
    """
    w = min(1.6 / delay, 0.9 * np.pi * rate)
    b, a = bilinear([w * w], [1.0, 1.6 * w, w * w], rate)
    out, _ = lfilter(b, a, u, zi=lfilter_zi(b, a) * u[0])
    return np.asarray(out)


def _moving_average(u: Array, delay: float, rate: float) -> Array:
    """Return the mean over the last `2 delay` seconds, the edge of the window between rows included in part."""
    width = 2.0 * delay * rate + 1.0
    whole = int(width)
    taps = np.append(np.ones(whole), width - whole) / width
    padded = np.concatenate([np.full(taps.size - 1, u[0]), u])
    return np.convolve(padded, taps, "valid")


def _follow_with_play(u: Array, width: float) -> Array:
    """Return what a follower with play of `width` reads."""
    out = np.empty_like(u)
    follower = u[0]
    for k, value in enumerate(u):
        follower = min(max(follower, value - 0.5 * width), value + 0.5 * width)
        out[k] = follower
    return out


COMPARED = ("frame_acceleration", "driver_acceleration", "suspension_displacement", "damper_force", "coil_current")
"""Outputs that a gap compares, where they are recorded."""
_TOLERANCE = 0.02
"""Relative error of nominal parameters that the owner states, unless an experiment has its own."""


class _Channel(NamedTuple):
    """A recorded channel: its unit, the rms of its noise in that, the digits after the point that are written."""

    unit: str
    noise: float = 0.0
    digits: int = 4


CHANNELS = read_packaged(Path(__file__).with_name("channels.yaml"), dict[str, _Channel])
"""In the contract's order."""


class RunPlan(NamedTuple):
    """Excitation and control of a run; `temperature` of the damper at its start, degC."""

    name: str
    floor: Array  # m/s^2, at EXCITATION_RATE
    law: Array  # see `coil`
    schedule: Array  # A, one per row
    temperature: float
    repeat_of: str | None = None


class Experiment(NamedTuple):
    """A rig and its protocol before any effect; the last run is the unseen one.

    `nominal` are the parameters that the owner assumes, known to within the relative `tolerance` that he states, `true`
    those that the rig has; `noise` is the rms by channel, white but where the channel has a colour; `sample_rate` is
    that of the rows, Hz.
    """

    nominal: Mapping[str, float]
    true: Mapping[str, float]
    channels: tuple[str, ...]
    noise: Mapping[str, float]
    runs: tuple[RunPlan, ...]
    background: tuple[FrameForce, ...] = ()
    sample_rate: float = SAMPLE_RATE
    tolerance: float = _TOLERANCE
    colours: Mapping[str, NoiseColour] = {}

    @property
    def compared(self) -> tuple[str, ...]:
        """Recorded outputs that a gap compares."""
        return tuple(name for name in COMPARED if name in self.channels)

    @property
    def is_bingham(self) -> bool:
        """Whether the damper is the Bingham model; otherwise it is Bouc-Wen."""
        return self.nominal["is_bingham"] == 1.0


def simulate_run(
    experiment: Experiment,
    changes: Changes,
    run: int,
    command: Array | None = None,
    floor: Array | None = None,
    step: float = INTEGRATION_STEP,
) -> RigMotion:
    """Simulate the true rig through a run.

    With `command` (A, one per row) the loop is open; a `floor` (m/s^2) in place of the run's is given at the rows.
    """
    plan = experiment.runs[run]
    values = dict(experiment.true) | {"t_start": plan.temperature, "t_ambient": plan.temperature}
    for name, value in changes.parameters.items():
        number = value[min(run, len(value) - 1)] if isinstance(value, tuple) else value
        if name == "rate_factor":
            values["rate"] *= number
        else:
            values[name] = number
    law, schedule = (plan.law, plan.schedule) if command is None else (np.zeros(6), command)
    rate = experiment.sample_rate
    base, base_rate = (plan.floor, EXCITATION_RATE) if floor is None else (floor, rate)
    force = frame_force((*experiment.background, *changes.frame_forces), run, plan.schedule.size / rate)
    return simulate(parameter_record(values), Inputs(base, base_rate, force, law, schedule, rate), step)


def read_channels(experiment: Experiment, changes: Changes, run: int, motion: RigMotion) -> Readings:
    """Return what the channels show of a motion, without noise, in the contract's order."""
    return read_sensors(motion, experiment.runs[run].floor, changes.sensor_faults, run)
