"""Fault scenarios outside the library: what a real rig may do besides, in every block.

A function takes the severity s (1 is common on a real rig), the drawn shape d and what is known of the rig without it.
"""

from __future__ import annotations

import functools
import math

from numpy.random import Generator

from seatsim.blind.truth import damper_faults, seat_faults
from seatsim.blind.truth.faults import (
    NEIGHBOUR,
    Changes,
    Context,
    FaultScenario,
    Shape,
    draw_channel,
    draw_seed,
    drawn_channel,
    enter,
    fault_channel,
    set_parameters,
)

SCENARIOS = damper_faults.SCENARIOS | seat_faults.SCENARIOS
"""All scenarios by name, those outside the library last."""
_WIDE = (0.02, 20.0)
"""Severities where nothing else is known."""


def _shape(rng: Generator, context: Context) -> Shape:
    """Draw four free numbers in 0..1, a sign and a seed."""
    numbers = {name: rng.uniform(0.0, 1.0) for name in "abcd"}
    return numbers | {"sign": float(rng.choice([-1.0, 1.0])), "seed": draw_seed(rng), "x": context.x_peak}


_outside = functools.partial(enter, SCENARIOS, draw=_shape)
_misread = functools.partial(enter, SCENARIOS, draw=draw_channel)


@_outside("cavitation", "damper.outside", (0.2, 12.0))
def _cavitation(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(cavitation_force=350.0 / s, cavitation_fill=0.4 + 0.8 * d["a"])


@_outside("orifice", "damper.outside", _WIDE)
def _orifice(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(orifice_damping=500.0 * s)


@_outside("shear-thinning", "damper.outside", (0.05, 15.0))
def _thinning(s: float, d: Shape, _: Context) -> Changes:
    speed = (0.02 + 0.05 * d["a"]) / max(0.3 * s / 0.95, 1.0)
    return set_parameters(thinning_power=min(0.3 * s, 0.95), thinning_speed=speed)


@_outside("field-stiffness", "damper.outside", (0.02, 6.0))
def _field_stiffness(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(field_stiffness=4000.0 * s)


@_outside("fluid-inertia", "damper.outside", (0.05, 10.0))
def _inertance(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(inertance=1.5 * s)


@_outside("bypass-groove", "damper.outside", (0.05, 3.6))
def _bypass(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(bypass_share=min(0.25 * s, 0.9), bypass_length=d["x"] * (0.15 + 0.25 * d["a"]))


@_outside("command-quantum", "coil.outside", (0.2, 6.0))
def _quantum(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(command_quantum=0.1 * s)


@_outside("dropouts", "coil.outside", (0.05, 15.0))
def _dropouts(s: float, d: Shape, _: Context) -> Changes:
    duration, seed = 0.03 + 0.06 * d["a"], d["seed"] % 997.0 + 1.0
    return set_parameters(dropout_interval=2.0 / s, dropout_duration=duration, dropout_seed=seed)


@_outside("back-emf", "coil.outside", (0.05, 10.0))
def _back_emf(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(back_emf=0.8 * s)


@_outside("dead-band", "coil.outside", (0.1, 8.0))
def _dead_band(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(dead_zone=0.05 * s)


@_outside("ringing", "coil.outside", (0.4, 6.0))
def _ringing(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(ring_rate=200.0 / s, ring_damping=0.2 + 0.2 * d["a"])


@_outside("maxwell-bushing", "suspension.outside", (0.02, 12.0))
def _bushing(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(bushing_stiffness=2500.0 * s, bushing_time=0.02 + 0.06 * d["a"])


@_outside("softening-linkage", "suspension.outside", (0.05, 6.0))
def _softening(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(softening_length=1.5 * d["x"] / math.sqrt(s), lever_slope=d["sign"] * min(3.0 * s, 15.0))


@_outside("spring-creep", "suspension.outside", (0.05, 5.0))
def _creep(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(creep_stiffness=900.0 * s, creep_time=0.6 + 2.0 * d["a"])


@_outside("memory-foam", "cushion.outside", _WIDE)
def _memory_foam(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(zener_stiffness=12000.0 * s, zener_time=0.05 + 0.15 * d["a"])


@_outside("cover-stick", "cushion.outside", _WIDE)
def _cover(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(cover_force=20.0 * s, cover_length=1e-4 + 3e-4 * d["a"])


@_outside("foam-speed", "cushion.outside", _WIDE)
def _foam_speed(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(foam_rate=6.0 * s)


@_outside("muscle-reflex", "driver.outside", (0.05, 6.0))
def _muscle(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(muscle_gain=400.0 * s, muscle_delay=0.05 + 0.06 * d["a"])


@_outside("body-high", "driver.outside", (0.05, 6.0))
def _high_body(s: float, d: Shape, _: Context) -> Changes:
    rate, damping = 2.0 * math.pi * (11.0 + 4.0 * d["a"]), 0.08 + 0.12 * d["b"]
    return set_parameters(second_body_fraction=min(0.1 * s, 0.6), second_body_rate=rate, second_body_damping=damping)


@_outside("feet-on-floor", "driver.outside", _WIDE)
def _feet(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(foot_stiffness=600.0 * s * (0.4 + d["a"]), foot_damping=60.0 * s * (0.4 + d["b"]))


@_outside("base-resonance", "floor.outside", (0.3, 8.0))
def _base(s: float, d: Shape, _: Context) -> Changes:
    rate, mass = 2.0 * math.pi * (30.0 + 12.0 * d["a"]) / math.sqrt(s), 15.0 + 15.0 * d["c"]
    return set_parameters(base_rate=rate, base_damping=0.03 + 0.05 * d["b"], base_mass=mass)


@_outside("base-rubber", "floor.outside", (0.3, 8.0))
def _soft_base(s: float, d: Shape, _: Context) -> Changes:
    rate, mass = 2.0 * math.pi * (22.0 + 8.0 * d["a"]) / math.sqrt(s), 40.0 + 40.0 * d["c"]
    return set_parameters(base_rate=rate, base_damping=0.25 + 0.2 * d["b"], base_mass=mass)


@_misread("sensor-steps", "sensor.outside", (0.2, 8.0))
def _steps(s: float, d: Shape, context: Context) -> Changes:
    return fault_channel("quantise", 0.3 * s * context.spread[drawn_channel(d)], d, context)


@_misread("sensor-clip", "sensor.outside", (0.05, 8.0))
def _clip(s: float, d: Shape, context: Context) -> Changes:
    return fault_channel("clip", 3.5 / (1.0 + 0.5 * s) * context.spread[drawn_channel(d)], d, context)


@_misread("sensor-backlash", "sensor.outside", (0.1, 10.0))
def _backlash(s: float, d: Shape, context: Context) -> Changes:
    return fault_channel("backlash", 0.15 * s * context.spread[drawn_channel(d)], d, context)


@_misread("sensor-crosstalk", "sensor.outside", (0.1, 10.0))
def _crosstalk(s: float, d: Shape, context: Context) -> Changes:
    name = drawn_channel(d)
    size = 0.1 * s * d["sign"] * context.spread[name] / context.spread[NEIGHBOUR[name]]
    return fault_channel("crosstalk", size, d, context)


def scenarios_of(effect: str) -> list[FaultScenario]:
    """Return the scenarios of an effect of the contract, or of `outside`."""
    return [scenario for scenario in SCENARIOS.values() if scenario.effect == effect]
