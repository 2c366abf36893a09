"""What the channels read: sensor faults on the true motion, at the rows. Sizes in the channel's unit, s, or shares.

gain `(1+g) u`; gain_bent `(1+g) u` that fades with size; bias: offset plus drift; wander: slow random offset;
lag_second: `w^2/(s^2 + 1.6 w s + w^2)`; lag_average: mean over a window; skew: the log's clock is off and may drift.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from scipy.signal import bilinear, lfilter, lfilter_zi

from seatsim.blind.truth.rig import FINE, RATE, Motion
from seatsim.blind.truth.roads import coloured
from seatsim.blind.truth.sensor import NEIGHBOUR
from seatsim.blind.truth.slots import Array
from seatsim.blind.truth.truth import Fault


def readings(motion: Motion, floor: Array, faults: Iterable[Fault], run: int) -> dict[str, Array]:
    """Return what each channel reads, without noise."""
    rows = motion.frame.size
    true = {
        "floor_acceleration": floor[:: round(FINE / RATE)][:rows].copy(),
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
            read["current_command"], read["coil_current"] = skewed(motion, fault, run)
        else:
            read[fault.channel] = faulty(read[fault.channel], true[NEIGHBOUR[fault.channel]], fault, run)
    return read


def skewed(motion: Motion, fault: Fault, run: int) -> tuple[Array, Array]:
    """Return command and coil current as logged `size` seconds late; detail is the share that drifts away."""
    time = np.arange(motion.frame.size) / RATE
    late = fault.size * (1.0 - fault.detail * time / time[-1] * (1.0 if run % 2 else 0.6))
    at = np.clip(time - late, 0.0, time[-1])
    rows = np.floor(at * RATE + 1e-6).astype(int)
    fine = np.arange(motion.fine_current.size) * (motion.command.size / (RATE * motion.fine_current.size))
    return motion.command[rows], np.interp(at, fine, motion.fine_current)


def faulty(u: Array, other: Array, fault: Fault, run: int) -> Array:  # noqa: PLR0911 - one return per fault
    """Return a channel read through a fault."""
    size = fault.size
    time = np.arange(u.size) / RATE
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
            noise = coloured(
                np.random.default_rng([fault.seed, run]), u.size, 0.02, 0.1 + 0.1 * fault.detail, -1.0, RATE
            )
            return u + size * (0.6 + noise)
        case "lag_second":
            return second_order(u, size)
        case "lag_average":
            return averaged(u, size)
        case "quantise":
            return np.asarray(np.round(u / size) * size)
        case "clip":
            return np.clip(u, -size, size)
        case "backlash":
            return backlash(u, size)
        case "crosstalk":
            return u + size * other
    raise ValueError(fault.kind)


def second_order(u: Array, delay: float) -> Array:
    """Return a damped second-order low-pass (0.8 critical) whose delay at low frequency is `delay`, s."""
    w = min(1.6 / delay, 0.9 * np.pi * RATE)
    b, a = bilinear([w * w], [1.0, 1.6 * w, w * w], RATE)
    out, _ = lfilter(b, a, u, zi=lfilter_zi(b, a) * u[0])
    return np.asarray(out)


def averaged(u: Array, delay: float) -> Array:
    """Return the mean over the last `2 delay` seconds, the edge of the window between rows included in part."""
    width = 2.0 * delay * RATE + 1.0
    whole = int(width)
    taps = np.append(np.ones(whole), width - whole) / width
    padded = np.concatenate([np.full(taps.size - 1, u[0]), u])
    return np.convolve(padded, taps, "valid")


def backlash(u: Array, width: float) -> Array:
    """Return what a follower with play of `width` reads."""
    out = np.empty_like(u)
    held = u[0]
    for k, value in enumerate(u):
        held = min(max(held, value - 0.5 * width), value + 0.5 * width)
        out[k] = held
    return out
