"""A scenario: everything that one run is made of, validated and frozen."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Annotated, Any, NamedTuple

from seatsim.dampers.base import Damper
from seatsim.rig.coil import Coil
from seatsim.rig.control import Law
from seatsim.rig.drivers import Driver
from seatsim.rig.plant import Plant
from seatsim.rig.sensors import Sensors
from seatsim.rig.temperature import TemperatureFactors, Thermal
from seatsim.scenario.checks import Check
from seatsim.schema.errors import InputError
from seatsim.schema.fields import param
from seatsim.schema.registry import Record
from seatsim.schema.yaml_source import Source


class Solver(NamedTuple):
    """Settings of the time integration; the defaults meet the accuracy stated in the documentation."""

    step: Annotated[float, param("s", "step of loop and history", above=0, high=0.01)] = 0.001
    tolerance: Annotated[float, param("-", "relative error of a sub-step's velocities", above=0, high=1)] = 1e-4


class Start(NamedTuple):
    """Where the suspension is at time zero, for release tests; the cushion is at rest and unstrained."""

    displacement: Annotated[float, param("m", "suspension displacement", low=-10, high=10, usual=(0.0005, 0.12))] = 0.0
    velocity: Annotated[float, param("m/s", "suspension velocity", low=-100, high=100)] = 0.0


@dataclass(frozen=True)
class DamperChoice:
    """A damper with its parameters and its temperature factors."""

    record: Damper
    factors: TemperatureFactors


@dataclass(frozen=True)
class Inverse:
    """The damper that the inverse assumes, at the temperature in degC that it assumes (None: the measured one)."""

    damper: DamperChoice
    temperature: float | None


@dataclass(frozen=True)
class Control:
    """A control law, its sample time in s (None: 1 ms, or every step for a law that replays), inverse and sensors.

    Without sensors the law sees the true states.
    """

    law: Law
    sample_time: float | None
    inverse: Inverse | None
    sensors: Sensors | None = None


@dataclass(frozen=True)
class Scenario:
    """One run. A damper bench has no plant, control or excitation.

    `label` holds what sets this run apart from the others of its file; `source` is the content of the file behind it.
    """

    name: str
    damper: DamperChoice
    coil: Coil
    temperature: float | Thermal
    plant: Plant | None = None
    driver: Driver = field(default_factory=Driver)
    control: Control | None = None
    excitation: Any = None  # an `Excitation` of the package above, or None on a bench
    effects: tuple[Record, ...] = ()
    solver: Solver = field(default_factory=Solver)
    start: Start = field(default_factory=Start)
    seed: int = 0
    checks: tuple[Check, ...] = ()
    label: Mapping[str, Any] = field(default_factory=dict)
    source: Source | None = None

    @property
    def title(self) -> str:
        """Name of the scenario with what sets this run apart."""
        parts = [str(v) if k == "variant" else f"{k.split('.')[-1]} {v}" for k, v in self.label.items()]
        return f"{self.name} ({', '.join(parts)})" if parts else self.name

    @property
    def rig(self) -> str:
        """Rig and excitation without the control: runs of one rig are alternatives to each other."""
        damper, drive = (self.damper, self.coil.max_current, self.temperature), (self.excitation, self.seed, self.start)
        return repr((self.plant, self.driver, damper, drive, self.effects, self.solver))

    @contextmanager
    def placed(self, *keys: str) -> Iterator[None]:
        """Give errors about a section of the scenario their place in its file."""
        try:
            yield
        except InputError as error:
            place = self.source.place(keys) if self.source else f"{self.name}, {'.'.join(keys)}"
            raise InputError(f"{place}: {error}") from error
