"""What a truth form is: a name, the effect and block it stands for, how its shape is drawn, how strong it can be."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from numpy.random import Generator

Shape = dict[str, float]
"""The drawn choices of a form (lengths, time constants, signs, seeds), without its strength."""
Value = float | tuple[float, ...]
"""One number, or one for each run."""
BLOCKS = ("damper", "coil", "suspension", "cushion", "driver", "floor", "sensor")
EFFECTS = (
    "damper.thermal_fade", "damper.gas_spring", "damper.asymmetry", "damper.preyield_hysteresis",
    "damper.magnetic_saturation", "damper.remanence", "damper.free_play", "damper.seal_friction",
    "coil.lag", "coil.asymmetric_lag", "coil.delay", "coil.current_limit",
    "suspension.friction", "suspension.end_stop", "suspension.progressive_spring",
    "cushion.hardening", "cushion.separation", "driver.mass", "driver.biodynamics", "floor.unmeasured_input",
    "sensor.gain", "sensor.bias", "sensor.lag", "sensor.clock_skew",
)  # fmt: skip
"""The library of the contract, section 5."""


@dataclass(frozen=True)
class Push:
    """A force on the frame that no channel records: `kind` is coloured, hum or knock; rms in N."""

    kind: str
    rms: float
    seed: int
    detail: float = 0.0


@dataclass(frozen=True)
class Fault:
    """A sensor fault: kind, channel, size (as `sensors` states), detail, seed, and the channel's spread."""

    kind: str
    channel: str
    size: float
    detail: float = 0.0
    seed: int = 0
    scale: float = 1.0

    @property
    def on_input(self) -> bool:
        """Whether a replay is driven by what the fault touches."""
        return self.kind == "skew" or self.channel == "floor_acceleration"


@dataclass(frozen=True)
class Changes:
    """What departs from the nominal rig: slots of the record, forces on the frame, sensor faults."""

    slots: Mapping[str, Value] = field(default_factory=dict)
    pushes: tuple[Push, ...] = ()
    faults: tuple[Fault, ...] = ()

    def __add__(self, other: Changes) -> Changes:
        """Return both together."""
        return Changes({**self.slots, **other.slots}, self.pushes + other.pushes, self.faults + other.faults)


@dataclass(frozen=True)
class Context:
    """What a form may know of the rig without it: spread of each channel, largest travel, foam stroke, tension."""

    spread: Mapping[str, float]
    x_peak: float
    y_peak: float
    tension_peak: float
    channels: tuple[str, ...]
    is_bingham: bool


Draw = Callable[[Generator, Context], Shape]
Build = Callable[[float, Shape, Context], Changes]


@dataclass(frozen=True)
class Truth:
    """One form of an effect (or of something outside the library).

    `draw` chooses the shape; `build` turns severity and shape into changes and is off at severity zero; `span` holds
    the severities that are plausible on a real rig, 1 being a common one.
    """

    name: str
    effect: str
    block: str
    draw: Draw
    build: Build
    span: tuple[float, float] = (0.02, 30.0)
    bingham: bool = False
    warm: bool = False
    needs: tuple[str, ...] = ()

    @property
    def outside(self) -> bool:
        """Whether the library has no such effect."""
        return self.effect not in EFFECTS


def slots(**values: Value) -> Changes:
    """Return changes of slots only."""
    return Changes(dict(values))


def seed(rng: Generator) -> float:
    """Draw a seed that fits a float."""
    return float(rng.integers(1, 1_000_000))
