"""Truth forms of coil, suspension, cushion, driver and floor effects; equations in `coil_physics`, `seat_physics`."""

from __future__ import annotations

import math

from numpy.random import Generator

from seatsim.blind.truth.truth import Changes, Context, Push, Shape, Truth, seed, slots

RUNS = 5
COIL_RATE = 130.0


def none(rng: Generator, _: Context) -> Shape:
    """Draw no shape."""
    return {}


def _two_pole(s: float, q: Shape, _: Context) -> Changes:
    if s <= 0.0:
        return Changes()
    return slots(coil_rate2=COIL_RATE / (q["ratio"] * s), rate_factor=1.0 / (1.0 + 0.6 * s))


def _branches(s: float, q: Shape, _: Context) -> Changes:
    weight = min(0.3 * s, 0.95)
    more = max(0.3 * s - 0.95, 0.0)
    return slots(coil_slow=weight, coil_slow_rate=q["slow"] / (1.0 + more), rate_factor=1.0 / (1.0 + 0.25 * s))


def _lag_shape(rng: Generator, _: Context) -> Shape:
    return {"ratio": rng.uniform(0.1, 0.4), "slow": rng.uniform(25.0, 50.0)}


def _fall(s: float, q: Shape, _: Context) -> Changes:
    return slots(fall_form=1.0, fall_slow=0.6 * s)


def _fall_low(s: float, q: Shape, _: Context) -> Changes:
    return slots(fall_form=2.0, fall_slow=0.6 * s)


def _delay(s: float, q: Shape, _: Context) -> Changes:
    return slots(delay=0.004 * s)


def _jitter(s: float, q: Shape, _: Context) -> Changes:
    return slots(delay=0.004 * s, delay_jitter=q["jitter"])


def _jitter_shape(rng: Generator, _: Context) -> Shape:
    return {"jitter": rng.uniform(0.1, 0.35)}


def _limit_shape(rng: Generator, _: Context) -> Shape:
    return {"power": rng.uniform(7.0, 20.0), "sag": rng.uniform(0.1, 0.35)}


def _ceiling(s: float, q: Shape, _: Context) -> Changes:
    return slots(limit=1.25 / (1.0 + 0.5 * s), limit_power=q["power"] + 4.0 / s) if s > 0.0 else Changes()


def _sagging(s: float, q: Shape, _: Context) -> Changes:
    if s <= 0.0:
        return Changes()
    limit = 1.25 / (1.0 + 0.45 * s)
    return slots(limit=limit, limit_power=q["power"] + 4.0 / s, limit_sag=q["sag"] * min(s, 1.5))


def _friction_shape(rng: Generator, _: Context) -> Shape:
    return {
        "stribeck": rng.uniform(1.05, 1.5), "speed": rng.uniform(0.005, 0.03), "length": rng.uniform(5e-5, 2e-4),
        "travel": rng.choice([-1.0, 1.0]) * rng.uniform(3.0, 10.0), "damping": rng.uniform(0.0, 0.4),
    }  # fmt: skip


def _friction(q: Shape, force: float, travel: float, damping: float) -> Changes:
    return slots(
        fr_force=force, fr_stribeck=q["stribeck"], fr_speed=q["speed"], fr_length=q["length"], fr_travel=travel,
        fr_damping=damping,
    )  # fmt: skip


def _linkage(s: float, q: Shape, _: Context) -> Changes:
    return _friction(q, 25.0 * s, 0.0, q["damping"] * 25.0 * s)


def _bent_linkage(s: float, q: Shape, _: Context) -> Changes:
    return _friction(q, 25.0 * s, q["travel"], 0.0)


def _stop_shape(rng: Generator, c: Context) -> Shape:
    return {
        "up": c.x_peak * rng.uniform(0.4, 0.75), "down": c.x_peak * rng.uniform(0.4, 0.75),
        "loss": rng.uniform(0.2, 1.2),
        "length": rng.uniform(0.003, 0.008),
    }  # fmt: skip


def _rubber(s: float, q: Shape, _: Context) -> Changes:
    return slots(
        stop_gap_up=q["up"],
        stop_gap_down=q["down"],
        stop_k=1.5e5 * s,
        stop_power=1.5,
        stop_loss=q["loss"],
        stop_length=0.004,
    )


def _foam_stop(s: float, q: Shape, _: Context) -> Changes:
    return slots(
        stop_gap_up=q["up"], stop_gap_down=q["down"], stop_k=1.0e4 * s, stop_power=0.0, stop_loss=q["loss"],
        stop_length=q["length"],
    )  # fmt: skip


def _leaf_shape(rng: Generator, c: Context) -> Shape:
    return {"length": c.x_peak * rng.uniform(0.3, 0.7)}


def _sinh(s: float, q: Shape, c: Context) -> Changes:
    return slots(sinh_length=c.x_peak / (0.9 * math.sqrt(s))) if s > 0.0 else Changes()


def _leaf(s: float, q: Shape, _: Context) -> Changes:
    return slots(leaf_gain=0.4 * s, leaf_length=q["length"])


def _foam_exp(s: float, q: Shape, c: Context) -> Changes:
    return slots(foam_length=c.y_peak / (0.5 * s)) if s > 0.0 else Changes()


def _foam_shape(rng: Generator, c: Context) -> Shape:
    return {"scale": c.y_peak * rng.uniform(0.7, 1.2), "loss": rng.uniform(0.0, 1.0)}


def _foam_poly(s: float, q: Shape, _: Context) -> Changes:
    return slots(foam_poly=0.25 * s, foam_scale=q["scale"], foam_loss=q["loss"])


def _lift_shape(rng: Generator, c: Context) -> Shape:
    return {"width": c.tension_peak * rng.uniform(0.02, 0.08)}


