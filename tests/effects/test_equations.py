"""Every effect against its stated equation, written apart from seatsim, at random parameters, motions and states.

Each function yields the names of effects, what seatsim gives and what the equation gives.
"""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from seatsim.rig.coil import Coil
from seatsim.rig.plant import Plant
from seatsim.rig.temperature import TemperatureFactors, TemperatureScaling
from seatsim.schema.fields import bounds
from seatsim.schema.registry import find

from .rigs import record

DRAWS = 40
PLANT = Plant(20.0, 80.0, 4600.0, 150.0, 60000.0, 1500.0)
MOTION_RATE, MEMORY_RATE = 1000.0, 500.0
"""1/s; what the documentation states as the fastest build-up of a yield force, and the pace of a play."""


def drawn(name, rng, **ranges):
    """An effect with random parameters within these ranges; a third of those that may be zero are."""
    cls, values = find("effect", name), {}
    for field, (low, high) in ranges.items():
        is_zero = bounds(cls, field)[0] == 0.0 and rng.uniform() < 0.33
        values[field] = 0.0 if is_zero else float(rng.uniform(low, high))
    return record(name, **values)


def dahl(e, v, z):
    """The state's rate and the force of friction that builds up over a travel, and the set-valued rest."""
    if e.presliding == 0.0:
        return 0.0, 0.0, e.force
    return v * (1 - z * np.sign(v)) / e.presliding, e.force * z / (1 + e.lubrication * abs(v)), 0.0


def compare_frictions(rng):
    v, z = rng.normal(0, 0.2), float(rng.uniform(-1, 1))
    ranges = {"force": (10, 200), "presliding": (1e-4, 5e-3), "lubrication": (1, 50)}
    seal, linkage = (drawn(name, rng, **ranges) for name in ("damper.seal_friction", "suspension.friction"))
    rate, force, limit = dahl(seal, v, z)
    found = *seal.rates(0.01, v, v, 0.3, 0.0, 0.0, (z,)), seal.added_force(0.01, v, (z,)), seal.stiction((z,))
    yield "damper.seal_friction", found, (rate, force, limit)
    rate, force, limit = dahl(linkage, v, z)
    found = linkage.suspension_force(PLANT, 0.01, v, (z,)), linkage.linkage_friction((z,))
    yield "suspension.friction", (*linkage.rates(PLANT, SimpleNamespace(v=v), (z,)), *found), (rate, force, limit)


def compare_gas_spring_and_asymmetry(rng):
    x, v, force = rng.normal(0, 0.02), rng.normal(0, 0.05), rng.normal(0, 300)
    gas = drawn("damper.gas_spring", rng, preload=(-50, 50), stiffness=(100, 2000))
    yield "damper.gas_spring", gas.added_force(x, v, ()), gas.preload + gas.stiffness * x
    e = drawn("damper.asymmetry", rng, viscous=(-0.5, 0.5), yielding=(-0.5, 0.5), speed=(0.005, 0.1),
              offset=(-1, 1), pulling=(-0.5, 0.5))  # fmt: skip
    side = np.tanh(v / e.speed) + e.offset
    parts = (0.9 * (1 + e.viscous * side), 0.8, 0.7 * (1 + e.yielding * side))
    found = *e.part_scaling(TemperatureScaling(0.9, 0.8, 0.7), v, ()), e.yield_force(force, ())
    yield "damper.asymmetry", found, (*parts, force * (1 + e.pulling * (np.sign(force) + e.offset)))


