"""What a fault scenario is: the effect it stands for, how its shape is drawn, how strong it can be, what it changes.

The scenarios themselves stand in `faults.yaml`: forms of the contract's effects, and what a real rig may do besides.
None holds an equation of motion: those are in `damper`, `coil`, `seat` and `experiment`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal, NamedTuple

from numpy.random import Generator

from seatsim.blind.sealed import EFFECTS
from seatsim.schema.fields import read_packaged

Shape = dict[str, float]
"""The drawn choices of a scenario (lengths, time constants, signs, seeds), without its severity."""
_Value = float | tuple[float, ...]
"""One number, or one for each run."""
_ForceKind = Literal["coloured", "hum", "knock"]
_Misreading = Literal["gain", "gain_bent", "bias", "wander", "lag_second", "lag_average"]
"""Of the contract's effects, beside a log that is skewed; others are outside the library."""
_SensorFaultKind = Literal[_Misreading, "skew", "quantise", "clip", "backlash", "crosstalk"]
NEIGHBOUR = read_packaged(Path(__file__).with_name("neighbours.yaml"), dict[str, str])
"""The channel that couples into each, where channels are not kept apart."""
_FAULTY_CHANNELS = tuple(NEIGHBOUR)
"""Channels that a sensor fault can sit on, where they are recorded."""


class FrameForce(NamedTuple):
    """A force on the frame that no channel records: rms in N; `detail` is the tone in Hz or the interval in s."""

    kind: _ForceKind
    rms: float
    seed: int
    detail: float = 0.0


class SensorFault(NamedTuple):
    """A sensor fault: kind, channel, size (see `apply_fault`), detail (0..1), seed, and the channel's spread."""

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

    `parameters` are those of `parameters.yaml`, and `rate_factor`, by which the coil's true rate is multiplied.
    """

    parameters: Mapping[str, _Value] = field(default_factory=dict)
    frame_forces: tuple[FrameForce, ...] = ()
    sensor_faults: tuple[SensorFault, ...] = ()

    def __add__(self, other: Changes) -> Changes:
        """Return both together; a parameter that both set has the other's value."""
        forces, faults = self.frame_forces + other.frame_forces, self.sensor_faults + other.sensor_faults
        return Changes({**self.parameters, **other.parameters}, forces, faults)


class Context(NamedTuple):
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


class _Force(NamedTuple):
    """A force on the frame: formulas of its rms and detail."""

    kind: _ForceKind
    rms: str
    detail: str | float = 0.0


class _Sensor(NamedTuple):
    """A fault of the drawn channel, or of the controller's log: formulas of its size and detail."""

    kind: _SensorFaultKind
    size: str
    detail: str | float = "detail"


@dataclass(frozen=True)
class FaultScenario:
    """One way in which an effect, or something outside the library (`BLOCK.outside`), may be at work.

    `span` holds the severities that are plausible on a real rig; `bingham`: it needs the Bingham damper. The rest are
    formulas, as `faults.yaml` explains them.
    """

    name: str
    effect: str
    span: tuple[float, float]
    drawn: Mapping[str, str] = field(default_factory=dict)
    parameters: Mapping[str, str | float | list[str]] = field(default_factory=dict)
    force: _Force | None = None
    sensor: _Sensor | None = None
    bingham: bool = False

    @property
    def block(self) -> str:
        """The block that it lives in."""
        return self.effect.partition(".")[0]

    @property
    def outside(self) -> bool:
        """Whether the library has no such effect."""
        return self.effect not in EFFECTS

    def draw(self, rng: Generator, context: Context) -> Shape:
        """Draw the shape."""
        there = [k for k, name in enumerate(_FAULTY_CHANNELS) if name in context.channels]
        known: dict[str, object] = {
            "uniform": rng.uniform,
            "sign": lambda: rng.choice([-1.0, 1.0]),
            "seed": lambda: rng.integers(1, 1_000_000),
            "channel": lambda: rng.choice(there),
            **_list_peaks(context),
        }
        return {name: _evaluate(formula, known) for name, formula in self.drawn.items()}

    def build(self, severity: float, shape: Shape, context: Context) -> Changes:
        """Return the changes at a severity above zero."""
        known: dict[str, object] = {**_list_peaks(context), **shape, "s": severity}
        channel = _FAULTY_CHANNELS[int(shape.get("channel", 0.0))]
        spread = context.spread[channel]
        known |= {"spread": spread, "neighbour_spread": context.spread[NEIGHBOUR[channel]]}
        changes = Changes({name: _evaluate_runs(formula, known) for name, formula in self.parameters.items()})
        seed = int(shape.get("seed", 0.0))
        if self.force:
            rms, detail = _evaluate(self.force.rms, known), _evaluate(self.force.detail, known)
            changes += Changes(frame_forces=(FrameForce(self.force.kind, rms, seed, detail),))
        if self.sensor:
            size, detail = _evaluate(self.sensor.size, known), _evaluate(self.sensor.detail, known)
            where = ("log", 1.0) if self.sensor.kind == "skew" else (channel, spread)
            changes += Changes(sensor_faults=(SensorFault(self.sensor.kind, where[0], size, detail, seed, where[1]),))
        return changes


def _list_peaks(context: Context) -> dict[str, object]:
    return {"x_peak": context.x_peak, "y_peak": context.y_peak, "tension_peak": context.tension_peak}


def _evaluate(formula: str | float, known: Mapping[str, object]) -> float:
    """Return the value of a formula of `faults.yaml`."""
    return float(eval(str(formula), {"__builtins__": {}}, {**_FUNCTIONS, **known}))


def _evaluate_runs(formula: str | float | list[str], known: Mapping[str, object]) -> _Value:
    if isinstance(formula, list):
        return tuple(_evaluate(each, known) for each in formula)
    return _evaluate(formula, known)


_FUNCTIONS = {"min": min, "max": max, "sqrt": math.sqrt, "exp": math.exp, "log": math.log, "pi": math.pi}
_TABLE = read_packaged(Path(__file__).with_name("faults.yaml"), list[FaultScenario])
SCENARIOS = {scenario.name: scenario for scenario in _TABLE}
"""All scenarios by name, those outside the library last."""


def scenarios_of(effect: str) -> list[FaultScenario]:
    """Return the scenarios of an effect of the contract, or of `outside`."""
    return [each for each in _TABLE if effect == ("outside" if each.outside else each.effect)]
