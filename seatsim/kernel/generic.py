"""Generic functions that the compiled loop calls; numba resolves each by the class of the record it is given.

A record class is an ordinary NamedTuple with ordinary methods. `hook(default)` makes a function `f(self, ...)` that in
compiled code is the record's own method of that name, inlined; where the class has none, the default's.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba import types
from numba.extending import overload

from seatsim.compilation.jit import INLINED, jit
from seatsim.rig.temperature import TemperatureFactors, TemperatureScaling
from seatsim.rig.temperature import scaling as _heat

Tuple = tuple[float, ...]


def hook(default: Callable[..., Any]) -> Callable[..., Any]:
    """Make the generic function that calls a record's method of the default's name, or else the default."""
    name = default.__name__

    def generic(self: Any, *args: Any) -> Any:
        method = getattr(self, name, None)
        return method(*args) if method else default(self, *args)

    def resolve(self: Any, *args: Any) -> Callable[..., Any] | None:
        cls = getattr(self, "instance_class", None)
        return getattr(cls, name, default) if isinstance(self, types.BaseNamedTuple) else None

    generic.__name__ = generic.__qualname__ = name
    overload(generic, strict=False, jit_options=INLINED)(resolve)
    return generic


@hook
def force(self: Any, x: float, v: float, i: float, scaling: TemperatureScaling, z: Tuple) -> float:
    """Damper force in N; every damper has its own."""
    raise TypeError


@hook
def rates(self: Any, x: float, v: float, i: float, scaling: TemperatureScaling, z: Tuple) -> Tuple:
    """Time derivative of the damper's state."""
    return ()


@hook
def coulomb(self: Any, i: float, scaling: TemperatureScaling) -> float:
    """Magnitude in N of the damper's set-valued friction."""
    return 0.0


@hook
def friction_limit(self: Any, v: float, i: float, scaling: TemperatureScaling, z: Tuple) -> float:
    """Largest set-valued friction in N at this speed and state."""
    limit: float = coulomb(self, i, scaling)
    return limit


@hook
def update(self: Any, y: Any, state: Tuple) -> Tuple:
    """Next state of a control law."""
    return state


@hook
def passed(self: Any, floor: float, x: float, rates: Tuple, state: Tuple) -> Tuple:
    """State of the sensors after a step of the loop."""
    return state


@hook
def read(self: Any, true: Any, noise: Any, sample: int, state: Tuple) -> tuple[Any, Tuple]:
    """Measurement that a law is given of what is true, and the state of the sensors after it."""
    return true, state


def wants_force(law: Any) -> bool:
    """Whether the law answers with a force (through the inverse) rather than with a current."""
    return hasattr(law, "wanted_force")


@overload(wants_force, strict=False, jit_options=INLINED)
def _wants_force(law: Any) -> Callable[..., bool]:
    answer = wants_force(law.instance_class)
    return lambda law: answer


def ask(law: Any, y: Any, state: Tuple) -> float:
    """Return what the law wants: a force in N or a current in A."""
    answer: float = _question(type(law))(law, y, state)
    return answer


@overload(ask, strict=False, jit_options=INLINED)
def _ask(law: Any, y: Any, state: Any) -> Callable[..., float]:
    return _question(law.instance_class)


def _question(cls: Any) -> Callable[..., float]:
    method: Callable[..., float] = cls.wanted_force if wants_force(cls) else cls.wanted_current
    return method


def axpy(y: Tuple, h: float, k: Tuple) -> Tuple:
    """Return `y + h k` for two tuples of equal length."""
    return tuple(a + h * b for a, b in zip(y, k, strict=True))


@overload(axpy, strict=False, jit_options=INLINED)
def _axpy(y: Any, h: float, k: Any) -> Callable[..., Any]:
    return _unrolled("y, h, k", "y[{j}] + h * k[{j}]", len(y))


def combine(y: Tuple, h: float, k1: Tuple, k2: Tuple, k3: Tuple, k4: Tuple) -> Tuple:
    """Return `y + h (k1 + 2 k2 + 2 k3 + k4) / 6`, the step of the classical Runge-Kutta method."""
    stages = zip(y, k1, k2, k3, k4, strict=True)
    return tuple(a + h / 6.0 * (b + 2.0 * (c + d) + e) for a, b, c, d, e in stages)


@overload(combine, strict=False, jit_options=INLINED)
def _combine(y: Any, h: float, k1: Any, k2: Any, k3: Any, k4: Any) -> Callable[..., Any]:
    term = "y[{j}] + h / 6.0 * (k1[{j}] + 2.0 * (k2[{j}] + k3[{j}]) + k4[{j}])"
    return _unrolled("y, h, k1, k2, k3, k4", term, len(y))


def _unrolled(arguments: str, term: str, length: int) -> Callable[..., Any]:
    """Build a function that returns a tuple of `term` for j = 0 .. length - 1: numba has no tuple comprehension."""
    body = "".join(term.format(j=j) + ", " for j in range(length))
    namespace: dict[str, Any] = {}
    exec(f"def impl({arguments}): return ({body})", namespace)
    implementation: Callable[..., Any] = namespace["impl"]
    return implementation


heat_at: Callable[[TemperatureFactors, float], TemperatureScaling] = jit(_heat)
