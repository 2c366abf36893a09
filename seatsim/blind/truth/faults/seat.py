"""Fault scenarios of suspension, cushion, driver and floor; equations in `physics.suspension`, `cushion`, `occupant`.

Lengths are drawn as shares of the travel of the rig without the fault, so that a scenario is seen in any excitation.
"""

from __future__ import annotations

import math

from numpy.random import Generator

from seatsim.blind.truth.faults.scenario import (
    Changes,
    Context,
    FaultScenario,
    FrameForce,
    Shape,
    draw_nothing,
    draw_seed,
    set_parameters,
)

RUNS = 5
"""Runs for which a value of its own is drawn; a protocol has four, and a fifth where one is repeated."""


def _friction_shape(rng: Generator, _: Context) -> Shape:
    return {
        "stribeck": rng.uniform(1.05, 1.5), "speed": rng.uniform(0.005, 0.03), "length": rng.uniform(5e-5, 2e-4),
        "travel": rng.choice([-1.0, 1.0]) * rng.uniform(3.0, 10.0), "damping": rng.uniform(0.0, 0.4),
    }  # fmt: skip


def _friction(shape: Shape, force: float, travel: float, damping: float) -> Changes:
    return set_parameters(
        friction_force=force,
        friction_stribeck=shape["stribeck"],
        friction_speed=shape["speed"],
        friction_length=shape["length"],
        friction_travel=travel,
        friction_damping=damping,
    )


def _linkage(severity: float, shape: Shape, _: Context) -> Changes:
    return _friction(shape, 25.0 * severity, 0.0, shape["damping"] * 25.0 * severity)


def _bent_linkage(severity: float, shape: Shape, _: Context) -> Changes:
    return _friction(shape, 25.0 * severity, shape["travel"], 0.0)


def _stop_shape(rng: Generator, context: Context) -> Shape:
    return {
        "up": context.x_peak * rng.uniform(0.4, 0.75), "down": context.x_peak * rng.uniform(0.4, 0.75),
        "loss": rng.uniform(0.2, 1.2),
        "length": rng.uniform(0.003, 0.008),
    }  # fmt: skip


