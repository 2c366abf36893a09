"""Things that no effect of the library is: what a real rig may do besides, in every block."""

from __future__ import annotations

import math

from numpy.random import Generator

from seatsim.blind.truth.sensor import NEIGHBOUR, channel_of, channel_shape, fault
from seatsim.blind.truth.truth import Build, Changes, Context, Draw, Shape, Truth, seed, slots

OUTSIDE = "outside"


def _shape(rng: Generator, c: Context) -> Shape:
    """Draw four free numbers in 0..1, a sign and a seed."""
    numbers = {name: rng.uniform(0.0, 1.0) for name in "abcd"}
    return numbers | {"sign": float(rng.choice([-1.0, 1.0])), "seed": seed(rng), "x": c.x_peak}


def _cavitation(s: float, q: Shape, _: Context) -> Changes:
    return slots(cav_force=350.0 / s, cav_fill=0.4 + 0.8 * q["a"]) if s > 0.0 else Changes()


def _orifice(s: float, q: Shape, _: Context) -> Changes:
    return slots(orifice=500.0 * s)


def _thinning(s: float, q: Shape, _: Context) -> Changes:
    return slots(thin_power=min(0.3 * s, 0.95), thin_speed=(0.02 + 0.05 * q["a"]) / max(0.3 * s / 0.95, 1.0))


def _field_stiffness(s: float, q: Shape, _: Context) -> Changes:
    return slots(mag_stiffness=4000.0 * s)


def _inertance(s: float, q: Shape, _: Context) -> Changes:
    return slots(inertance=1.5 * s)


def _bypass(s: float, q: Shape, _: Context) -> Changes:
    return slots(bypass=min(0.25 * s, 0.9), bypass_length=q["x"] * (0.15 + 0.25 * q["a"]))


def _quantum(s: float, q: Shape, _: Context) -> Changes:
    return slots(quantum=0.1 * s)


def _dropouts(s: float, q: Shape, _: Context) -> Changes:
    if s <= 0.0:
        return Changes()
    return slots(drop_every=2.0 / s, drop_time=0.03 + 0.06 * q["a"], drop_seed=q["seed"] % 997.0 + 1.0)


def _back_emf(s: float, q: Shape, _: Context) -> Changes:
    return slots(back_emf=0.8 * s)


def _dead_band(s: float, q: Shape, _: Context) -> Changes:
    return slots(dead_zone=0.05 * s)


def _ringing(s: float, q: Shape, _: Context) -> Changes:
    if s <= 0.0:
        return Changes()
    return slots(ring_rate=200.0 / s, ring_damping=0.2 + 0.2 * q["a"])


def _bushing(s: float, q: Shape, _: Context) -> Changes:
    return slots(bush_k=2500.0 * s, bush_tau=0.02 + 0.06 * q["a"])


def _softening(s: float, q: Shape, _: Context) -> Changes:
    if s <= 0.0:
        return Changes()
    return slots(soften_length=1.5 * q["x"] / math.sqrt(s), soften_ratio=q["sign"] * min(3.0 * s, 15.0))


def _creep(s: float, q: Shape, _: Context) -> Changes:
    return slots(creep_k=900.0 * s, creep_tau=0.6 + 2.0 * q["a"])


def _memory_foam(s: float, q: Shape, _: Context) -> Changes:
    return slots(zener_k=12000.0 * s, zener_tau=0.05 + 0.15 * q["a"])


def _cover(s: float, q: Shape, _: Context) -> Changes:
    return slots(cover_force=20.0 * s, cover_length=1e-4 + 3e-4 * q["a"])


def _foam_speed(s: float, q: Shape, _: Context) -> Changes:
    return slots(foam_v=6.0 * s)


def _muscle(s: float, q: Shape, _: Context) -> Changes:
    return slots(muscle_gain=400.0 * s, muscle_delay=0.05 + 0.06 * q["a"])


def _high_body(s: float, q: Shape, _: Context) -> Changes:
    return slots(
        body2_fraction=min(0.1 * s, 0.6),
        body2_rate=2.0 * math.pi * (11.0 + 4.0 * q["a"]),
        body2_damping=0.08 + 0.12 * q["b"],
    )


