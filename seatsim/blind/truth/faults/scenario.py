"""What a fault scenario is: the effect and block it stands for, how its shape is drawn, how strong it can be."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal

from numpy.random import Generator

from seatsim.blind.labels import EFFECTS, Block

Shape = dict[str, float]
"""The drawn choices of a scenario (lengths, time constants, signs, seeds), without its severity."""
Value = float | tuple[float, ...]
"""One number, or one for each run."""
ForceKind = Literal["coloured", "hum", "knock"]
SensorFaultKind = Literal[
    "gain", "gain_bent", "bias", "wander", "lag_second", "lag_average", "skew", "quantise", "clip", "backlash",
    "crosstalk",
]  # fmt: skip


@dataclass(frozen=True)
class FrameForce:
    """A force on the frame that no channel records: rms in N; `detail` is the tone in Hz or the interval in s."""

    kind: ForceKind
    rms: float
    seed: int
    detail: float = 0.0


@dataclass(frozen=True)
class SensorFault:
    """A sensor fault: kind, channel, size (as `sensors` states), detail (0..1), seed, and the channel's spread."""

    kind: SensorFaultKind
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
    """What departs from the nominal rig: parameters, forces on the frame, sensor faults.

    `parameters` are those of `physics.parameters`, and `rate_factor`, by which the coil's true rate is multiplied.
    """

    parameters: Mapping[str, Value] = field(default_factory=dict)
    frame_forces: tuple[FrameForce, ...] = ()
    sensor_faults: tuple[SensorFault, ...] = ()

    def __add__(self, other: Changes) -> Changes:
        """Return both together; a parameter that both set has the other's value."""
        return Changes(
            {**self.parameters, **other.parameters},
            self.frame_forces + other.frame_forces,
            self.sensor_faults + other.sensor_faults,
        )


@dataclass(frozen=True)
class Context:
    """What a scenario may know of the rig without it, so that its sizes fit the motion."""

    spread: Mapping[str, float]
    """Standard deviation by channel, in the channel's unit."""
    x_peak: float
    """Largest suspension displacement, m."""
    y_peak: float
    """Deflection of the cushion under the largest upward acceleration of the driver, m."""
    tension_peak: float
    """Tension that the cushion would need for the largest downward acceleration of the driver, N."""
    channels: tuple[str, ...]
    """Channels that are recorded."""
    is_bingham: bool


Draw = Callable[[Generator, Context], Shape]
Build = Callable[[float, Shape, Context], Changes]


@dataclass(frozen=True)
class FaultScenario:
    """One way in which an effect, or something outside the library, may be at work.

    `draw` chooses the shape; `build` turns severity and shape into changes and is off at severity zero; `span` holds
    the severities that are plausible on a real rig, 1 being a common one. `bingham`: it needs the Bingham damper.
    """

    name: str
    effect: str
    block: Block
    draw: Draw
    build: Build
    span: tuple[float, float] = (0.02, 30.0)
    bingham: bool = False

    @property
    def outside(self) -> bool:
        """Whether the library has no such effect."""
        return self.effect not in EFFECTS


def set_parameters(**values: Value) -> Changes:
    """Return changes of parameters only."""
    return Changes(dict(values))


def draw_nothing(rng: Generator, _: Context) -> Shape:
    """Return an empty shape, for scenarios that have a severity alone."""
    return {}


def draw_seed(rng: Generator) -> float:
    """Draw a seed that fits a float, as all numbers of a shape are."""
    return float(rng.integers(1, 1_000_000))