def compare_magnetism(rng):
    most = rng.choice([0.3, 1.5])
    i, z = float(rng.uniform(0, most)), tuple(map(float, most * rng.uniform(-0.2, 1, 3)))
    e = drawn("damper.magnetic_saturation", rng, bend=(0.1, 3), sharpness=(0.6, 6))
    saturated = i / (1 + (e.bend * i) ** e.sharpness) ** (1 / e.sharpness)
    yield "damper.magnetic_saturation", e.yield_current(i, ()), saturated
    shares = dict.fromkeys(("spread", "lift", "share", "reversible"), (0.1, 1))
    e = drawn("damper.remanence", rng, width=(0.01, 0.3), decay=(1, 30), **shares)
    widths = e.width * (1 + e.spread), e.width * (1 - e.spread)
    plays = [np.clip(kept, i - width, i + width) for kept, width in zip(z, widths, strict=False)]
    felt = (1 - e.reversible) * np.mean(plays) + e.reversible * i
    expected = felt + e.lift * np.clip(felt, 0, e.width) + e.share * max(z[2] - i, 0)
    rates = [MEMORY_RATE * (play - kept) + e.decay * (i - kept) if e.width else 0.0
             for play, kept in zip(plays, z, strict=False)]  # fmt: skip
    rates.append((e.decay if i < z[2] else MEMORY_RATE) * (i - z[2]))
    found = e.yield_current(i, z), *e.rates(0.0, 0.0, 0.0, i, 0.0, 0.0, z)
    yield "damper.remanence", found, (expected, *rates)


def compare_warmth(rng):
    e = drawn("damper.thermal_fade", rng, viscous=(-0.01, 0.02), yielding=(-0.01, 0.02), rise=(-20, 20))
    faded = e.factors(TemperatureFactors(-0.004, -0.009, -0.014, 20.0))
    yield "damper.thermal_fade", faded, (-0.004 - e.viscous, -0.009, -0.014 - e.yielding, 20.0)
    yield "damper.thermal_fade", e.temperature(0.1, np.array([20.0, 30.0])), np.array([20.0, 30.0]) + e.rise
    # Smoothed over 2 s, a reading that rises evenly keeps its slope.
    lagging, even = e._replace(lag=5.0), 20.0 + 0.5 * 0.1 * np.arange(200)
    assert lagging.temperature(0.1, even)[40:-40] == pytest.approx(even[40:-40] + 2.5 + e.rise, abs=0.1)


def compare_free_play(rng):
    e = drawn("damper.free_play", rng, gap=(1e-4, 5e-3), softness=(0.05, 1), stiffness=(1e5, 1e7), turning=(1e-3, 0.1))
    g, v, demanded = 1.2 * float(rng.uniform(-0.5, 0.5)) * (e.gap or 1e-3), rng.normal(0, 0.05), rng.normal(0, 100)

    def share(sign):
        s = np.clip((2 * g * sign / e.gap - (1 - 2 * e.softness)) / (2 * e.softness), 0, 1)
        return s**2 * (3 - 2 * s)

    if e.gap == 0.0:
        expected = 0.6
    elif e.turning == 0.0:
        expected = 0.6 * share(np.sign(demanded))
    else:
        w = np.tanh(v / e.turning)
        expected = 0.6 * ((1 + w) / 2 * share(1) + (1 - w) / 2 * share(-1))
    carried = 1.0 - np.hypot(1.0, (2 * np.abs(g) / e.gap) ** (1 / e.softness)) ** -e.softness if e.gap else 1.0
    mount = e.stiffness * g * carried if e.stiffness else 7.0
    found = e.transmitted_share(0.6, v, demanded, (g,)), e.mount_force(7.0, (g,)), e.mount_stiffness((g,))
    yield "damper.free_play", found, (expected, mount, e.stiffness)
    yield "damper.free_play", e.rates(0.0, 0.3, 0.1, 0.0, demanded, 0.0, (g,)), (0.2,)


