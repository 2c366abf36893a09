"""What the channels read: sensor faults on the true motion, at the rows. Sizes in the channel's unit, s, or shares."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from scipy.signal import bilinear, lfilter, lfilter_zi

from seatsim.blind.truth.faults.scenario import SensorFault
from seatsim.blind.truth.faults.sensor import NEIGHBOUR
from seatsim.blind.truth.noise import coloured_noise
from seatsim.blind.truth.physics.rig import EXCITATION_RATE, SAMPLE_RATE, RigMotion
from seatsim.schema.arrays import Array

Readings = dict[str, Array]
"""What each channel reads in a run, shape (rows,) each."""
ROUNDING = 1e-6
"""Of a row: a time that lies on a row but for rounding counts as that row."""
EVEN_RUN_DRIFT = 0.6
"""Share of the clock's drift in runs of even number: a fault that is the same in all runs is easier to find."""


def read_sensors(motion: RigMotion, floor: Array, faults: Iterable[SensorFault], run: int) -> Readings:
    """Return what each channel reads, without noise; `floor` is the run's acceleration at 2 kHz, m/s^2."""
    time = np.arange(motion.frame.size) / motion.sample_rate
    true = {
        "floor_acceleration": np.interp(time * EXCITATION_RATE, np.arange(floor.size), floor),
        "frame_acceleration": motion.frame,
        "driver_acceleration": motion.driver,
        "suspension_displacement": motion.displacement,
        "damper_force": motion.force,
        "current_command": motion.command,
        "coil_current": motion.current,
        "damper_temperature": motion.temperature,
    }
    read = {name: values.copy() for name, values in true.items()}
    for fault in faults:
        if fault.kind == "skew":
            read["current_command"], read["coil_current"] = read_late_log(motion, fault, run)
        else:
            other = true[NEIGHBOUR[fault.channel]]
            read[fault.channel] = apply_fault(read[fault.channel], other, fault, run, motion.sample_rate)
    return read


def read_late_log(motion: RigMotion, fault: SensorFault, run: int) -> tuple[Array, Array]:
    """Return command and coil current as logged `size` seconds late; `detail` is the share that drifts away.

    The command is held between rows; the current is read between the steps of the integration.
    """
    time = np.arange(motion.frame.size) / motion.sample_rate
    late = fault.size * (1.0 - fault.detail * time / time[-1] * (1.0 if run % 2 else EVEN_RUN_DRIFT))
    at = np.clip(time - late, 0.0, time[-1])
    rows = np.floor(at * motion.sample_rate + ROUNDING).astype(int)
    fine = np.arange(motion.fine_current.size) * (motion.command.size / (motion.sample_rate * motion.fine_current.size))
    return motion.command[rows], np.interp(at, fine, motion.fine_current)


def apply_fault(  # noqa: PLR0911 - one return per fault
    u: Array, other: Array, fault: SensorFault, run: int, rate: float = SAMPLE_RATE
) -> Array:
    """Return a channel `u` read through a fault; `other` is what couples into it.

    gain `(1 + g) u`; gain_bent `(1 + g) u` whose g fades with size; bias: offset plus drift; wander: offset plus slow
    noise; lag_second: a second-order low-pass; lag_average: mean over a window; quantise, clip, backlash, crosstalk.
    """
    size = fault.size
    time = np.arange(u.size) / rate
    if size == 0.0:
        return u
    match fault.kind:
        case "gain":
            return u * (1.0 + size)
        case "gain_bent":
            return u * (1.0 + size / (1.0 + 0.1 * fault.detail * (u / fault.scale) ** 2))
        case "bias":
            return np.asarray(u + size * (1.0 + (fault.detail - 0.4) * time / time[-1]))
        case "wander":
            rng = np.random.default_rng([fault.seed, run])
            noise = coloured_noise(rng, u.size, 0.02, 0.1 + 0.1 * fault.detail, -1.0, rate)
            return u + size * (0.6 + noise)
        case "lag_second":
            return low_pass(u, size, rate)
        case "lag_average":
            return moving_average(u, size, rate)
        case "quantise":
            return np.asarray(np.round(u / size) * size)
        case "clip":
            return np.clip(u, -size, size)
        case "backlash":
            return follow_with_play(u, size)
        case "crosstalk":
            return u + size * other
    raise ValueError(fault.kind)


def low_pass(u: Array, delay: float, rate: float) -> Array:
    """Return u through `w^2 / (s^2 + 1.6 w s + w^2)`, whose delay at low frequency is `1.6 / w = delay`, s.

    The corner stays below 0.9 of the Nyquist frequency, where the bilinear transform is still of use.
    """
    w = min(1.6 / delay, 0.9 * np.pi * rate)
    b, a = bilinear([w * w], [1.0, 1.6 * w, w * w], rate)
    out, _ = lfilter(b, a, u, zi=lfilter_zi(b, a) * u[0])
    return np.asarray(out)


def moving_average(u: Array, delay: float, rate: float) -> Array:
    """Return the mean over the last `2 delay` seconds, the edge of the window between rows included in part."""
    width = 2.0 * delay * rate + 1.0
    whole = int(width)
    taps = np.append(np.ones(whole), width - whole) / width
    padded = np.concatenate([np.full(taps.size - 1, u[0]), u])
    return np.convolve(padded, taps, "valid")


def follow_with_play(u: Array, width: float) -> Array:
    """Return what a follower with play of `width` reads."""
    out = np.empty_like(u)
    follower = u[0]
    for k, value in enumerate(u):
        follower = min(max(follower, value - 0.5 * width), value + 0.5 * width)
        out[k] = follower
    return out
