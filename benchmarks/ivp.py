"""The same run with `scipy.integrate.solve_ivp`, written as a user would and compiled with numba.

The command is held between the law's samples, so the integration restarts at each of them. The functions are scalar
Python: faster than numpy on seven states, and numba compiles them as they stand. The damper's inverse is seatsim's.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal, TypeVar

import numba
import numpy as np
from scipy.integrate import solve_ivp
from seat_run import DAMPER, GAIN, PLANT, STEP

from seatsim.kernel.inverse import CELLS, Demand, invert
from seatsim.rig.coil import Coil
from seatsim.rig.temperature import TemperatureScaling
from seatsim.schema.arrays import Array

MS, M, KF, CF, KC, CC = PLANT[:6]
C0, C1, ALPHA, K0, K1, X0, F0, A, BETA, GAMMA = DAMPER[:10]
KX, KV = GAIN
RATE, TOP = Coil().rate, Coil().max_current
CHANNELS = (
    "frame_acceleration", "driver_acceleration", "suspension_displacement", "suspension_velocity", "damper_force",
    "coil_current",
)  # fmt: skip
Number = TypeVar("Number", float, Array)
Size = Callable[[float], float]
Force = Callable[[float, float, float, float, float], tuple[float, float]]


def damper(x: Number, v: Number, i: Number, y: Number, z: Number) -> tuple[Number, Number]:
    """Return force in N and rate of the inner displacement of the modified Bouc-Wen damper (n = 2)."""
    c0 = C0[0] + i * (C0[1] + i * (C0[2] + i * C0[3]))
    c1 = C1[0] + i * (C1[1] + i * (C1[2] + i * C1[3]))
    alpha = ALPHA[0] + i * (ALPHA[1] + i * (ALPHA[2] + i * ALPHA[3]))
    flow = (alpha * z + K0 * (x - y) + c0 * v) / (c0 + c1)
    return c1 * flow + K1 * (x - X0) + F0, flow


def interpolate(floor: Array, t: float) -> float:
    """Return the floor's acceleration at a time, of `floor` every `STEP` seconds."""
    k = min(int(t / STEP), len(floor) - 2)
    acceleration: float = floor[k] + (floor[k + 1] - floor[k]) * (t / STEP - k)
    return acceleration


def rates(damper: Force, size: Size, s: Sequence[float], command: float, floor: float) -> tuple[float, ...]:
    """Return the time derivative of `s` = (x, v, xc, vc, y, z, i); `size` is what returns an absolute value."""
    x, v, xc, vc, y, z, i = s[0], s[1], s[2], s[3], s[4], s[5], s[6]
    force, flow = damper(x, v, i, y, z)
    cushion = KC * xc + CC * vc
    frame = (cushion - KF * x - CF * v - force) / MS
    r = v - flow
    hysteresis = A * r - BETA * r * z * z - GAMMA * size(r) * z * size(z)
    return v, frame - floor, vc, -cushion / M - frame, flow, hysteresis, RATE * (command - i)


def compile_model() -> tuple[Callable[..., Sequence[float]], Callable[[float, float, float, float], float]]:
    """Return the seat's rates as `solve_ivp` wants them, and the commanded current, compiled with numba."""
    force, slope, excite = map(numba.njit, (damper, rates, interpolate))
    cold = TemperatureScaling()

    def command(x: float, v: float, y: float, z: float) -> float:
        return invert(Demand(DAMPER, KX * x + KV * v, x, v, cold, (y, z), TOP), np.empty(CELLS + 1)).current

    return numba.njit(lambda t, s, u, f: slope(force, abs, s, u, excite(f, t))), numba.njit(command)


MethodName = Literal["RK23", "RK45", "DOP853", "Radau", "LSODA"]
Simulate = Callable[[float, Array, int], dict[str, Array]]
"""Simulates with a relative tolerance under a floor acceleration, with the law every so many steps.

It starts from rest and returns the channels at the law's samples, shape (N - 1) // sample_every + 1. The absolute
tolerance is a thousandth of the relative one.
"""


def make_solver(name: MethodName) -> Simulate:
    """Return what simulates the run with a method of `solve_ivp`."""
    slope, inverse = compile_model()

    def simulate(rtol: float, acceleration: Array, sample_every: int) -> dict[str, Array]:
        state = np.zeros(7)
        states = [state]
        for start in range(0, len(acceleration) - 1, sample_every):
            x, v, _, _, y, z, _ = state.tolist()
            command = inverse(x, v, y, z)
            t, end = start * STEP, (start + sample_every) * STEP
            first, held = None if name == "LSODA" else end - t, (command, acceleration)
            solution = solve_ivp(slope, (t, end), state, name, rtol=rtol, atol=1e-3 * rtol, first_step=first, args=held)
            state = solution.y[:, -1]
            states.append(state)
        return list_channels(np.array(states), acceleration[::sample_every])

    return simulate


def list_channels(states: Array, floor: Array) -> dict[str, Array]:
    """Return the channels at the law's samples: `states` in rows of (x, v, xc, vc, y, z, i), `floor` likewise."""
    x, v, xc, vc, y, z, i = states.T
    force, _ = damper(x, v, i, y, z)
    cushion = KC * xc + CC * vc
    frame = (cushion - KF * x - CF * v - force) / MS
    return dict(zip(CHANNELS, (frame, -cushion / M, x, v, force, i), strict=True))
