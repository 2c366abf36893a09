"""What every registered damper fulfils; a new model is tested by being registered."""

import math
from types import SimpleNamespace
from typing import get_args

import numpy as np
import pytest

from seatsim.dampers.base import CONFIDENCE, DAMPERS, Confidence
from seatsim.kernel.bench import FORCE_SCALE
from seatsim.rig.temperature import TemperatureFactors, TemperatureScaling
from seatsim.schema.fields import adapter, describe
from seatsim.simulation.damper_bench import bench_force, sine_test

COLD = TemperatureScaling()
SMOOTH = """bingmax hong_sigmoid_gaussian hydro_mechanical hysteretic_arctangent hysteretic_biviscous kwok_tanh
phase_transition sigmoid_gaussian weng_arctangent yu2019"""
"""Models whose rates have no switch or corner, so that an integrator keeps its order."""
COARSEST, LEVELS, HALVINGS = 256, 6, 3
"""Steps in a cycle of the longest steps, how often they are halved at most, and over how many an order is measured."""


def states(model, specification, count=20):
    """States that the model takes on random motion: its own, at random instants of random bench runs."""
    rng = np.random.default_rng(7)
    found = []
    for _ in range(count):
        x, v = rng.uniform(-0.02, 0.02), rng.uniform(-1, 1) * specification.max_speed
        i = rng.uniform(0, specification.max_current)
        z = specification.initial
        for _ in range(40):
            z = tuple(a + 2e-4 * b for a, b in zip(z, rates_of(model, x, v, i, z), strict=True))
            x += 2e-4 * v
        found.append(SimpleNamespace(x=float(x), v=float(v), i=float(i), z=z))
    return found


def rates_of(model, x, v, i, z):
    return model.rates(x, v, i, COLD, z) if hasattr(model, "rates") else ()


def whole_force(model, s, i, scaling=COLD):
    friction = model.coulomb(i, scaling) if hasattr(model, "coulomb") else 0.0
    return model.force(s.x, s.v, i, scaling, s.z) + friction * math.copysign(1.0, s.v)


def closed_motion(seed, frequency=1.0, samples=4000, cycles=6):
    """A random displacement of period 1/frequency and its velocity, on the half-step grid."""
    rng = np.random.default_rng(seed)
    phase = math.pi / samples * np.arange(2 * cycles * samples + 1)
    x, v = np.zeros_like(phase), np.zeros_like(phase)
    for harmonic in range(1, 6):
        size, shift = rng.normal() / harmonic, rng.uniform(0, 2 * math.pi)
        x += size * np.sin(harmonic * phase + shift)
        v += size * harmonic * 2 * math.pi * frequency * np.cos(harmonic * phase + shift)
    scale = rng.uniform(0.002, 0.02) / np.max(np.abs(x))
    return scale * x, scale * v, 1.0 / (frequency * samples), samples


