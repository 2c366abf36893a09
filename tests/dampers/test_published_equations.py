"""Every damper against its published equation, written and solved apart from seatsim (see `published`)."""

from typing import NamedTuple

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from seatsim.rig.temperature import TemperatureFactors
from seatsim.schema.registry import name_of
from seatsim.simulation.damper_bench import bench_force

from .published import EQUATIONS, curves, elements, hysteresis

__all__ = ["curves", "elements", "hysteresis"]

FACTORS = TemperatureFactors(-0.004, -0.009, -0.014, 20.0)
DURATION, STEP = 0.6, 2.5e-4
CLOSE = 5e-4
"""Difference from the equation that is accepted, over the largest force: the bench adds up to 1e-4 a step."""
SWITCHING = "lumped_biviscous"
"""A model whose inertia switches at yield: an implicit method stalls there, and the bench is less exact."""


class Point(NamedTuple):
    """What the force depends on, as `published` describes."""

    x: float
    v: float
    i: float
    branch: float
    viscous: float
    elastic: float
    plastic: float


def motion(t, speed):
    """Displacement and velocity of two tones, from rest; the peak speed is about `speed`."""
    a, b = 2 * np.pi * 1.7, 2 * np.pi * 4.1
    x = speed * (0.6 / a * (1 - np.cos(a * t)) + 0.45 / b * (1 - np.cos(b * t)))
    return x, speed * (0.6 * np.sin(a * t) + 0.45 * np.sin(b * t))


def solve(name, damper, current, temperature, speed):
    """The force of the equation in N, every `STEP`, and the displacement and velocity at every half step."""
    equation = EQUATIONS[name]
    scale = np.exp(np.array(FACTORS[:3]) * (temperature - FACTORS.reference))

    def point(t, w):
        return Point(*motion(t, speed), current(t), np.tanh(w / 5e-4), *scale)

    def rates(t, y):
        here = point(t, y[0])
        return [here.v - y[0], *equation.compute(damper, here, *y[1:])[1:]]

    half = np.linspace(0.0, DURATION, 2 * round(DURATION / STEP) + 1)
    rest = [0.0, *equation.rest]
    method, rtol = ("RK45", 1e-6) if name == SWITCHING else ("LSODA", 1e-8)
    found = solve_ivp(rates, (0.0, DURATION), rest, method, half[::2], rtol=rtol, atol=1e-12, max_step=2e-3)
    assert found.success, found.message
    w, *states = found.y
    return equation.compute(damper, point(half[::2], w), *states)[0], half, motion(half, speed)


def test_every_damper_has_its_published_equation(cls):
    assert name_of("damper", cls) in EQUATIONS


@pytest.mark.parametrize("condition", ["cold", "hot, with a current that changes"])
def test_the_force_is_that_of_the_published_equation(cls, model, specification, condition, conform):
    name, most = name_of("damper", cls), specification.max_current
    damper = model._replace(**EQUATIONS[name].parameters)
    temperature = 20.0 if condition == "cold" else 55.0

    def current(t):
        share = 0.4 if condition == "cold" else 0.6 - 0.6 * np.cos(2 * np.pi * t / DURATION)
        return most * share + 0.0 * t

    expected, half, (x, v) = solve(name, damper, current, temperature, specification.max_speed)
    force = bench_force(damper, x, v, current(half), temperature, STEP, FACTORS)
    source = EQUATIONS[name].compute.__doc__.partition(": ")[0].removesuffix(".")
    deviation = np.max(np.abs(force - expected)) / np.max(np.abs(expected))
    claim = f"{name}, {condition}: deviation of the force over its peak"
    conform(claim, source, deviation, tolerance=4e-3 if name == SWITCHING else CLOSE)
