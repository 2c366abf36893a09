"""A scenario: everything that one run is made of, validated and frozen; its condition, and what its designer chose.

Conditions are the floor, the seed, the temperature, the driver and the start: nobody chooses the weather. All else is a
choice: law, damper, coil, springs. Runs under one condition are alternatives to each other.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from typing import Annotated, Any, NamedTuple, TypeVar

from seatsim.dampers.base import Damper
from seatsim.rig.coil import Coil
from seatsim.rig.control import Law
from seatsim.rig.drivers import Driver
from seatsim.rig.plant import Plant
from seatsim.rig.sensors import Sensors
from seatsim.rig.temperature import TemperatureFactors, Thermal
from seatsim.scenario.checks import Check
from seatsim.schema.errors import placed
from seatsim.schema.fields import param
from seatsim.schema.registry import Record, name_of
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

    Without sensors the law sees the true states. `floors` are the excitations that the law is designed for, where its
    design asks for any; none: the scenario's own.
    """

    law: Law
    sample_time: float | None
    inverse: Inverse | None
    sensors: Sensors | None = None
    floors: tuple[Any, ...] = ()  # of `Excitation`, as `Scenario.excitation`


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
    label: Mapping[str, Any] = field(default_factory=dict, hash=False)
    source: Source | None = field(default=None, hash=False)

    def __repr__(self) -> str:
        """Name the scenario and its file."""
        return f"<Scenario {self.title}{f' of {self.source.path}' if self.source else ''}>"

    @property
    def title(self) -> str:
        """Name of the scenario with what sets this run apart."""
        parts = [str(v) if k == "variant" else f"{k.split('.')[-1]} {v}" for k, v in self.label.items()]
        return f"{self.name} ({', '.join(parts)})" if parts else self.name

    def place(self, *keys: str) -> str:
        """Return the place of a key in the scenario's file."""
        return self.source.place(keys) if self.source else f"{self.name}, {'.'.join(keys)}"

    def placed(self, *keys: str) -> AbstractContextManager[None]:
        """Give errors about a section of the scenario their place in its file."""
        return placed(self.place(*keys))


_CONDITIONS = ("excitation", "seed", "temperature", "driver", "start", "plant.driver_mass")
"""Sections and keys of a file that state a condition."""
_OF_CONDITIONS = ("driver.", "floor.")
"""Beginnings of the names of effects that act on driver or floor."""
_T = TypeVar("_T")


def is_condition(key: str) -> bool:
    """Return whether a dotted key of a scenario file, such as `excitation.speed`, states a condition."""
    return any(key == known or key.startswith(f"{known}.") for known in _CONDITIONS)


def condition_of(scenario: Scenario) -> str:
    """Return the condition of a run as a text that is equal where the condition is."""
    driver = (scenario.plant.driver_mass if scenario.plant else None, scenario.driver)
    floor = (scenario.excitation, scenario.seed, scenario.start)
    return repr((floor, scenario.temperature, driver, [each for each in scenario.effects if _is_outside(each)]))


def choice_of(scenario: Scenario) -> str:
    """Return what its designer chose of a run as a text that is equal where the choice is."""
    seat = scenario.plant._replace(driver_mass=0.0) if scenario.plant else None
    rig = (seat, scenario.damper, scenario.coil, [each for each in scenario.effects if not _is_outside(each)])
    return repr((rig, scenario.control, scenario.solver))


def _is_outside(effect: Record) -> bool:
    return name_of("effect", type(effect)).startswith(_OF_CONDITIONS)


def group_by_condition(items: Iterable[tuple[Scenario, _T]]) -> list[list[_T]]:
    """Return what belongs to scenarios, in groups of one condition each, in the order given."""
    groups: dict[str, list[_T]] = {}
    for scenario, item in items:
        groups.setdefault(condition_of(scenario), []).append(item)
    return list(groups.values())


def is_passive(scenario: Scenario) -> bool:
    """Return whether the current of a run is constant, whatever the seat does."""
    return scenario.control is not None and name_of("law", type(scenario.control.law)) == "constant"
