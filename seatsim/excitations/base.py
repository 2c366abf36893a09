"""Definition of an excitation: a record of keys that yields the motion of the floor; keys that several share."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Annotated, Literal, NamedTuple, Protocol, TypeVar

import numpy as np
from pydantic import Field
from pydantic.fields import FieldInfo

from seatsim.schema.arrays import Array, require_samples
from seatsim.schema.errors import RunError
from seatsim.schema.fields import param
from seatsim.schema.registry import Record, Registry

_FEWEST = 2
"""Samples of a floor that make a step."""
_T = TypeVar("_T", bound=type)


class Floor(NamedTuple):
    """Vertical motion of the cab floor, sampled every `step` seconds from time zero; upward positive.

    The simulation takes the acceleration as linear between samples; velocity and displacement are what laws
    and transmissibility need, consistent with it and free of drift.
    """

    step: float
    acceleration: Array
    velocity: Array
    displacement: Array
    command: Array | None = None
    coil_current: Array | None = None
    temperature: Array | None = None

    @property
    def time(self) -> Array:
        """Time of each sample in s, shape (N,)."""
        return self.step * np.arange(len(self.acceleration), dtype=np.float64)


class Excitation(Record, Protocol):
    """A record (NamedTuple) of keys; `floor` turns them into motion."""

    def floor(self, step: float, seed: int) -> Floor:
        """Return the floor's motion sampled every `step` seconds; every random draw derives from `seed`."""


class _ExcitationSpecification(NamedTuple):
    """Specification of an excitation: its source (standard and clause) where there is one."""

    source: str


EXCITATIONS: Registry[Excitation, _ExcitationSpecification] = Registry("excitation")
"""All excitations by name."""


def excitation(name: str, source: str = "") -> Callable[[_T], _T]:
    """Register a record class as the excitation `kind: name`; what its method `floor` gives is checked from then on."""
    enter = EXCITATIONS.register(name, _ExcitationSpecification(source))

    def check(cls: _T) -> _T:
        cls.floor = _checked(cls.floor)  # type: ignore[attr-defined]
        return enter(cls)

    return check


def _checked(make: Callable[[Excitation, float, int], Floor]) -> Callable[[Excitation, float, int], Floor]:
    """Return a method `floor` that raises RunError where its motion is none that compiled code can read."""

    @wraps(make)
    def floor(self: Excitation, step: float, seed: int) -> Floor:
        made, giver = make(self, step, seed), f"the excitation {type(self).__module__}:{type(self).__qualname__}"
        if not isinstance(made, Floor):
            raise RunError(f"{giver} gives {type(made).__name__}; its method floor must return a Floor")
        count = np.size(made.acceleration)
        if made.step != step or count < _FEWEST:
            problem = f"{giver} gives {count} samples every {made.step} s; asked for: {_FEWEST} or more every {step} s"
            raise RunError(problem)
        read = {
            name: require_samples(values, f"the {name} of {giver}", count, step)
            for name, values in made._asdict().items()
            if name != "step" and values is not None
        }
        return Floor(step, **read)

    return floor


def choice(meaning: str, unit: str = "") -> FieldInfo:
    """Describe a key that has no numeric bounds of its own: a choice, a list or a nested record."""
    described: FieldInfo = Field(description=meaning, json_schema_extra={"unit": unit})
    return described


DURATION = param("s", "length of the run", above=0, high=7200)
Duration = Annotated[float, DURATION]
SPEED = param("m/s", "constant vehicle speed", low=1, high=60, usual=(1, 45))
Speed = Annotated[float, SPEED]
Through = Annotated[
    Literal["vehicle", "direct"],
    choice("path from road to floor: 'vehicle' (tyre, body and cab mounts) or 'direct' (the floor is the road)"),
]
Quantity = Annotated[
    Literal["displacement", "acceleration"],
    choice("what the amplitude is of: displacement in m or acceleration in m/s^2"),
]
