"""Every law that is linear at small motion: Hurwitz, stable as sampled, on sensors, with delay to spare."""

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.signal import cont2discrete

from controllers.laws.quadratic import EstimateFeedback, SwitchedFeedback
from controllers.optimal import Noise, QuadraticWeights, design_kalman_filter
from controllers.seat_plant import compute_margins
from controllers.synthesis.plant import LinearSystem
from seatsim.rig.control import prepare_law
from seatsim.rig.plant import state_space
from seatsim.rig.sampled_loop import build_sampled_loop, build_seat_with_coil
from seatsim.rig.sensors import Sensors
from seatsim.scenario.loading import load
from seatsim.schema.errors import InputError
from seatsim.schema.registry import name_of, specification_of

from .records import COIL, LINEAR, SEAT, ready

SAMPLE_TIME = 0.005
DESIGNED = {*LINEAR, "clipped_optimal"}
SHIPPED = [one for one in load("laws") if name_of("law", type(one.control.law)) in DESIGNED]


def loop(name, sample_time=SAMPLE_TIME, sensors=None, plant=SEAT):
    return build_sampled_loop(*ready(name, sample_time, plant), plant, COIL, sample_time, sensors)


@pytest.mark.parametrize("mass", [50.0, 80.0, 120.0])
@pytest.mark.parametrize("name", LINEAR)
def test_every_linear_law_is_stable_as_sampled_with_a_sample_of_delay(name, mass):
    plant = SEAT._replace(driver_mass=mass)
    for sensors in (None, Sensors()):
        found = loop(name, sensors=sensors, plant=plant)
        assert found.radius() < 1
        assert found.radius(delay_samples=1) < 1
        assert found.delay_margin() > SAMPLE_TIME


def test_the_general_loop_is_that_of_static_feedback():
    gain, (A, B) = np.array([[2.0, 2147.6, 0.0, 0.0, 0.0]]), build_seat_with_coil(SEAT, COIL)
    found = loop("static_output_feedback")
    F, G, *_ = cont2discrete((A, B, gain, 0.0), SAMPLE_TIME)
    late = np.block([[F, G], [gain, np.zeros((1, 1))]])
    for delay, matrix in enumerate((F + G @ gain, late)):
        assert found.radius(delay) == pytest.approx(np.abs(np.linalg.eigvals(matrix)).max(), rel=1e-9)
    # The hold delays by half a sample.
    margins = compute_margins(LinearSystem(A, B, np.eye(5), np.zeros((5, 1))), gain)
    assert found.delay_margin() == pytest.approx(margins.delay - SAMPLE_TIME / 2, rel=1e-2)


def test_a_law_that_is_unstable_as_sampled_has_no_margin():
    plant = SEAT._replace(driver_mass=20.0)
    found = build_sampled_loop(*ready("lqr", weights=QuadraticWeights(20.0, 1.0, 1e-3)), plant, COIL, SAMPLE_TIME)
    assert found.radius() > 1
    assert found.delay_margin() == 0


@pytest.mark.parametrize("scenario", SHIPPED, ids=lambda one: one.title)
def test_every_shipped_design_is_stable_on_its_sensors_with_a_sample_of_delay(scenario):
    control, initial = scenario.control, specification_of(type(scenario.control.law)).initial
    law = prepare_law(control.law, scenario.plant, scenario.coil, control.sample_time)
    if isinstance(law, SwitchedFeedback):  # whose linear design is that of the LQG it is clipped from
        law = EstimateFeedback(law.gain, law.kalman_filter)
    found = build_sampled_loop(law, initial, scenario.plant, scenario.coil, control.sample_time, control.sensors)
    assert found.radius() < 1
    assert found.radius(delay_samples=1) < 1
    assert found.delay_margin() > control.sample_time


def test_a_law_that_wants_a_current_has_no_linear_loop():
    with pytest.raises(InputError, match="wants a current"):
        loop("on_off_skyhook")


def test_the_filter_is_the_limit_of_the_kalman_recursion():
    noise = Noise()
    e = design_kalman_filter(SEAT, noise, SAMPLE_TIME)
    flow, push, seen = (np.array(part) for part in (e.transition, e.input_gain, e.output))
    fine, s = SAMPLE_TIME / 400, state_space(SEAT)
    steps = [expm(s.A * fine * (k + 0.5)) @ s.B1 for k in range(400)]
    spread = noise.floor * fine * sum(b @ b.T for b in steps) + noise.force**2 * np.outer(push, push)
    reading, p = np.diag([noise.displacement**2, noise.acceleration**2]), np.eye(4)
    for _ in range(3000):
        gain = p @ seen.T @ np.linalg.inv(seen @ p @ seen.T + reading)
        p = flow @ (p - gain @ seen @ p) @ flow.T + spread
    np.testing.assert_allclose(np.array(e.correction).T, gain, rtol=1e-3, atol=1e-6)
