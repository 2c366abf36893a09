"""What an effect is: a small physical change of the simulated rig, switched on in a scenario.

An effect is a record of parameters, named `block.effect`. It acts through whichever of these methods it has; each
returns its argument unchanged where the parameters are off.

Before a run, in Python, on arrays of shape (N,):

    plant(self, plant)                      parameters of the seat
    coil(self, coil)                        parameters of the coil
    factors(self, factors)                  temperature factors of the damper
    temperature(self, step, values)         temperature [degC] of the fluid from that of the thermocouple
    frame_force(self, time, seed)           force on the frame in N, added to that of other effects
    reading(self, channel, step, values)    reading of a sensor from the true values
    truth(self, channel, step, values)      true values from the reading of a sensor

In the time loop, compiled by numba, with `z` the effect's own state. On the damper, whose end moves at v [m/s] under
the current i [A] and whose piston moves at u [m/s]:

    part_scaling(self, scaling, v, z)       factors of the viscous, elastic and yield parts of the force
    yield_current(self, i, z)               effective current of the yield part, in A
    yield_speed(self, v, z)                 speed whose yield part `yield_shape` gets as `late`, in m/s
    yield_shape(self, shape, target, late, z)   yield part over its full size, NaN where the damper's own law holds;
                                            `target` is the damper's own at v, `late` that at the yield speed
    yield_force(self, force, z)             yield part in N, from that of a damper symmetric in both directions
    transmitted_share(self, h, v, demanded, z)  share of speed and force that a gap transmits, 0 to 1, of a damper that
                                            would bear `demanded` newton without it
    mount_force(self, force, z)             force in N of an elastic mount in series, NaN where there is none
    mount_stiffness(self, z)                its stiffness in N/m
    added_force(self, x, v, z)              force in N beside the damper's
    stiction(self, z)                       limit in N of a set-valued friction beside the damper's
    rates(self, x, v, u, i, demanded, target, z)    time derivative of z

On the seat, with the plant, suspension x [m], v [m/s] and cushion xc, vc:

    suspension_force(self, plant, x, v, z)  force in N beside the spring's, positive against extension
    linkage_friction(self, z)               limit in N of a set-valued friction in the linkage
    cushion_force(self, force, plant, xc, vc, z)    force of the cushion in N, positive in tension
    inner_mass(self, plant, z)              part of the driver's mass that is sprung, in kg
    inner_force(self, plant, z)             force in N with which it pushes the driver's body upward
    rates(self, plant, motion, z)           time derivative of z; `motion` is a `seatsim.kernel.rig.SeatMotion`
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from types import MappingProxyType
from typing import NamedTuple, TypeVar

from seatsim.compilation.jit import jit
from seatsim.kernel.hooks import method_of
from seatsim.rig.state import State
from seatsim.schema.errors import InputError, nearest
from seatsim.schema.fields import field_names
from seatsim.schema.registry import Record, Registry

_T = TypeVar("_T", bound=type)
_R = TypeVar("_R", bound=Record)
_Values = Mapping[str, float]

ON_DAMPER = (
    *("part_scaling", "transmitted_share", "mount_force", "mount_stiffness", "yield_current"),
    *("yield_speed", "yield_shape", "yield_force", "added_force", "stiction"),
)
"""Hooks of the time loop by which an effect acts on the damper."""
ON_SEAT = ("suspension_force", "linkage_friction", "cushion_force", "inner_mass", "inner_force")
"""Hooks of the time loop by which an effect acts on suspension, cushion or driver."""
_ONCE_A_RUN = ("plant", "coil", "factors", "temperature", "frame_force", "reading", "truth")
"""Hooks that are called once a run, in Python."""
_HOOKS = (*_ONCE_A_RUN, *ON_DAMPER, *ON_SEAT, "rates")


class Form(NamedTuple):
    """Start of a fit to a recording: the values of the parameters that it varies, and of those that it fixes.

    `within` bounds a free parameter more closely than its field does, where values beyond would mean another effect.
    The first `sizes` free parameters are sizes: the effect changes about the sum of what each changes alone. The others
    are its shape, which changes nothing without a size.
    """

    free: _Values
    fixed: _Values = MappingProxyType({})
    within: Mapping[str, tuple[float, float]] = MappingProxyType({})
    sizes: int = 1


class EffectSpecification(NamedTuple):
    """Specification of an effect.

    source: of the law. initial: its state at rest. off: parameters at which the rig is unchanged, where that is not
    zero. forms: model structures that a fit tries; parameters that a structure does not name stay off. suits: whether a
    model with the given damper record can lack the effect. by_channel: it acts on one recorded channel, which its
    parameter `channel` names. shown_by_fall: only a current that falls shows it; otherwise it is a constant shift.
    """

    source: str
    initial: State
    off: _Values
    forms: tuple[Form, ...]
    suits: Callable[[object], bool]
    by_channel: bool
    shown_by_fall: bool = False


EFFECTS: Registry[Record, EffectSpecification] = Registry("effect")
"""All effects by name."""


def effect(
    name: str,
    source: str = "",
    initial: State = (),
    off: _Values | None = None,
    forms: tuple[Form | _Values, ...] = (),
    suits: Callable[[object], bool] = lambda damper: True,
    by_channel: bool = False,
    shown_by_fall: bool = False,
) -> Callable[[_T], _T]:
    """Register a record class as `effect: name`, where the part before the dot is the block it lives in.

    The rest is that of `EffectSpecification`; a form without fixed parameters may be given by its free ones alone.

    Raises:
        InputError: the class has a method that is no hook, which nothing would ever call.
    """
    stated = tuple(form if isinstance(form, Form) else Form(form) for form in forms)
    specification = EffectSpecification(source, initial, off or {}, stated, suits, by_channel, shown_by_fall)
    enter = EFFECTS.register(name, specification)

    def check_and_enter(cls: _T) -> _T:
        for method, value in vars(cls).items():
            if callable(value) and not method.startswith("_") and method not in _HOOKS:
                hint = f"{nearest(method, _HOOKS)}; hooks: {', '.join(_HOOKS)}; a method of your own begins with '_'"
                raise InputError(f"effect '{name}': method '{method}' is no hook, so that nothing would call it{hint}")
        return enter(cls)

    return check_and_enter


@cache
def off(cls: type[_R]) -> _R:
    """Return the record of an effect at the parameters that leave the rig unchanged."""
    values = dict.fromkeys(field_names(cls), 0.0) | dict(EFFECTS.specification_of(cls).off)
    return cls(**values)


def same_place(first: Record, second: Record) -> bool:
    """Whether two effects are the same one at the same place: of one class and, where it has channels, on one."""
    return type(first) is type(second) and getattr(first, "channel", "") == getattr(second, "channel", "")


def replace_effects(present: Sequence[Record], others: Sequence[Record]) -> tuple[Record, ...]:
    """Return the effects of a rig with others, each of which replaces the one that is present at its place."""
    kept = [effect for effect in present if not any(same_place(effect, other) for other in others)]
    return (*kept, *others)


def acts_on(cls: type, hooks: tuple[str, ...]) -> bool:
    """Whether an effect has one of these hooks."""
    return any(method_of(cls, hook) for hook in hooks)


_REFERENCE_DEPTH = 0.01
"""m; depth at which the force of a buffer does not depend on its exponent."""

FRICTIONS: tuple[dict[str, float], ...] = (
    {"force": 20.0, "presliding": 2e-4},
    {"force": 20.0, "presliding": 1e-3, "lubrication": 20.0},
    {"force": 120.0, "presliding": 1e-3, "lubrication": 20.0},
    {"force": 20.0},
)
"""Starts of a friction's fit; the last is set-valued, as the record is by itself."""


@jit
def dahl_rate(presliding: float, v: float, z: float) -> float:
    """Return z' of Dahl's friction, `v (1 - z sgn v) / presliding`; 0 without presliding."""
    if presliding <= 0.0:
        return 0.0
    return v * (1.0 - z * math.copysign(1.0, v)) / presliding


@jit
def buffer(stiffness: float, damping: float, power: float, depth: float, speed: float) -> float:
    """Return the force in N of a buffer compressed by `depth`, which never pulls."""
    push = stiffness * depth * (1.0 + damping * speed)
    if power > 1.0:
        push *= (depth / _REFERENCE_DEPTH) ** (power - 1.0)
    return max(0.0, push)
