"""The sampled loop of a law that is linear at small motion, with its own state and its sensors: poles and margins.

The floor is at rest, the damper delivers the wanted force through the coil's lag. That is the linear view of the
semi-active loop: the clip to what a damper can do only takes energy out. The law is asked, not described: its matrices
are its answers to small vectors.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.rig.coil import Coil
from seatsim.rig.control import CompiledLaw, ForceLaw, LawWithMemory, Measurement, State
from seatsim.rig.plant import Plant, state_space, zero_order_hold
from seatsim.rig.sensors import READINGS, Sensors, at_rest
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError

_QUIET = np.zeros((1, READINGS))
_SMALL = 1e-9
"""Size of the motion at which a law is asked, in the units of its measurement."""


class SampledLoop(NamedTuple):
    """The loop opened at the command: `z <- A z + B u`, wanted force `C z`, a row a sample of `sample_time` seconds.

    z holds the seat's (x, v, xc, vc), the damper force, the sensors' state and the law's, n in all.
    """

    A: Array
    B: Array
    C: Array
    sample_time: float

    def poles(self, delay_samples: int = 0) -> NDArray[np.complex128]:
        """Return the poles of the closed loop with whole samples of delay; stable inside the unit circle."""
        n, late = len(self.A), delay_samples
        closed = np.zeros((n + late, n + late))
        closed[:n, :n] = self.A
        if late == 0:
            closed += np.outer(self.B, self.C)
        else:
            closed[:n, n] = self.B
            closed[n:-1, n + 1 :] = np.eye(late - 1)
            closed[-1, :n] = self.C
        return np.linalg.eigvals(closed).astype(np.complex128)

    def radius(self, delay_samples: int = 0) -> float:
        """Return the spectral radius of the closed loop, below 1 where it is stable."""
        return float(np.max(np.abs(self.poles(delay_samples))))

    def gain(self, frequency: float) -> complex:
        """Return the loop gain `C (e^(j w T) I - A)^-1 B` at w in rad/s; the loop is unstable where it encircles 1."""
        z = np.exp(1j * frequency * self.sample_time)
        return complex(self.C @ np.linalg.solve(z * np.eye(len(self.A)) - self.A, self.B))

    def delay_margin(self) -> float:
        """Return the delay in s that makes the loop unstable; 0 where it is so already, inf where no delay does.

        The least phase ahead of 1 over its frequency, over all crossings of unit gain between 0.01 rad/s and the
        Nyquist frequency, found on 2000 frequencies.
        """
        # Imported here: a run does not need it, and it takes long.
        from scipy.optimize import brentq

        if self.radius() >= 1.0:
            return 0.0
        grid = self._frequencies()
        level = np.array([math.log(max(abs(self.gain(w)), 1e-300)) for w in grid])
        found = [math.inf]
        for k in np.flatnonzero(np.sign(level[1:]) != np.sign(level[:-1])):
            w = brentq(lambda w: math.log(max(abs(self.gain(w)), 1e-300)), grid[k], grid[k + 1])
            found.append(float(np.angle(self.gain(w)) % (2 * math.pi)) / w)
        return min(found)

    def disk_margin(self, delay_samples: int = 0) -> float:
        """Return the balanced disk margin at the command, `min 2 |1 + L| / |1 - L|`, with L the negative loop gain.

        The loop stays stable while a factor in the disk between (2 - a) / (2 + a) and (2 + a) / (2 - a) stands before
        the damper (Seiler, Packard and Gahinet 2020); 0 where it is unstable already. Found on 2000 frequencies.
        """
        if self.radius(delay_samples) >= 1.0:
            return 0.0
        late = delay_samples * self.sample_time
        loops = [self.gain(w) * np.exp(-1j * w * late) for w in self._frequencies()]
        return float(min(2.0 * abs(1.0 - loop) / abs(1.0 + loop) for loop in loops))

    def _frequencies(self) -> Array:
        """Return the frequencies in rad/s at which a loop gain is looked at."""
        return np.geomspace(0.01, math.pi / self.sample_time, 2000)


def build_seat_with_coil(plant: Plant, coil: Coil) -> tuple[Array, Array]:
    """Return (A, B), shapes (5, 5) and (5, 1), from the wanted force to (x, v, xc, vc, damper force)."""
    s = state_space(plant)
    A = np.block([[s.A, s.B2], [np.zeros((1, 4)), np.array([[-coil.rate]])]])
    return A, coil.rate * np.eye(5)[:, 4:]


def build_sampled_loop(
    law: CompiledLaw,
    initial: State,
    plant: Plant,
    coil: Coil,
    sample_time: float,
    sensors: Sensors | None = None,
    step: float = 0.001,
) -> SampledLoop:
    """Return the loop of a law in its compiled form, whose state starts at `initial`, on sensors or on the true states.

    Args:
        law: a record with `wanted_force`, linear at small motion.
        initial: value of its state at rest.
        plant: the seat.
        coil: its rate is the lag of the damper force.
        sample_time: in s, a multiple of `step`.
        sensors: None for the true states.
        step: in s, at which the sensors' anti-alias filters move on.

    Raises:
        InputError: the law wants a current, or is not linear.
    """
    if not isinstance(law, ForceLaw):
        raise InputError(f"{type(law).__name__} wants a current; only a law that wants a force has a linear loop")
    period = _sample_period(law, len(initial), plant, coil, round(sample_time / step), step, sensors)
    size = 5 + (len(at_rest(0.0)) if sensors else 0) + len(initial)
    columns = [period(_SMALL * unit, 0.0) for unit in np.eye(size)]
    a, c = np.array([z for z, _ in columns]).T / _SMALL, np.array([answer for _, answer in columns]) / _SMALL
    b = period(np.zeros(size), _SMALL)[0] / _SMALL
    _require_linear(period, a, b, c)
    return SampledLoop(a, b, c, sample_time)


_Period = Callable[[Array, float], tuple[Array, float]]


def _sample_period(
    law: ForceLaw, memory: int, plant: Plant, coil: Coil, every: int, step: float, sensors: Sensors | None
) -> _Period:
    """Return the function that carries (z, command) over one sample and says what the law wants at its beginning."""
    A, B = build_seat_with_coil(plant, coil)
    transition, input_gain = zero_order_hold(A, B, step)
    instruments = sensors.instruments(step, every * step) if sensors else None

    def advance(z: Array, command: float) -> tuple[Array, float]:
        seat, sensor_state, own = z[:5], tuple(z[5 : len(z) - memory]), tuple(z[len(z) - memory :])
        y = _true_measurement(A, seat)
        if instruments:
            y, sensor_state = instruments.read(y, _QUIET, 0, sensor_state)
        answer = law.wanted_force(y, own)
        own = law.update(y, own) if isinstance(law, LawWithMemory) else own
        # As in a run: the command of this instant holds until the next, while the sensors' filters see every step.
        for _ in range(every):
            seat = transition @ seat + input_gain[:, 0] * command
            if instruments:
                sensor_state = instruments.advance_filters(0.0, seat[0], tuple(A @ seat), sensor_state)
        return np.concatenate([seat, sensor_state, own]), answer

    return advance


def _true_measurement(A: Array, seat: Array) -> Measurement:
    """Return the true measurement over a floor at rest, from (x, v, xc, vc, damper force)."""
    x, v, _, vc, force = seat
    rates = A @ seat
    return Measurement(0.0, x, v, v, v + vc, 0.0, rates[1], rates[1] + rates[3], force, 0.0, 20.0, math.nan)


def _require_linear(period: _Period, a: Array, b: Array, c: Array) -> None:
    """Raise InputError where superposition does not give the answer to a vector of many entries."""
    # Any vector without a zero entry will do; an answer in N over 1e-9 of motion is rounded to about 1e-3.
    some = np.cos(np.arange(len(a)) + 1.0)
    z, answer = period(_SMALL * some, -0.7 * _SMALL)
    if not (np.allclose(z / _SMALL, a @ some - 0.7 * b) and np.allclose(answer / _SMALL, c @ some, atol=1e-3)):
        raise InputError("the law is not linear at small motion; it has no loop of poles and margins")
