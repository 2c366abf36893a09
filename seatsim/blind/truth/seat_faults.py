"""Fault scenarios of suspension, cushion, driver, floor and sensors: two or more forms of each effect of the contract.

A function takes the severity s (1 is common on a real rig), the drawn shape d and what is known of the rig without it.
Lengths are drawn as shares of the travel of the rig without the fault, so that it is seen in any excitation.
"""

from __future__ import annotations

import functools
import math

from numpy.random import Generator

from seatsim.blind.truth.faults import (
    Changes,
    Context,
    FaultScenario,
    FrameForce,
    SensorFault,
    Shape,
    draw_channel,
    draw_seed,
    drawn_channel,
    enter,
    fault_channel,
    set_parameters,
)

_RUNS = 5
"""Runs for which a value of its own is drawn; a protocol has four, and a fifth where one is repeated."""
SCENARIOS: dict[str, FaultScenario] = {}
_fault = functools.partial(enter, SCENARIOS)


def _friction_shape(rng: Generator, _: Context) -> Shape:
    stribeck, speed, length = rng.uniform(1.05, 1.5), rng.uniform(0.005, 0.03), rng.uniform(5e-5, 2e-4)
    travel = rng.choice([-1.0, 1.0]) * rng.uniform(3.0, 10.0)
    shape = {"stribeck": stribeck, "speed": speed, "length": length, "travel": travel}
    return shape | {"damping": rng.uniform(0.0, 0.4)}


@_fault("friction-lugre", "suspension.friction", (0.05, 6.0), _friction_shape)
def _linkage(s: float, d: Shape, _: Context) -> Changes:
    shape = set_parameters(friction_stribeck=d["stribeck"], friction_speed=d["speed"], friction_length=d["length"])
    return shape + set_parameters(
        friction_force=25.0 * s, friction_travel=0.0, friction_damping=d["damping"] * 25.0 * s
    )


@_fault("friction-travel", "suspension.friction", (0.05, 6.0), _friction_shape)
def _bent_linkage(s: float, d: Shape, context: Context) -> Changes:
    return _linkage(s, d, context) + set_parameters(friction_travel=d["travel"], friction_damping=0.0)


def _stop_shape(rng: Generator, context: Context) -> Shape:
    up, down = context.x_peak * rng.uniform(0.4, 0.75), context.x_peak * rng.uniform(0.4, 0.75)
    return {"up": up, "down": down, "loss": rng.uniform(0.2, 1.2), "length": rng.uniform(0.003, 0.008)}


@_fault("stop-rubber", "suspension.end_stop", (0.03, 60.0), _stop_shape)
def _rubber(s: float, d: Shape, _: Context) -> Changes:
    gaps = set_parameters(stop_gap_up=d["up"], stop_gap_down=d["down"], stop_loss=d["loss"])
    return gaps + set_parameters(stop_stiffness=1.5e5 * s, stop_power=1.5, stop_length=0.004)


@_fault("stop-foam", "suspension.end_stop", (0.03, 30.0), _stop_shape)
def _foam_stop(s: float, d: Shape, context: Context) -> Changes:
    foam = set_parameters(stop_stiffness=1.0e4 * s, stop_power=0.0, stop_length=d["length"])
    return _rubber(s, d, context) + foam


@_fault("spring-sinh", "suspension.progressive_spring", (0.02, 10.0))
def _sinh(s: float, d: Shape, context: Context) -> Changes:
    # to third order `kf x (1 + 0.135 s (x / x_peak)^2)`, so linear in the severity where that is small
    return set_parameters(sinh_length=context.x_peak / (0.9 * math.sqrt(s)))


def _leaf_shape(rng: Generator, context: Context) -> Shape:
    return {"length": context.x_peak * rng.uniform(0.3, 0.7)}


