"""Functions that the compiled loop calls on a damper, a law, sensors or the model of an inverse, of any class.

numba compiles the methods of a record and never reads the interfaces; they are for readers and for the type checker.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple, Protocol

from numba import types

from seatsim.compilation.jit import jit, specialise
from seatsim.kernel.hooks import axpy, combine, hook, record_class
from seatsim.rig.control import CompiledLaw, CurrentLaw, ForceLaw, Measurement
from seatsim.rig.sensors import Sensing
from seatsim.rig.state import State
from seatsim.rig.temperature import TemperatureFactors, TemperatureScaling, scaling
from seatsim.schema.arrays import Array


class DamperModel(Protocol):
    """A damper model: the part that every model has.

    x [m] and v [m/s] are displacement and velocity of the damper, i [A] its coil current, `scaling` the factors of the
    temperature on its viscous, elastic and yield terms, z its state (empty where it has none).
    """

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State, /) -> float:
        """Return the force in N without the set-valued friction, positive when it opposes extension."""


scaling_at = jit(scaling)


@hook
def force(damper: DamperModel, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
    """Damper force in N; every damper has its own."""
    raise TypeError(f"{type(damper).__name__} has no method 'force', so that it is no damper")


@hook
def rates(damper: DamperModel, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
    """Time derivative of the damper's state."""
    return ()


@hook
def force_and_rates(
    damper: DamperModel, x: float, v: float, i: float, scaling: TemperatureScaling, z: State
) -> tuple[float, State]:
    """Damper force in N and time derivative of the damper's state, for a damper in which they share work."""
    return force(damper, x, v, i, scaling, z), rates(damper, x, v, i, scaling, z)


@hook
def coulomb(damper: DamperModel, i: float, scaling: TemperatureScaling) -> float:
    """Magnitude in N of the damper's set-valued friction."""
    return 0.0


@hook
def friction_limit(damper: DamperModel, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
    """Largest set-valued friction in N at this speed and state."""
    return coulomb(damper, i, scaling)


@hook
def update(law: CompiledLaw, y: Measurement, state: State) -> State:
    """Next state of a control law."""
    return state


@hook
def advance_filters(sensors: Sensing, floor: float, x: float, rates: State, state: State) -> State:
    """State of the sensors after a step of the loop."""
    return state


@hook
def read(sensors: Sensing, true: Measurement, noise: Array, sample: int, state: State) -> tuple[Measurement, State]:
    """Measurement of the true values that a law is given, and the state of the sensors after it."""
    return true, state


@hook
def take(sensors: Sensing, read: Measurement, state: State) -> tuple[Measurement, State]:
    """Measurement that a law is given of readings that were sampled already, and the state of the sensors after it."""
    return read, state


def wants_force(law: CompiledLaw) -> bool:
    """Whether the law returns a force (for the inverse) rather than a current."""
    return isinstance(law, ForceLaw)


@specialise(wants_force)
def _wants_force(law: types.Type) -> Callable[[CompiledLaw], bool]:
    answer = issubclass(record_class(law), ForceLaw)
    return lambda law: answer


def evaluate_law(law: CompiledLaw, y: Measurement, state: State) -> float:
    """Return the law's output: a force in N or a current in A, according to `wants_force`."""
    return law.wanted_force(y, state) if isinstance(law, ForceLaw) else law.wanted_current(y, state)


@specialise(evaluate_law)
def _evaluate_law(law: types.Type, y: types.Type, state: types.Type) -> Callable[..., float]:
    cls = record_class(law)
    if issubclass(cls, ForceLaw):
        return cls.wanted_force
    if issubclass(cls, CurrentLaw):
        return cls.wanted_current
    raise TypeError(f"{cls.__name__} has neither 'wanted_force' nor 'wanted_current', so that it is no law")


class TrueModel(NamedTuple):
    """The inverse knows the damper of the rig, its state and its temperature."""

    damper: DamperModel

    def model_state(self, true: State, followed: State) -> State:
        """Return the state with which the inverse evaluates the damper."""
        return true

    def model_scaling(self, true: TemperatureScaling, temperature: float) -> TemperatureScaling:
        """Return the temperature factors that the inverse uses."""
        return true


class AssumedModel(NamedTuple):
    """The inverse assumes that the damper is `damper` and tracks its state from measured motion and current.

    `temperature` is the assumed temperature of the damper in degC; NaN where the inverse reads the measured one.
    """

    damper: DamperModel
    factors: TemperatureFactors
    temperature: float

    def model_state(self, true: State, followed: State) -> State:
        """Return the state with which the inverse evaluates the damper."""
        return followed

    def model_scaling(self, true: TemperatureScaling, temperature: float) -> TemperatureScaling:
        """Return the temperature factors that the inverse uses, at the measured `temperature` in degC or its own."""
        return scaling_at(self.factors, temperature if math.isnan(self.temperature) else self.temperature)


InverseModel = TrueModel | AssumedModel


@hook
def model_state(model: InverseModel, true: State, followed: State) -> State:
    """State with which the inverse evaluates its damper: the true one, or the tracked one, `followed`."""
    raise TypeError(f"{type(model).__name__} is no model for the inverse")


@hook
def model_scaling(model: InverseModel, true: TemperatureScaling, temperature: float) -> TemperatureScaling:
    """Temperature factors that the inverse uses."""
    raise TypeError(f"{type(model).__name__} is no model for the inverse")


class Motion(NamedTuple):
    """What a damper is exposed to at an instant: displacement x in m, velocity v in m/s, current i in A."""

    x: float
    v: float
    i: float


@jit
def step_state(
    damper: DamperModel, z: State, first: Motion, middle: Motion, last: Motion, scaling: TemperatureScaling, h: float
) -> tuple[State, State]:
    """Return a damper's state `h` seconds after `z` and the fourth stage, by the classical Runge-Kutta method."""
    k1 = rates(damper, first.x, first.v, first.i, scaling, z)
    k2 = rates(damper, middle.x, middle.v, middle.i, scaling, axpy(z, 0.5 * h, k1))
    k3 = rates(damper, middle.x, middle.v, middle.i, scaling, axpy(z, 0.5 * h, k2))
    k4 = rates(damper, last.x, last.v, last.i, scaling, axpy(z, h, k3))
    return combine(z, h, k1, k2, k3, k4), k4


@jit
def follow_state(
    damper: DamperModel, z: State, first: Motion, last: Motion, scaling: TemperatureScaling, length: float
) -> State:
    """Return an assumed damper's state `length` seconds after `z`, by the classical Runge-Kutta method.

    Displacement and velocity go linearly from the `first` motion to the `last`; the current, that of the first, and the
    temperature factors are constant. The error is not checked: rates above about 1 / length are not tracked.
    """
    # Two half steps between samples, so that a hysteresis as stiff as the rig itself is tracked too.
    dx, dv, i = last.x - first.x, last.v - first.v, first.i
    for part in range(2):
        x, v = first.x + 0.5 * part * dx, first.v + 0.5 * part * dv
        middle, end = Motion(x + 0.25 * dx, v + 0.25 * dv, i), Motion(x + 0.5 * dx, v + 0.5 * dv, i)
        z, _ = step_state(damper, z, Motion(x, v, i), middle, end, scaling, 0.5 * length)
    return z
