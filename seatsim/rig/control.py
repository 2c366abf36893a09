"""The contract that a control law fulfils.

A law is a record (NamedTuple) of its keys. At every sampling instant it sees a `Measurement` and its own state, a tuple
of floats, and answers with *one* of

    def wanted_force(self, y, state):    wanted damper force in N, positive when it opposes extension
    def wanted_current(self, y, state):  wanted coil current in A

and, where it has a state, with `def update(self, y, state)`, the state for the next instant. Methods are compiled by
numba: plain arithmetic and `math` only. A law that wants a force is served through the inverse damper of the scenario.

A law that is designed for its seat returns its compiled form, another such record, from *one* of

    def prepared(self, plant)
    def sampled(self, plant, coil, sample_time)     where the design needs the coil, or the time in s between samples

and a compiled form with `def notes(self)` returns sentences for the user after a run.

`Measurement` holds the true states, unless the scenario gives the law sensors (see `seatsim.rig.sensors`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, TypeVar

from seatsim.schema.registry import Record, Registry

T = TypeVar("T", bound=type)


class Measurement(NamedTuple):
    """What a law sees at a sampling instant; SI units, degrees Celsius, upward positive."""

    time: float
    displacement: float
    velocity: float
    frame_velocity: float
    driver_velocity: float
    floor_acceleration: float
    frame_acceleration: float
    driver_acceleration: float
    damper_force: float
    current: float
    temperature: float
    replayed: float


class LawSpecification(NamedTuple):
    """What is stated of a law: initial value of its state, whether it replays a recording row by row, its source."""

    initial: tuple[float, ...]
    replays: bool
    source: str


LAWS: Registry[Record, LawSpecification] = Registry("law")
"""All control laws by name."""


def law(name: str, initial: tuple[float, ...] = (), replays: bool = False, source: str = "") -> Callable[[T], T]:
    """Register a record class as the control law `law: name` with the `initial` value of its state."""
    return LAWS.register(name, LawSpecification(initial, replays, source))
