"""The interface of a control law.

A law is a record (NamedTuple) of its keys. At every sampling instant it sees a `Measurement` and its own state, a tuple
of floats, and returns *one* of

    def wanted_force(self, y, state):    wanted damper force in N, positive when it opposes extension   `ForceLaw`
    def wanted_current(self, y, state):  wanted coil current in A                                       `CurrentLaw`

and, where it has a state, with `def update(self, y, state)`, the state for the next instant. Methods are compiled by
numba: plain arithmetic and `math` only. The scenario's inverse damper turns a wanted force into a current.

A law that is designed for its seat returns its compiled form, another such record, from *one* of

    def prepared(self, plant)                                                                           `PreparedLaw`
    def sampled(self, plant, coil, sample_time)     where the design needs the coil, or the time        `SampledLaw`
                                                    in s between samples
    def on_floors(self, plant, coil, sample_time, floors)     where it needs the motion of the floor    `FloorLaw`

and a compiled form with `def notes(self)` (`LawWithNotes`) returns sentences for the user after a run. A law whose
design can be reported and saved fulfils `seatsim.rig.designs.SynthesisedLaw` too.

`Measurement` holds the true states, unless the scenario gives the law sensors (see `seatsim.rig.sensors`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple, Protocol, TypeVar, runtime_checkable

from seatsim.rig.coil import Coil
from seatsim.rig.plant import Plant
from seatsim.schema.arrays import Array
from seatsim.schema.registry import Record, Registry

_T = TypeVar("_T", bound=type)
State = tuple[float, ...]
"""State of a law between two sampling instants; empty where it has no memory."""


class Measurement(NamedTuple):
    """What a law sees at a sampling instant; SI units, degrees Celsius, upward positive.

    `displacement` and `velocity` are those of the suspension, positive in extension; `replayed` is the recorded
    command in A, NaN where there is none.
    """

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


@runtime_checkable
class ForceLaw(Protocol):
    """A compiled form that wants a damper force, which the inverse damper turns into a current."""

    def wanted_force(self, y: Measurement, state: State) -> float:
        """Return the wanted damper force in N, positive when it opposes extension."""


@runtime_checkable
class CurrentLaw(Protocol):
    """A compiled form that wants a coil current."""

    def wanted_current(self, y: Measurement, state: State) -> float:
        """Return the wanted coil current in A; the loop clips it to what the coil can carry."""


@runtime_checkable
class LawWithMemory(Protocol):
    """A compiled form whose output depends on earlier measurements."""

    def update(self, y: Measurement, state: State) -> State:
        """Return the state at the next sampling instant."""


@runtime_checkable
class LawWithNotes(Protocol):
    """A compiled form that has notes after a run."""

    def notes(self) -> tuple[str, ...]:
        """Return sentences for the user; called once, after the run."""


CompiledLaw = ForceLaw | CurrentLaw
"""A compiled form that the loop evaluates at every sampling instant."""


@runtime_checkable
class PreparedLaw(Protocol):
    """A law that is designed for the seat alone."""

    def prepared(self, plant: Plant) -> CompiledLaw:
        """Return the compiled form for a nominal seat."""


@runtime_checkable
class SampledLaw(Protocol):
    """A law that is designed for the seat, the coil and the time between samples."""

    def sampled(self, plant: Plant, coil: Coil, sample_time: float) -> CompiledLaw:
        """Return the compiled form for a nominal seat and coil, evaluated every `sample_time` seconds."""


class FloorRecord(NamedTuple):
    """Acceleration of a floor in m/s^2, shape (N,), sampled every `step` seconds."""

    step: float
    acceleration: Array


Floors = Callable[[], Sequence[FloorRecord]]
"""Function that gives a record of every floor that a law is designed for; called only where the design needs them."""


def no_floors() -> Sequence[FloorRecord]:
    """Return no floor: for laws whose design needs none."""
    return ()


@runtime_checkable
class FloorLaw(Protocol):
    """A law that is designed for the seat and the floors under it."""

    def on_floors(self, plant: Plant, coil: Coil, sample_time: float, floors: Floors) -> CompiledLaw:
        """Return the compiled form for a nominal seat and coil on these floors."""


Law = CompiledLaw | PreparedLaw | SampledLaw | FloorLaw
"""What a scenario may name as its `law`."""


def prepare_law(law: Law, plant: Plant, coil: Coil, sample_time: float, floors: Floors = no_floors) -> CompiledLaw:
    """Return the compiled form of a law, designed for the nominal rig where the law has a design.

    Args:
        law: the record that a scenario names.
        plant: the nominal seat without effects, since a designer does not know them.
        coil: the nominal coil.
        sample_time: in s between two evaluations.
        floors: gives a record of every floor that the law is designed for.
    """
    # Of several methods the one is preferred that designs with more information.
    if isinstance(law, FloorLaw):
        return law.on_floors(plant, coil, sample_time, floors)
    if isinstance(law, SampledLaw):
        return law.sampled(plant, coil, sample_time)
    return law.prepared(plant) if isinstance(law, PreparedLaw) else law


class LawSpecification(NamedTuple):
    """Specification of a law: initial value of its state, whether it replays a recording row by row, its source."""

    initial: State
    replays: bool
    source: str


LAWS: Registry[Record, LawSpecification] = Registry("law")
"""All control laws by name."""


def law(name: str, initial: State = (), replays: bool = False, source: str = "") -> Callable[[_T], _T]:
    """Register a record class as the control law `law: name` with the `initial` value of its state."""
    return LAWS.register(name, LawSpecification(initial, replays, source))