def _rubber(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(
        stop_gap_up=shape["up"],
        stop_gap_down=shape["down"],
        stop_stiffness=1.5e5 * severity,
        stop_power=1.5,
        stop_loss=shape["loss"],
        stop_length=0.004,
    )


def _foam_stop(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(
        stop_gap_up=shape["up"],
        stop_gap_down=shape["down"],
        stop_stiffness=1.0e4 * severity,
        stop_power=0.0,
        stop_loss=shape["loss"],
        stop_length=shape["length"],
    )


def _leaf_shape(rng: Generator, context: Context) -> Shape:
    return {"length": context.x_peak * rng.uniform(0.3, 0.7)}


def _sinh(severity: float, shape: Shape, context: Context) -> Changes:
    # to third order `kf x (1 + 0.135 severity (x / x_peak)^2)`, so linear in the severity where that is small
    return set_parameters(sinh_length=context.x_peak / (0.9 * math.sqrt(severity))) if severity > 0.0 else Changes()


def _leaf(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(leaf_gain=0.4 * severity, leaf_length=shape["length"])


def _foam_exp(severity: float, shape: Shape, context: Context) -> Changes:
    # at the deepest stroke the stiffness is `exp(0.5 severity)` times that at rest
    return set_parameters(foam_length=context.y_peak / (0.5 * severity)) if severity > 0.0 else Changes()


def _foam_shape(rng: Generator, context: Context) -> Shape:
    return {"scale": context.y_peak * rng.uniform(0.7, 1.2), "loss": rng.uniform(0.0, 1.0)}


def _foam_poly(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(foam_poly=0.25 * severity, foam_scale=shape["scale"], foam_loss=shape["loss"])


def _lift_shape(rng: Generator, context: Context) -> Shape:
    return {"width": context.tension_peak * rng.uniform(0.02, 0.08)}


def _lift_soft(severity: float, shape: Shape, context: Context) -> Changes:
    # separation from a tension of 80 % of the largest one on
    return (
        set_parameters(
            separation_law=1.0, separation_force=0.8 * context.tension_peak / severity, separation_width=shape["width"]
        )
        if severity > 0.0
        else Changes()
    )


def _lift_partial(severity: float, shape: Shape, context: Context) -> Changes:
    return (
        set_parameters(separation_law=2.0, separation_force=0.8 * context.tension_peak / severity)
        if severity > 0.0
        else Changes()
    )


def _mass_shape(rng: Generator, _: Context) -> Shape:
    return {"sign": float(rng.choice([-1.0, 1.0]))} | {f"lean{k}": rng.uniform(0.85, 1.15) for k in range(RUNS)}


def _mass(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(mass_gain=max(0.08 * severity * shape["sign"], -0.6))


def _leaning(severity: float, shape: Shape, _: Context) -> Changes:
    # the driver leans on wheel or backrest, another way in every run
    return set_parameters(
        mass_gain=tuple(max(0.08 * severity * shape["sign"] * shape[f"lean{k}"], -0.6) for k in range(RUNS))
    )


def _body_shape(rng: Generator, _: Context) -> Shape:
    return {
        "rate": 2.0 * math.pi * rng.uniform(4.0, 6.0), "damping": rng.uniform(0.2, 0.45),
        "rate2": 2.0 * math.pi * rng.uniform(7.5, 9.5), "share2": rng.uniform(0.08, 0.2),
    }  # fmt: skip


def _body(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(
        body_fraction=min(0.15 * severity, 0.75), body_rate=shape["rate"], body_damping=shape["damping"]
    )


def _two_bodies(severity: float, shape: Shape, _: Context) -> Changes:
    main = min(0.15 * severity, 0.7)
    return set_parameters(
        body_fraction=main,
        body_rate=shape["rate"],
        body_damping=shape["damping"],
        second_body_fraction=main * shape["share2"],
        second_body_rate=shape["rate2"],
        second_body_damping=0.35,
    )


def _force_shape(rng: Generator, _: Context) -> Shape:
    return {"seed": draw_seed(rng), "hertz": rng.uniform(6.0, 28.0), "every": rng.uniform(0.5, 2.0)}


def _coloured(severity: float, shape: Shape, _: Context) -> Changes:
    return Changes(frame_forces=(FrameForce("coloured", 12.0 * severity, int(shape["seed"])),))


def _hum(severity: float, shape: Shape, _: Context) -> Changes:
    return Changes(frame_forces=(FrameForce("hum", 12.0 * severity, int(shape["seed"]), shape["hertz"]),))


def _knocks(severity: float, shape: Shape, _: Context) -> Changes:
    return Changes(frame_forces=(FrameForce("knock", 12.0 * severity, int(shape["seed"]), shape["every"]),))


SCENARIOS = (
    FaultScenario("friction-lugre", "suspension.friction", "suspension", _friction_shape, _linkage, (0.05, 6.0)),
    FaultScenario("friction-travel", "suspension.friction", "suspension", _friction_shape, _bent_linkage, (0.05, 6.0)),
    FaultScenario("stop-rubber", "suspension.end_stop", "suspension", _stop_shape, _rubber, (0.03, 60.0)),
    FaultScenario("stop-foam", "suspension.end_stop", "suspension", _stop_shape, _foam_stop, (0.03, 30.0)),
    FaultScenario("spring-sinh", "suspension.progressive_spring", "suspension", draw_nothing, _sinh, (0.02, 10.0)),
    FaultScenario("spring-leaf", "suspension.progressive_spring", "suspension", _leaf_shape, _leaf, (0.02, 12.0)),
    FaultScenario("foam-exponential", "cushion.hardening", "cushion", draw_nothing, _foam_exp, (0.05, 6.0)),
    FaultScenario("foam-polynomial", "cushion.hardening", "cushion", _foam_shape, _foam_poly, (0.05, 12.0)),
    FaultScenario("lift-soft", "cushion.separation", "cushion", _lift_shape, _lift_soft, (0.8, 8.0)),
    FaultScenario("lift-partial", "cushion.separation", "cushion", _lift_shape, _lift_partial, (0.4, 8.0)),
    FaultScenario("mass-fixed", "driver.mass", "driver", _mass_shape, _mass, (0.1, 6.0)),
    FaultScenario("mass-leaning", "driver.mass", "driver", _mass_shape, _leaning, (0.1, 6.0)),
    FaultScenario("body-single", "driver.biodynamics", "driver", _body_shape, _body, (0.05, 5.0)),
    FaultScenario("body-double", "driver.biodynamics", "driver", _body_shape, _two_bodies, (0.05, 4.0)),
    FaultScenario("push-coloured", "floor.unmeasured_input", "floor", _force_shape, _coloured, (0.05, 15.0)),
    FaultScenario("push-hum", "floor.unmeasured_input", "floor", _force_shape, _hum, (0.05, 15.0)),
    FaultScenario("push-knocks", "floor.unmeasured_input", "floor", _force_shape, _knocks, (0.05, 15.0)),
)