def compare_preyield_hysteresis(rng):
    ranges = {"travel": (1e-4, 5e-3), "lag": (2e-3, 0.02), "behind": (2e-3, 0.02), "share": (0, 2)}
    e = drawn("damper.preyield_hysteresis", rng, **ranges)
    u, target, late, z = rng.normal(0, 0.05), rng.uniform(-1, 1), rng.uniform(-1, 1), tuple(rng.uniform(-1, 1, 2))
    wanted = (abs(u) / e.travel if e.travel else 0.0) + (1 / e.lag if e.lag else 0.0)
    rate = 1 / (1 / wanted + 1 / MOTION_RATE) if wanted else 0.0
    expected = (rate * (target - z[0]), (u - z[1]) / e.behind if e.behind else 0.0)
    found = *e.rates(0.0, 0.3, u, 0.0, 0.0, target, z), e.yield_speed(u, z)
    yield "damper.preyield_hysteresis", found, (*expected, z[1] if e.behind else u)
    follower = late if e.behind else z[0]
    is_on = e.travel or e.lag or e.behind
    shape = e.yield_shape(math.nan, target, late, z)
    if is_on:
        yield "damper.preyield_hysteresis", shape, target + e.share * (follower - target)
    else:
        assert math.isnan(shape)


def compare_suspension(rng):
    x, v = rng.normal(0, 0.02), rng.normal(0, 0.2)
    e = drawn("suspension.progressive_spring", rng, rise=(100, 5000), skew=(-5, 5), helper=(0.1, 4), reach=(1e-3, 0.03))
    helper = e.helper * (np.hypot(x, e.reach) - e.reach) * np.sign(x)
    progressive = 4600.0 * (e.skew * x**2 + e.rise * x**3 + helper)
    yield "suspension.progressive_spring", e.suspension_force(PLANT, x, v, ()), progressive
    e = drawn("suspension.end_stop", rng, low=(-0.03, 0), high=(0, 0.03), stiffness=(1e4, 1e5), damping=(0.1, 10),
              power=(1, 3))  # fmt: skip
    depth, side = (x - e.high, 1) if x > e.high else (max(e.low - x, 0.0), -1)
    push = e.stiffness * depth * (depth / 0.01) ** (e.power - 1) * (1 + e.damping * side * v)
    yield "suspension.end_stop", e.suspension_force(PLANT, x, v, ()), side * max(push, 0.0)


def compare_cushion(rng):
    xc, vc, force = rng.normal(0, 0.005), rng.normal(0, 0.1), rng.normal(0, 300)
    e = drawn("cushion.hardening", rng, rise=(5, 100), bend=(100, 5000), loss=(5, 100), unload=(0.1, 3))
    d, s = max(-xc, 0.0), max(xc, 0.0) * e.unload * e.rise
    change = 60000.0 * (d * (e.rise * d + e.bend * d**2) + max(xc, 0.0) * s / (1 + s)) - 1500.0 * e.loss * d * vc
    yield "cushion.hardening", e.cushion_force(force, PLANT, xc, vc, ()), force - change
    e = drawn("cushion.separation", rng, limit=(50, 250), held=(0.1, 0.9), width=(20, 200))
    over = force - e.limit
    lost = max(over, 0.0) if abs(over) >= e.width else (over + e.width) ** 2 / (4 * e.width)
    yield "cushion.separation", e.cushion_force(force, PLANT, xc, vc, ()), force - (1 - e.held) * lost


def compare_driver(rng):
    e = drawn("driver.biodynamics", rng, share=(0.1, 0.9), frequency=(2, 10), damping=(0.1, 1))
    z = rng.normal(0, 0.1, 2)
    omega = 2 * np.pi * e.frequency
    pull = omega**2 * z[0] + 2 * e.damping * omega * z[1]
    found = e.inner_mass(PLANT, z), e.inner_force(PLANT, z), *e.rates(PLANT, SimpleNamespace(driver=1.7), z)
    rates = (z[1], -pull - 1.7) if e.share else (0.0, 0.0)
    yield "driver.biodynamics", found, (80 * e.share, 80 * e.share * pull, *rates)
    e = drawn("driver.mass", rng, change=(-150, 150))
    yield "driver.mass", e.plant(PLANT).driver_mass, max(1.0, 80.0 + e.change)
    assert e.plant(PLANT)._replace(driver_mass=80.0) == PLANT


