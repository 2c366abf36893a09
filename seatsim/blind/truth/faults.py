"""What a fault scenario is: the effect and block it stands for, how its shape is drawn, how strong it can be.

`damper_faults` and `seat_faults` hold the forms of the contract's effects, `outside_faults` what a real rig may do
besides. None holds an equation of motion: those are in `damper`, `coil`, `seat` and `sensors`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal

from numpy.random import Generator

from seatsim.blind.sealed import BLOCKS, EFFECTS, Block

Shape = dict[str, float]
"""The drawn choices of a scenario (lengths, time constants, signs, seeds), without its severity."""
_Value = float | tuple[float, ...]
"""One number, or one for each run."""
_ForceKind = Literal["coloured", "hum", "knock"]
_Misreading = Literal["gain", "gain_bent", "bias", "wander", "lag_second", "lag_average"]
"""Of the contract's effects, beside a log that is skewed; others are outside the library."""
_SensorFaultKind = _Misreading | Literal["skew", "quantise", "clip", "backlash", "crosstalk"]
_FAULTY_CHANNELS = (
    "frame_acceleration",
    "driver_acceleration",
    "suspension_displacement",
    "damper_force",
    "coil_current",
    "floor_acceleration",
)
"""Channels that a sensor fault can sit on, where they are recorded."""
NEIGHBOUR = {
    "frame_acceleration": "driver_acceleration",
    "driver_acceleration": "frame_acceleration",
    "suspension_displacement": "frame_acceleration",
    "damper_force": "suspension_displacement",
    "coil_current": "damper_force",
    "floor_acceleration": "frame_acceleration",
}
"""The channel that couples into each, where channels are not kept apart."""


@dataclass(frozen=True)
class FrameForce:
    """A force on the frame that no channel records: rms in N; `detail` is the tone in Hz or the interval in s."""

    kind: _ForceKind
    rms: float
    seed: int
    detail: float = 0.0


@dataclass(frozen=True)
class SensorFault:
    """A sensor fault: kind, channel, size (as `sensors` states), detail (0..1), seed, and the channel's spread."""

    kind: _SensorFaultKind
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

    `parameters` are those of `parameters`, and `rate_factor`, by which the coil's true rate is multiplied.
    """

    parameters: Mapping[str, _Value] = field(default_factory=dict)
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


_Draw = Callable[[Generator, Context], Shape]
_Build = Callable[[float, Shape, Context], Changes]


@dataclass(frozen=True)
class FaultScenario:
    """One way in which an effect, or something outside the library, may be at work.

    `draw` chooses the shape; `build` turns a severity above zero and a shape into changes; `span` holds the severities
    that are plausible on a real rig, 1 being a common one. `bingham`: it needs the Bingham damper.
    """

    name: str
    effect: str
    block: Block
    span: tuple[float, float]
    draw: _Draw
    build: _Build
    bingham: bool = False

    @property
    def outside(self) -> bool:
        """Whether the library has no such effect."""
        return self.effect not in EFFECTS


def drawn(**ranges: tuple[float, float] | list[float]) -> _Draw:
    """Return what draws a shape: by name and in order, a number between two ends or one of a list."""

    def draw(rng: Generator, _: Context) -> Shape:
        return {
            name: float(rng.choice(ends)) if isinstance(ends, list) else rng.uniform(*ends)
            for name, ends in ranges.items()
        }

    return draw


def enter(
    scenarios: dict[str, FaultScenario],
    name: str,
    effect: str,
    span: tuple[float, float],
    draw: _Draw = drawn(),  # noqa: B008 - it returns a function without state
    *,
    bingham: bool = False,
) -> Callable[[_Build], _Build]:
    """Return what enters a function as the `build` of a scenario; their order is part of what a seed means.

    `effect` is one of the library, or `BLOCK.outside`.
    """

    def enter_build(build: _Build) -> _Build:
        block, _, kind = effect.partition(".")
        known = next(each for each in BLOCKS if each == block)
        named = kind if kind == "outside" else effect
        scenarios[name] = FaultScenario(name, named, known, span, draw, build, bingham)
        return build

    return enter_build


def set_parameters(**values: _Value) -> Changes:
    """Return changes of parameters only."""
    return Changes(dict(values))


def draw_seed(rng: Generator) -> float:
    """Draw a seed that fits a float, as all numbers of a shape are."""
    return float(rng.integers(1, 1_000_000))


def draw_channel(rng: Generator, context: Context) -> Shape:
    """Draw the channel (as its place in `_FAULTY_CHANNELS`), a sign, a detail and a seed."""
    there = [k for k, name in enumerate(_FAULTY_CHANNELS) if name in context.channels]
    channel, sign = float(rng.choice(there)), float(rng.choice([-1.0, 1.0]))
    return {"channel": channel, "sign": sign, "detail": rng.uniform(0.0, 1.0), "seed": draw_seed(rng)}


def fault_channel(kind: _SensorFaultKind, size: float, shape: Shape, context: Context) -> Changes:
    """Return one fault on the drawn channel."""
    name = drawn_channel(shape)
    fault = SensorFault(kind, name, size, shape["detail"], int(shape["seed"]), context.spread[name])
    return Changes(sensor_faults=(fault,))


def drawn_channel(shape: Shape) -> str:
    """Return the channel that `draw_channel` drew."""
    return _FAULTY_CHANNELS[int(shape["channel"])]
