"""What an effect is: a small physical change of the simulated rig, switched on in a scenario.

An effect is a record of parameters, named `block.effect`. It acts through whichever of these methods it has; each
returns its argument unchanged where the parameters are off.

Before a run, in Python:

    plant(self, plant)                  parameters of the seat
    coil(self, coil)                    parameters of the coil
    factors(self, factors)              temperature factors of the damper
    temperature(self, step, values)     temperature of the fluid out of that of the thermocouple
    push(self, time, seed)              force on the frame in N, added to what other effects push
    reading(self, channel, step, values)    what a sensor says out of what is true
    truth(self, channel, step, values)      what is true out of what a sensor says

In the time loop, compiled by numba, with `z` the effect's own state:

    on the damper       conditioned(self, scaling, v, z)   yield_current(self, i, z)   yield_speed(self, v, z)
                        yield_shape(self, shape, target, late, z)   yield_force(self, force, z)
                        engaged(self, h, v, pull, z)   mount_force(self, force, z)   mount_stiffness(self, z)
                        added_force(self, x, v, z)   stiction(self, z)   rates(self, x, v, u, i, pull, target, z)
    on the seat         suspension_force(self, plant, x, v, z)   linkage_friction(self, z)
                        cushion_force(self, force, plant, xc, vc, z)
                        inner_mass(self, plant, z)   inner_force(self, plant, z)   rates(self, plant, motion, z)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple, TypeVar

from seatsim.schema.fields import field_names
from seatsim.schema.registry import Record, Registry

T = TypeVar("T", bound=type)
R = TypeVar("R", bound=Record)
Values = Mapping[str, float]

ON_DAMPER = (
    "conditioned", "engaged", "mount_force", "mount_stiffness", "yield_current", "yield_speed", "yield_shape",
    "yield_force", "added_force", "stiction",
)  # fmt: skip
ON_SEAT = ("suspension_force", "linkage_friction", "cushion_force", "inner_mass", "inner_force")


class Form(NamedTuple):
    """Where a fit to a recording starts: the values of the parameters it frees, and of others that it fixes.

    `within` bounds a free parameter more closely than its field does, where beyond it would be another effect.
    """

    free: Values
    fixed: Values = MappingProxyType({})
    within: Mapping[str, tuple[float, float]] = MappingProxyType({})


class EffectSpecification(NamedTuple):
    """What is stated of an effect.

    source: of the law. initial: its state at rest. off: parameters at which the rig is unchanged, where that is not
    zero. forms: functional forms in which a recording may show it; what a form does not name stays off. suits: whether
    it can be missing in a model whose damper is `record`. by_channel: it acts on one recorded channel, which its
    parameter `channel` names.
    """

    source: str
    initial: tuple[float, ...]
    off: Values
    forms: tuple[Form, ...]
    suits: Callable[[Any], bool]
    by_channel: bool


EFFECTS: Registry[Record, EffectSpecification] = Registry("effect")
"""All effects by name."""


def effect(
    name: str,
    source: str = "",
    initial: tuple[float, ...] = (),
    off: Values | None = None,
    forms: tuple[Form | Values, ...] = (),
    suits: Callable[[Any], bool] = lambda damper: True,
    by_channel: bool = False,
) -> Callable[[T], T]:
    """Register a record class as `effect: name`, where the part before the dot is the block it lives in."""
    stated = tuple(form if isinstance(form, Form) else Form(form) for form in forms)
    return EFFECTS.register(name, EffectSpecification(source, initial, off or {}, stated, suits, by_channel))


def off(cls: type[R]) -> R:
    """Return the record of an effect at the parameters that leave the rig unchanged."""
    values = dict.fromkeys(field_names(cls), 0.0) | dict(EFFECTS.specification_of(cls).off)
    return cls(**values)


def acts_on(cls: type, hooks: tuple[str, ...]) -> bool:
    """Whether an effect has one of these hooks of the time loop."""
    return any(hasattr(cls, hook) for hook in hooks)