def runge_kutta(model, specification, x, v, step):
    """Forces every `step` by the model's own rates, at half its greatest current; NaN from where it runs away."""
    force, z, current = np.full((len(x) + 1) // 2, math.nan), specification.initial, 0.5 * specification.max_current
    x, v = x.tolist(), v.tolist()

    def rates(j, h=0.0, slope=specification.initial):
        return model.rates(x[j], v[j], current, COLD, tuple(a + h * b for a, b in zip(z, slope, strict=True)))

    for k in range(len(force)):
        try:
            force[k] = model.force(x[2 * k], v[2 * k], current, COLD, z)
            if k < len(force) - 1:
                k1 = rates(2 * k)
                k2 = rates(2 * k + 1, 0.5 * step, k1)
                k3 = rates(2 * k + 1, 0.5 * step, k2)
                k4 = rates(2 * k + 2, step, k3)
                slopes = zip(z, k1, k2, k3, k4, strict=True)
                z = tuple(a + step / 6.0 * (b + 2.0 * c + 2.0 * d + e) for a, b, c, d, e in slopes)
        except OverflowError:
            break
    return force


def conditions(specification):
    currents = np.linspace(0.0, specification.max_current, 4)
    return [(float(i), float(t)) for i in currents for t in specification.temperatures]


def test_the_card_is_complete(cls, specification):
    assert specification.source
    assert specification.current_order in (0, 1, 2)
    assert specification.max_speed > 0 and specification.max_current > 0
    assert specification.temperatures[0] <= specification.temperatures[1]
    assert isinstance(specification.factors, TemperatureFactors)
    assert bool(specification.initial) == bool(specification.state) == hasattr(cls, "rates")
    assert len([part for part in specification.state.split(";") if part]) == len(specification.initial)
    assert specification.confidence in get_args(Confidence)
    assert set(CONFIDENCE) == {*get_args(Confidence), "own"}
    assert set(specification.fixed) <= set(cls._fields)


def test_every_field_has_unit_meaning_and_default(cls):
    for field in describe(cls):
        assert field.unit and field.meaning and not field.required, field.name


def test_defaults_validate_in_a_round_trip(cls, model):
    assert adapter(cls).validate_python(model._asdict()) == model


def test_force_and_rates_are_finite(model, specification):
    for s in states(model, specification):
        for current in (0.0, specification.max_current, 3.0):
            assert math.isfinite(whole_force(model, s, current))
        assert all(math.isfinite(rate) for rate in rates_of(model, s.x, s.v, s.i, s.z))


def test_the_force_is_the_polynomial_in_the_current_that_the_card_says(model, specification):
    order = specification.current_order
    if order == 0:
        pytest.skip("no polynomial is claimed")
    nodes = np.linspace(0.0, specification.max_current, order + 1)
    for s in states(model, specification):
        law = np.polynomial.Polynomial.fit(nodes, [whole_force(model, s, float(i)) for i in nodes], order)
        for i in np.linspace(0.0, specification.max_current, 7):
            got = whole_force(model, s, float(i))
            assert law(i) == pytest.approx(got, rel=1e-10, abs=1e-9)


def test_steps_converge_at_the_order_of_the_model(model, specification):
    """Halving the step divides the error by 2 where the rates switch, by 8 or more where they are smooth.

    On average over some halvings, from the longest steps that the model bears: an error below 1 % of the force.
    """
    if not specification.initial:
        pytest.skip("has no state: exact at any step")
    motions = [closed_motion(seed, 2.0, 2**LEVELS * COARSEST, 1) for seed in range(2)]
    before, errors = None, []
    for level in reversed(range(LEVELS + 1)):
        thin, now = 2**level, []
        for x, v, step, _ in motions:
            share = specification.max_speed / np.max(np.abs(v))
            force = runge_kutta(model, specification, share * x[::thin], share * v[::thin], thin * step)
            now += [force[:: 2 ** (LEVELS - level)]]
        with np.errstate(over="ignore", invalid="ignore"):
            found = [(f - g) / (FORCE_SCALE + np.abs(f)) for f, g in zip(now, before or now, strict=True)]
            error = np.sqrt(np.mean(np.square(found)))
        errors += [error] if before and error < 0.01 else []
        if len(errors) > HALVINGS:
            break
        before = now
    assert len(errors) > HALVINGS
    assert errors[-1] < errors[0] / (8.0 if DAMPERS.name_of(type(model)) in SMOOTH.split() else 2.0) ** HALVINGS


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_models_with_a_hysteretic_state_dissipate_over_closed_cycles(model, specification, seed):
    if specification.centred:
        pytest.skip("branches on the sign of the displacement: tested on centred sines in tests/robustness")
    x, v, step, samples = closed_motion(seed)
    for current, temperature in conditions(specification):
        force = bench_force(model, x, v, current, temperature, step)[-samples - 1 :]
        power = force * v[::2][-samples - 1 :]
        assert np.trapezoid(power, dx=step) > 0.0


@pytest.mark.slow
@pytest.mark.parametrize(("amplitude", "frequency"), [(0.004, 1.0), (0.005, 1.5), (0.01, 1.0)])
def test_peak_force_grows_with_current(model, specification, amplitude, frequency):
    # Published cubic laws turn down just before the end of their range.
    currents = np.linspace(0.0, 0.9 * specification.max_current, 8)
    peaks = [sine_test(model, amplitude, frequency, float(i), 20.0, samples=400).peak_force for i in currents]
    assert np.all(np.diff(peaks) > -1e-9 * peaks[-1])
    assert peaks[-1] > 2.0 * peaks[0]