@_fault("spring-leaf", "suspension.progressive_spring", (0.02, 12.0), _leaf_shape)
def _leaf(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(leaf_gain=0.4 * s, leaf_length=d["length"])


@_fault("foam-exponential", "cushion.hardening", (0.05, 6.0))
def _foam_exponential(s: float, d: Shape, context: Context) -> Changes:
    # at the deepest stroke the stiffness is `exp(0.5 s)` times that at rest
    return set_parameters(foam_length=context.y_peak / (0.5 * s))


def _foam_shape(rng: Generator, context: Context) -> Shape:
    return {"scale": context.y_peak * rng.uniform(0.7, 1.2), "loss": rng.uniform(0.0, 1.0)}


@_fault("foam-polynomial", "cushion.hardening", (0.05, 12.0), _foam_shape)
def _foam_polynomial(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(foam_poly=0.25 * s, foam_scale=d["scale"], foam_loss=d["loss"])


def _lift_shape(rng: Generator, context: Context) -> Shape:
    return {"width": context.tension_peak * rng.uniform(0.02, 0.08)}


@_fault("lift-soft", "cushion.separation", (0.8, 8.0), _lift_shape)
def _lift_soft(s: float, d: Shape, context: Context) -> Changes:
    # separation from a tension of 80 % of the largest one on
    force = 0.8 * context.tension_peak / s
    return set_parameters(separation_law=1.0, separation_force=force, separation_width=d["width"])


@_fault("lift-partial", "cushion.separation", (0.4, 8.0), _lift_shape)
def _lift_partial(s: float, d: Shape, context: Context) -> Changes:
    return set_parameters(separation_law=2.0, separation_force=0.8 * context.tension_peak / s)


def _mass_shape(rng: Generator, _: Context) -> Shape:
    return {"sign": float(rng.choice([-1.0, 1.0]))} | {f"lean{k}": rng.uniform(0.85, 1.15) for k in range(_RUNS)}


@_fault("mass-fixed", "driver.mass", (0.1, 6.0), _mass_shape)
def _mass(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(mass_gain=max(0.08 * s * d["sign"], -0.6))


@_fault("mass-leaning", "driver.mass", (0.1, 6.0), _mass_shape)
def _leaning(s: float, d: Shape, _: Context) -> Changes:
    # the driver leans on wheel or backrest, another way in every run
    return set_parameters(mass_gain=tuple(max(0.08 * s * d["sign"] * d[f"lean{k}"], -0.6) for k in range(_RUNS)))


def _body_shape(rng: Generator, _: Context) -> Shape:
    rate, damping = 2.0 * math.pi * rng.uniform(4.0, 6.0), rng.uniform(0.2, 0.45)
    rate2, share2 = 2.0 * math.pi * rng.uniform(7.5, 9.5), rng.uniform(0.08, 0.2)
    return {"rate": rate, "damping": damping, "rate2": rate2, "share2": share2}


@_fault("body-single", "driver.biodynamics", (0.05, 5.0), _body_shape)
def _body(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(body_fraction=min(0.15 * s, 0.75), body_rate=d["rate"], body_damping=d["damping"])


@_fault("body-double", "driver.biodynamics", (0.05, 4.0), _body_shape)
def _two_bodies(s: float, d: Shape, _: Context) -> Changes:
    main = min(0.15 * s, 0.7)
    second = set_parameters(second_body_fraction=main * d["share2"], second_body_rate=d["rate2"])
    first = set_parameters(body_fraction=main, body_rate=d["rate"], body_damping=d["damping"])
    return first + second + set_parameters(second_body_damping=0.35)


def _force_shape(rng: Generator, _: Context) -> Shape:
    return {"seed": draw_seed(rng), "hertz": rng.uniform(6.0, 28.0), "every": rng.uniform(0.5, 2.0)}


@_fault("push-coloured", "floor.unmeasured_input", (0.05, 15.0), _force_shape)
def _coloured(s: float, d: Shape, _: Context) -> Changes:
    return Changes(frame_forces=(FrameForce("coloured", 12.0 * s, int(d["seed"])),))


@_fault("push-hum", "floor.unmeasured_input", (0.05, 15.0), _force_shape)
def _hum(s: float, d: Shape, _: Context) -> Changes:
    return Changes(frame_forces=(FrameForce("hum", 12.0 * s, int(d["seed"]), d["hertz"]),))


@_fault("push-knocks", "floor.unmeasured_input", (0.05, 15.0), _force_shape)
def _knocks(s: float, d: Shape, _: Context) -> Changes:
    return Changes(frame_forces=(FrameForce("knock", 12.0 * s, int(d["seed"]), d["every"]),))


@_fault("gain-scale", "sensor.gain", (0.1, 6.0), draw_channel)
def _gain(s: float, d: Shape, context: Context) -> Changes:
    return fault_channel("gain", max(0.1 * s * d["sign"], -0.7), d, context)


@_fault("gain-bent", "sensor.gain", (0.1, 6.0), draw_channel)
def _bent_gain(s: float, d: Shape, context: Context) -> Changes:
    return fault_channel("gain_bent", max(0.1 * s * d["sign"], -0.7), d, context)


@_fault("bias-drift", "sensor.bias", (0.1, 12.0), draw_channel)
def _offset(s: float, d: Shape, context: Context) -> Changes:
    return fault_channel("bias", 0.1 * s * d["sign"] * context.spread[drawn_channel(d)], d, context)


@_fault("bias-wander", "sensor.bias", (0.1, 12.0), draw_channel)
def _wander(s: float, d: Shape, context: Context) -> Changes:
    return fault_channel("wander", 0.1 * s * context.spread[drawn_channel(d)], d, context)


@_fault("lag-filter", "sensor.lag", (0.02, 8.0), draw_channel)
def _filter(s: float, d: Shape, context: Context) -> Changes:
    return fault_channel("lag_second", 0.004 * s, d, context)


@_fault("lag-average", "sensor.lag", (0.02, 8.0), draw_channel)
def _average(s: float, d: Shape, context: Context) -> Changes:
    return fault_channel("lag_average", 0.004 * s, d, context)


@_fault("skew-fixed", "sensor.clock_skew", (0.05, 8.0), draw_channel)
def _skew(s: float, d: Shape, _: Context) -> Changes:
    return Changes(sensor_faults=(SensorFault("skew", "log", 0.006 * s * d["sign"], 0.0, int(d["seed"])),))


@_fault("skew-drifting", "sensor.clock_skew", (0.05, 8.0), draw_channel)
def _drifting_skew(s: float, d: Shape, _: Context) -> Changes:
    drifting = SensorFault("skew", "log", 0.006 * s * d["sign"], 0.2 + 0.6 * d["detail"], int(d["seed"]))
    return Changes(sensor_faults=(drifting,))