def compare_coil(rng):
    rate, fall = float(rng.uniform(50, 300)), float(rng.choice([0.0, 80.0]))
    coil = Coil(rate=rate, rate_fall=fall, max_current=1.2, delay=0.003)

    def slowed(rate, time):
        return 1 / max(1e-5, 1 / rate + time)

    e = drawn("coil.lag", rng, time=(-0.05, 0.05), second=(0.1, 1))
    expected = coil._replace(rate=slowed(coil.rate, e.time), delay=0.003 + max(0.0, e.second * e.time),
                             rate_fall=slowed(coil.rate_fall, e.time) if coil.rate_fall else 0.0)  # fmt: skip
    yield "coil.lag", e.coil(coil), expected
    e = drawn("coil.asymmetric_lag", rng, time=(0, 0.05))
    yield "coil.asymmetric_lag", e.coil(coil), coil._replace(rate_fall=slowed(coil.rate_fall or coil.rate, e.time))
    e = drawn("coil.delay", rng, time=(0, 0.1))
    yield "coil.delay", e.coil(coil), coil._replace(delay=0.003 + e.time)
    e = drawn("coil.current_limit", rng, limit=(0.5, 2))
    yield "coil.current_limit", e.coil(coil), coil._replace(max_current=min(1.2, e.limit))


def compare_frame_force(rng):
    time, seed = 0.002 * np.arange(2000), int(rng.integers(100))
    e = drawn("floor.unmeasured_input", rng, rms=(0.1, 2), tone=(1, 50), frequency=(1, 20), phase=(-3, 3))
    e = e._replace(low=1.0, high=9.0)
    white = np.fft.rfft(np.random.default_rng(seed).standard_normal(len(time)))
    frequency = np.fft.rfftfreq(len(time), 0.002)
    noise = np.fft.irfft(white * ((frequency >= 1.0) & (frequency <= 9.0)), len(time))
    expected = e.rms * noise / np.std(noise) + e.tone * np.sin(2 * np.pi * e.frequency * time + e.phase)
    yield "floor.unmeasured_input", e.frame_force(time, seed), expected
    # A band between two lines of the spectrum holds nothing.
    between = e._replace(low=1.01, high=1.02, tone=0.0)
    assert np.array_equal(between.frame_force(time, seed), np.zeros(len(time)))


EQUATIONS = (compare_frictions, compare_gas_spring_and_asymmetry, compare_magnetism, compare_warmth, compare_free_play,
             compare_preyield_hysteresis, compare_suspension, compare_cushion, compare_driver, compare_coil,
             compare_frame_force)  # fmt: skip


@pytest.mark.parametrize("compare", EQUATIONS)
def test_effects_are_their_equations(compare, conform):
    """The deviation is relative, or over 0.001 where less is expected."""
    worst = {}
    for seed in range(DRAWS):
        for name, found, expected in compare(np.random.default_rng(seed)):
            deviation = np.max(np.abs(np.subtract(found, expected)) / np.maximum(np.abs(expected), 1e-3))
            worst[name] = max(worst.get(name, 0.0), deviation)
    for name, deviation in worst.items():
        claim = f"{name}, greatest relative deviation in {DRAWS} draws"
        conform(claim, "the stated equation, written apart (derived)", deviation, tolerance=1e-9)


def test_what_a_sensor_reads_is_in_the_unit_of_its_channel(conform):
    values, rows = np.ones(5), np.arange(5)
    for channel, scale in (("damper_force", 100.0), ("command_voltage", 1.0)):
        e = find("effect", "sensor.bias")(channel=channel, share=0.5, drift=0.1)
        deviation = np.max(np.abs(e.reading(channel, 0.01, values) / (1.0 + scale * (0.5 + 0.001 * rows)) - 1))
        claim = f"sensor.bias of {channel}, greatest relative deviation"
        conform(claim, "the stated equation, written apart (derived)", deviation, tolerance=1e-9)