def _lift_soft(s: float, q: Shape, c: Context) -> Changes:
    return slots(lift_form=1.0, lift_force=0.8 * c.tension_peak / s, lift_width=q["width"]) if s > 0.0 else Changes()


def _lift_partial(s: float, q: Shape, c: Context) -> Changes:
    return slots(lift_form=2.0, lift_force=0.8 * c.tension_peak / s) if s > 0.0 else Changes()


def _mass_shape(rng: Generator, _: Context) -> Shape:
    return {"sign": float(rng.choice([-1.0, 1.0]))} | {f"lean{k}": rng.uniform(0.85, 1.15) for k in range(RUNS)}


def _mass(s: float, q: Shape, _: Context) -> Changes:
    return slots(mass_gain=max(0.08 * s * q["sign"], -0.6))


def _leaning(s: float, q: Shape, _: Context) -> Changes:
    return slots(mass_gain=tuple(max(0.08 * s * q["sign"] * q[f"lean{k}"], -0.6) for k in range(RUNS)))


def _body_shape(rng: Generator, _: Context) -> Shape:
    return {
        "rate": 2.0 * math.pi * rng.uniform(4.0, 6.0), "damping": rng.uniform(0.2, 0.45),
        "rate2": 2.0 * math.pi * rng.uniform(7.5, 9.5), "share2": rng.uniform(0.08, 0.2),
    }  # fmt: skip


def _body(s: float, q: Shape, _: Context) -> Changes:
    return slots(body_fraction=min(0.15 * s, 0.75), body_rate=q["rate"], body_damping=q["damping"])


def _two_bodies(s: float, q: Shape, _: Context) -> Changes:
    main = min(0.15 * s, 0.7)
    return slots(
        body_fraction=main, body_rate=q["rate"], body_damping=q["damping"], body2_fraction=main * q["share2"],
        body2_rate=q["rate2"], body2_damping=0.35,
    )  # fmt: skip


def _push_shape(rng: Generator, _: Context) -> Shape:
    return {"seed": seed(rng), "hertz": rng.uniform(6.0, 28.0), "every": rng.uniform(0.5, 2.0)}


def _coloured(s: float, q: Shape, _: Context) -> Changes:
    return Changes(pushes=(Push("coloured", 12.0 * s, int(q["seed"])),))


def _hum(s: float, q: Shape, _: Context) -> Changes:
    return Changes(pushes=(Push("hum", 12.0 * s, int(q["seed"]), q["hertz"]),))


def _knocks(s: float, q: Shape, _: Context) -> Changes:
    return Changes(pushes=(Push("knock", 12.0 * s, int(q["seed"]), q["every"]),))


TRUTHS = (
    Truth("lag-eddy", "coil.lag", "coil", _lag_shape, _two_pole, (0.02, 12.0)),
    Truth("lag-branches", "coil.lag", "coil", _lag_shape, _branches, (0.02, 8.0)),
    Truth("fall-diode", "coil.asymmetric_lag", "coil", none, _fall, (0.02, 15.0)),
    Truth("fall-low", "coil.asymmetric_lag", "coil", none, _fall_low, (0.02, 15.0)),
    Truth("delay-pure", "coil.delay", "coil", none, _delay, (0.05, 8.0)),
    Truth("delay-jitter", "coil.delay", "coil", _jitter_shape, _jitter, (0.05, 8.0)),
    Truth("limit-soft", "coil.current_limit", "coil", _limit_shape, _ceiling, (0.02, 8.0)),
    Truth("limit-sag", "coil.current_limit", "coil", _limit_shape, _sagging, (0.02, 6.0)),
    Truth("friction-lugre", "suspension.friction", "suspension", _friction_shape, _linkage, (0.05, 6.0)),
    Truth("friction-travel", "suspension.friction", "suspension", _friction_shape, _bent_linkage, (0.05, 6.0)),
    Truth("stop-rubber", "suspension.end_stop", "suspension", _stop_shape, _rubber, (0.03, 60.0)),
    Truth("stop-foam", "suspension.end_stop", "suspension", _stop_shape, _foam_stop, (0.03, 30.0)),
    Truth("spring-sinh", "suspension.progressive_spring", "suspension", none, _sinh, (0.02, 10.0)),
    Truth("spring-leaf", "suspension.progressive_spring", "suspension", _leaf_shape, _leaf, (0.02, 12.0)),
    Truth("foam-exponential", "cushion.hardening", "cushion", none, _foam_exp, (0.05, 6.0)),
    Truth("foam-polynomial", "cushion.hardening", "cushion", _foam_shape, _foam_poly, (0.05, 12.0)),
    Truth("lift-soft", "cushion.separation", "cushion", _lift_shape, _lift_soft, (0.8, 8.0)),
    Truth("lift-partial", "cushion.separation", "cushion", _lift_shape, _lift_partial, (0.4, 8.0)),
    Truth("mass-fixed", "driver.mass", "driver", _mass_shape, _mass, (0.1, 6.0)),
    Truth("mass-leaning", "driver.mass", "driver", _mass_shape, _leaning, (0.1, 6.0)),
    Truth("body-single", "driver.biodynamics", "driver", _body_shape, _body, (0.05, 5.0)),
    Truth("body-double", "driver.biodynamics", "driver", _body_shape, _two_bodies, (0.05, 4.0)),
    Truth("push-coloured", "floor.unmeasured_input", "floor", _push_shape, _coloured, (0.05, 15.0)),
    Truth("push-hum", "floor.unmeasured_input", "floor", _push_shape, _hum, (0.05, 15.0)),
    Truth("push-knocks", "floor.unmeasured_input", "floor", _push_shape, _knocks, (0.05, 15.0)),
)
