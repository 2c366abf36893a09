"""Fault scenarios outside the library: what a real rig may do besides, in every block.

Sizes are such that a severity of 1 is common on a real rig, and shares stay below 1.
"""

from __future__ import annotations

import math

from numpy.random import Generator

from seatsim.blind.labels import Block
from seatsim.blind.truth.faults.scenario import (
    Build,
    Changes,
    Context,
    Draw,
    FaultScenario,
    Shape,
    draw_seed,
    set_parameters,
)
from seatsim.blind.truth.faults.sensor import NEIGHBOUR, channel_of, draw_channel, fault_on_channel

OUTSIDE = "outside"


def _shape(rng: Generator, context: Context) -> Shape:
    """Draw four free numbers in 0..1, a sign and a seed."""
    numbers = {name: rng.uniform(0.0, 1.0) for name in "abcd"}
    return numbers | {"sign": float(rng.choice([-1.0, 1.0])), "seed": draw_seed(rng), "x": context.x_peak}


def _cavitation(severity: float, shape: Shape, _: Context) -> Changes:
    return (
        set_parameters(cavitation_force=350.0 / severity, cavitation_fill=0.4 + 0.8 * shape["a"])
        if severity > 0.0
        else Changes()
    )


def _orifice(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(orifice_damping=500.0 * severity)


def _thinning(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(
        thinning_power=min(0.3 * severity, 0.95),
        thinning_speed=(0.02 + 0.05 * shape["a"]) / max(0.3 * severity / 0.95, 1.0),
    )


def _field_stiffness(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(field_stiffness=4000.0 * severity)


def _inertance(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(inertance=1.5 * severity)


def _bypass(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(bypass_share=min(0.25 * severity, 0.9), bypass_length=shape["x"] * (0.15 + 0.25 * shape["a"]))


def _quantum(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(command_quantum=0.1 * severity)


def _dropouts(severity: float, shape: Shape, _: Context) -> Changes:
    if severity <= 0.0:
        return Changes()
    return set_parameters(
        dropout_interval=2.0 / severity,
        dropout_duration=0.03 + 0.06 * shape["a"],
        dropout_seed=shape["seed"] % 997.0 + 1.0,
    )


def _back_emf(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(back_emf=0.8 * severity)


def _dead_band(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(dead_zone=0.05 * severity)


def _ringing(severity: float, shape: Shape, _: Context) -> Changes:
    if severity <= 0.0:
        return Changes()
    return set_parameters(ring_rate=200.0 / severity, ring_damping=0.2 + 0.2 * shape["a"])


def _bushing(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(bushing_stiffness=2500.0 * severity, bushing_time=0.02 + 0.06 * shape["a"])


def _softening(severity: float, shape: Shape, _: Context) -> Changes:
    if severity <= 0.0:
        return Changes()
    return set_parameters(
        softening_length=1.5 * shape["x"] / math.sqrt(severity), lever_slope=shape["sign"] * min(3.0 * severity, 15.0)
    )


def _creep(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(creep_stiffness=900.0 * severity, creep_time=0.6 + 2.0 * shape["a"])


def _memory_foam(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(zener_stiffness=12000.0 * severity, zener_time=0.05 + 0.15 * shape["a"])


def _cover(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(cover_force=20.0 * severity, cover_length=1e-4 + 3e-4 * shape["a"])


def _foam_speed(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(foam_rate=6.0 * severity)


def _muscle(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(muscle_gain=400.0 * severity, muscle_delay=0.05 + 0.06 * shape["a"])


def _high_body(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(
        second_body_fraction=min(0.1 * severity, 0.6),
        second_body_rate=2.0 * math.pi * (11.0 + 4.0 * shape["a"]),
        second_body_damping=0.08 + 0.12 * shape["b"],
    )


def _feet(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(
        foot_stiffness=600.0 * severity * (0.4 + shape["a"]), foot_damping=60.0 * severity * (0.4 + shape["b"])
    )


def _base(severity: float, shape: Shape, _: Context) -> Changes:
    if severity <= 0.0:
        return Changes()
    return set_parameters(
        base_rate=2.0 * math.pi * (30.0 + 12.0 * shape["a"]) / math.sqrt(severity),
        base_damping=0.03 + 0.05 * shape["b"],
        base_mass=15.0 + 15.0 * shape["c"],
    )


def _base_soft(severity: float, shape: Shape, _: Context) -> Changes:
    if severity <= 0.0:
        return Changes()
    return set_parameters(
        base_rate=2.0 * math.pi * (22.0 + 8.0 * shape["a"]) / math.sqrt(severity), base_damping=0.25 + 0.2 * shape["b"],
        base_mass=40.0 + 40.0 * shape["c"],
    )  # fmt: skip


def _steps(severity: float, shape: Shape, context: Context) -> Changes:
    return fault_on_channel("quantise", shape, 0.3 * severity * context.spread[channel_of(shape)], context)


def _clip(severity: float, shape: Shape, context: Context) -> Changes:
    return (
        fault_on_channel("clip", shape, 3.5 / (1.0 + 0.5 * severity) * context.spread[channel_of(shape)], context)
        if severity > 0.0
        else Changes()
    )


def _backlash(severity: float, shape: Shape, context: Context) -> Changes:
    return fault_on_channel("backlash", shape, 0.15 * severity * context.spread[channel_of(shape)], context)


def _crosstalk(severity: float, shape: Shape, context: Context) -> Changes:
    name = channel_of(shape)
    return fault_on_channel(
        "crosstalk",
        shape,
        0.1 * severity * shape["sign"] * context.spread[name] / context.spread[NEIGHBOUR[name]],
        context,
    )


def _outside(
    name: str, block: Block, build: Build, span: tuple[float, float] = (0.02, 20.0), draw: Draw = _shape
) -> FaultScenario:
    return FaultScenario(name, OUTSIDE, block, draw, build, span)


SCENARIOS = (
    _outside("cavitation", "damper", _cavitation, (0.2, 12.0)),
    _outside("orifice", "damper", _orifice),
    _outside("shear-thinning", "damper", _thinning, (0.05, 15.0)),
    _outside("field-stiffness", "damper", _field_stiffness, (0.02, 6.0)),
    _outside("fluid-inertia", "damper", _inertance, (0.05, 10.0)),
    _outside("bypass-groove", "damper", _bypass, (0.05, 3.6)),
    _outside("command-quantum", "coil", _quantum, (0.2, 6.0)),
    _outside("dropouts", "coil", _dropouts, (0.05, 15.0)),
    _outside("back-emf", "coil", _back_emf, (0.05, 10.0)),
    _outside("dead-band", "coil", _dead_band, (0.1, 8.0)),
    _outside("ringing", "coil", _ringing, (0.4, 6.0)),
    _outside("maxwell-bushing", "suspension", _bushing, (0.02, 12.0)),
    _outside("softening-linkage", "suspension", _softening, (0.05, 6.0)),
    _outside("spring-creep", "suspension", _creep, (0.05, 5.0)),
    _outside("memory-foam", "cushion", _memory_foam),
    _outside("cover-stick", "cushion", _cover),
    _outside("foam-speed", "cushion", _foam_speed),
    _outside("muscle-reflex", "driver", _muscle, (0.05, 6.0)),
    _outside("body-high", "driver", _high_body, (0.05, 6.0)),
    _outside("feet-on-floor", "driver", _feet),
    _outside("base-resonance", "floor", _base, (0.3, 8.0)),
    _outside("base-rubber", "floor", _base_soft, (0.3, 8.0)),
    _outside("sensor-steps", "sensor", _steps, (0.2, 8.0), draw_channel),
    _outside("sensor-clip", "sensor", _clip, (0.05, 8.0), draw_channel),
    _outside("sensor-backlash", "sensor", _backlash, (0.1, 10.0), draw_channel),
    _outside("sensor-crosstalk", "sensor", _crosstalk, (0.1, 10.0), draw_channel),
)
