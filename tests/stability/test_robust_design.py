"""The shipped robust design on the nonlinear seat: light and heavy drivers, a cold and a hot damper."""

import numpy as np
import pytest

import seatsim

NAME = "h-infinity-drivers"
pytestmark = pytest.mark.slow
CORNERS = [(mass, temperature) for mass in (50.0, 120.0) for temperature in (20.0, 80.0)]


@pytest.fixture(scope="module")
def gain():
    scenario = seatsim.load(NAME)[0]
    return scenario.control.law.synthesis(scenario.plant).gain.ravel().tolist()


def run(mass, temperature, controller, **settings):
    condition = {"plant.driver_mass": mass, "temperature": temperature}
    return seatsim.run(NAME, condition | {"controller": controller} | settings)


def cost(result):
    """RMS of the design's performance output, (22.6 x, Wk zc'')."""
    metrics = result.runs[0].metrics
    travel = metrics["suspension_displacement_rms"].value
    return np.hypot(22.6 * travel, metrics["driver_acceleration_weighted"].value)


@pytest.mark.parametrize(("mass", "temperature"), CORNERS)
def test_it_beats_every_constant_current_and_comes_to_rest(gain, mass, temperature):
    feedback = {"law": "static_output_feedback", "gain": gain, "sample_time": 0.005}
    constant = ({"law": "constant", "current": current} for current in (0.0, 0.1, 0.2, 0.4, 0.8))
    assert cost(run(mass, temperature, feedback)) < min(cost(run(mass, temperature, law)) for law in constant)
    rest = {"excitation": {"kind": "rest", "duration": 12.0}, "start": {"displacement": 0.03}}
    result = run(mass, temperature, feedback, **rest)
    assert np.max(np.abs(result["suspension_velocity"][-2000:])) < 1e-3
    assert np.max(np.abs(result["driver_acceleration"][-2000:])) < 1e-2