def _feet(s: float, q: Shape, _: Context) -> Changes:
    return slots(foot_k=600.0 * s * (0.4 + q["a"]), foot_c=60.0 * s * (0.4 + q["b"]))


def _base(s: float, q: Shape, _: Context) -> Changes:
    if s <= 0.0:
        return Changes()
    return slots(
        base_rate=2.0 * math.pi * (30.0 + 12.0 * q["a"]) / math.sqrt(s), base_damping=0.03 + 0.05 * q["b"],
        base_mass=15.0 + 15.0 * q["c"],
    )  # fmt: skip


def _base_soft(s: float, q: Shape, _: Context) -> Changes:
    if s <= 0.0:
        return Changes()
    return slots(
        base_rate=2.0 * math.pi * (22.0 + 8.0 * q["a"]) / math.sqrt(s), base_damping=0.25 + 0.2 * q["b"],
        base_mass=40.0 + 40.0 * q["c"],
    )  # fmt: skip


def _steps(s: float, q: Shape, c: Context) -> Changes:
    return fault("quantise", q, 0.3 * s * c.spread[channel_of(q)], c)


def _clip(s: float, q: Shape, c: Context) -> Changes:
    return fault("clip", q, 3.5 / (1.0 + 0.5 * s) * c.spread[channel_of(q)], c) if s > 0.0 else Changes()


def _backlash(s: float, q: Shape, c: Context) -> Changes:
    return fault("backlash", q, 0.15 * s * c.spread[channel_of(q)], c)


def _crosstalk(s: float, q: Shape, c: Context) -> Changes:
    name = channel_of(q)
    return fault("crosstalk", q, 0.1 * s * q["sign"] * c.spread[name] / c.spread[NEIGHBOUR[name]], c)


def _out(name: str, block: str, build: Build, span: tuple[float, float] = (0.02, 20.0), draw: Draw = _shape) -> Truth:
    return Truth(name, OUTSIDE, block, draw, build, span)


TRUTHS = (
    _out("cavitation", "damper", _cavitation, (0.2, 12.0)),
    _out("orifice", "damper", _orifice),
    _out("shear-thinning", "damper", _thinning, (0.05, 15.0)),
    _out("field-stiffness", "damper", _field_stiffness, (0.02, 6.0)),
    _out("fluid-inertia", "damper", _inertance, (0.05, 10.0)),
    _out("bypass-groove", "damper", _bypass, (0.05, 3.6)),
    _out("command-quantum", "coil", _quantum, (0.2, 6.0)),
    _out("dropouts", "coil", _dropouts, (0.05, 15.0)),
    _out("back-emf", "coil", _back_emf, (0.05, 10.0)),
    _out("dead-band", "coil", _dead_band, (0.1, 8.0)),
    _out("ringing", "coil", _ringing, (0.4, 6.0)),
    _out("maxwell-bushing", "suspension", _bushing, (0.02, 12.0)),
    _out("softening-linkage", "suspension", _softening, (0.05, 6.0)),
    _out("spring-creep", "suspension", _creep, (0.05, 5.0)),
    _out("memory-foam", "cushion", _memory_foam),
    _out("cover-stick", "cushion", _cover),
    _out("foam-speed", "cushion", _foam_speed),
    _out("muscle-reflex", "driver", _muscle, (0.05, 6.0)),
    _out("body-high", "driver", _high_body, (0.05, 6.0)),
    _out("feet-on-floor", "driver", _feet),
    _out("base-resonance", "floor", _base, (0.3, 8.0)),
    _out("base-rubber", "floor", _base_soft, (0.3, 8.0)),
    _out("sensor-steps", "sensor", _steps, (0.2, 8.0), channel_shape),
    _out("sensor-clip", "sensor", _clip, (0.05, 8.0), channel_shape),
    _out("sensor-backlash", "sensor", _backlash, (0.1, 10.0), channel_shape),
    _out("sensor-crosstalk", "sensor", _crosstalk, (0.1, 10.0), channel_shape),
)
