"""Independent solutions of the seat: tiny steps, other methods, nothing taken from the kernel.

The state is (x, v, xc, vc) of the seat; floor acceleration is linear between rows every `STEP` seconds.
"""

import math
from typing import NamedTuple

import numba
import numpy as np
from scipy.integrate import solve_ivp

from .rigs import METRICS, SEAT, STEP

MS, M, KF, CF, KC, CC = SEAT[:6]


class Yielding(NamedTuple):
    """Force `(c_a + c_b i) v + (fc_a + fc_b i) s(v)` of a Bingham damper, beside `friction` s(v) in the linkage.

    s is tanh(v / v_ref) in the damper where v_ref > 0, else the set-valued sign.
    """

    c_a: float
    c_b: float
    fc_a: float
    fc_b: float
    v_ref: float
    friction: float


@numba.njit
def seat(s, force, floor):
    """Rates of the state (x, v, xc, vc) under a damper force."""
    cushion = KC * s[2] + CC * s[3]
    frame = (cushion - KF * s[0] - CF * s[1] - force) / MS
    return s[1], frame - floor, s[3], -cushion / M - frame


@numba.njit
def _damper(p, v, i):
    force = (p.c_a + p.c_b * i) * v
    return force + (p.fc_a + p.fc_b * i) * math.tanh(v / p.v_ref) if p.v_ref > 0.0 else force


@numba.njit
def skyhook(p, rows, every, parts, rate, on, start):
    """Solve under an on-off skyhook law sampled every `every` rows, by time-stepping with `parts` steps a row.

    Moreau's scheme: the velocity takes an explicit step without the friction, then the friction's impulse takes from
    it what it can. The coil is exact. A law with `on` below zero stands for the constant current `start`.
    """
    s, i, floor_velocity, command = (0.0, 0.0, 0.0, 0.0), start, 0.0, start
    out = np.empty((len(rows), 5))
    h = STEP / parts
    keep = math.exp(-rate * h)
    for k in range(len(rows)):
        if on >= 0.0 and k % every == 0:
            command = on if (s[1] + floor_velocity) * s[1] > 0.0 else 0.0
        limit = p.friction + (max(0.0, p.fc_a + p.fc_b * i) if p.v_ref == 0.0 else 0.0)
        force = _damper(p, s[1], i)
        a = seat(s, force, rows[k])
        held = MS * a[1] if s[1] == 0.0 else math.copysign(limit, s[1])
        held = min(max(held, -limit), limit)
        share = held / limit if limit > 0.0 else 0.0
        frame = a[1] + rows[k] - held / MS
        driver = -(KC * s[2] + CC * s[3]) / M
        out[k] = frame, driver, s[0], force + share * (limit - p.friction), i
        if k == len(rows) - 1:
            break
        slope = (rows[k + 1] - rows[k]) / parts
        for j in range(parts):
            middle = command + (i - command) * math.sqrt(keep)
            a = seat(s, _damper(p, s[1], middle), rows[k] + slope * (j + 0.5))
            limit = p.friction + (max(0.0, p.fc_a + p.fc_b * middle) if p.v_ref == 0.0 else 0.0)
            free = s[1] + h * a[1]
            v = math.copysign(max(0.0, abs(free) - h * limit / MS), free)
            w = s[3] + h * a[3] + (free - v)
            s = (s[0] + h * v, v, s[2] + h * w, w)
            i = command + (i - command) * keep
        floor_velocity += 0.5 * (rows[k] + rows[k + 1]) * STEP
    return out


def channels(out):
    """Name the columns of a reference."""
    return dict(zip(METRICS, np.asarray(out).T, strict=True))


def bouc_wen_feedback(d, rows, every, gain, rate=130.0, top=1.0):
    """Solve a Bouc-Wen seat under sampled output feedback with the inverse in closed form, by `solve_ivp`."""

    def rates(t, s, k, command):
        x, v, xc, vc, z, i = s.tolist()
        force = (d.c_a + d.c_b * i) * v + (d.alpha_a + d.alpha_b * i) * z
        a = seat.py_func((x, v, xc, vc), force, rows[k] + (rows[k + 1] - rows[k]) * (t / STEP - k))
        return *a, d.A * v - d.beta * v * z * z - d.gamma * abs(v) * z * abs(z), rate * (command - i)

    s, command, out = np.zeros(6), 0.0, []
    for k in range(len(rows)):
        x, v, xc, vc, z, i = s
        if k % every == 0:
            wanted = gain[0] * x + gain[1] * v
            at_zero, slope = d.c_a * v + d.alpha_a * z, d.c_b * v + d.alpha_b * z
            command = min(max((wanted - at_zero) / slope, 0.0), top) if wanted * v > 0.0 and slope != 0.0 else 0.0
        force = (d.c_a + d.c_b * i) * v + (d.alpha_a + d.alpha_b * i) * z
        cushion = KC * xc + CC * vc
        out.append(((cushion - KF * x - CF * v - force) / MS, -cushion / M, x, force, i))
        if k < len(rows) - 1:
            span = (k * STEP, (k + 1) * STEP)
            s = solve_ivp(rates, span, s, args=(k, command), method="DOP853", rtol=1e-9, atol=1e-13).y[:, -1]
    return channels(out)
