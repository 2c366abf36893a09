"""Stability of the seat under output feedback: linear, sampled, and in full with clip, lag, delay, wrong inverse."""

import bisect

import control
import numpy as np
import pytest
from numpy.polynomial import Polynomial

import seatsim
from controllers.laws.static_output_feedback import OutputFeedback
from controllers.seat_plant import ActuatorLag, Weights, build_generalised_plant, compute_margins
from controllers.synthesis.plant import LinearSystem
from seatsim.rig.coil import Coil
from seatsim.rig.plant import Plant, state_space
from seatsim.rig.sampled_loop import build_sampled_loop

GAIN = np.array([[2.0, 2147.6]])
COIL = Coil(130.0, 1.0)


def seat(driver_mass=80.0):
    return Plant(20.0, driver_mass, 4600.0, 150.0, 60000.0, 1500.0)


def margins(mass):
    designed = build_generalised_plant(seat(mass), Weights(), ActuatorLag(COIL.rate))
    return compute_margins(LinearSystem(designed.A, designed.B2, designed.C2, np.zeros((2, 1))), GAIN)


def radius(mass, sample_time, late=0):
    loop = build_sampled_loop(OutputFeedback(*GAIN[0]), (), seat(mass), COIL, sample_time, step=sample_time)
    return loop.radius(late)


@pytest.mark.parametrize("mass", [40.0, 80.0, 150.0])
def test_the_delay_margin_is_where_the_sampled_loop_loses_stability(mass, conform):
    found, step = margins(mass), 0.0005
    assert found.gain > 2
    assert found.phase > 45
    lost = bisect.bisect_left(range(400), 1.0, key=lambda late: radius(mass, step, late)) * step
    claim = f"delay margin of the gain [2, 2147.6] at {mass:g} kg, s"
    conform(claim, "delay at which the loop sampled at 0.5 ms is unstable", found.delay, lost, tolerance=0.03 * lost)


@pytest.mark.parametrize("gain", [(2.0, 2147.6), (-4000.0, 400.0), (9000.0, -300.0), (-6000.0, 1e4), (0.0, -50.0)])
@pytest.mark.parametrize("mass", [40.0, 150.0])
def test_the_margins_are_those_of_the_polynomials_of_the_loop(mass, gain):
    designed = build_generalised_plant(seat(mass), Weights(), ActuatorLag(COIL.rate))
    found = compute_margins(LinearSystem(designed.A, designed.B2, designed.C2, np.zeros((2, 1))), np.array([gain]))
    loop = control.ss(designed.A, designed.B2, -np.array([gain]) @ designed.C2, 0.0)
    gains, phases, _, _, crossings, _ = control.stability_margins(loop, returnall=True)
    expected = (
        # A loop that is never real has a factor of 1e14 there on some processors, by the rounding of its polynomials.
        min((each for each in gains if 1.0 < each < 1e9), default=np.inf),
        np.min(np.abs(phases), initial=np.inf),
        np.min(np.radians(np.mod(phases, 360.0)) / crossings, initial=np.inf),
    )
    assert found == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize(
    ("claim", "variant", "sign"),
    [
        ("force that opposes the motion", "exact", 1.0),
        ("eqs 13, 18 as printed", "exact", -1.0),
        ("eq 19 as printed", "yu2019", -1.0),
    ],
)
def test_the_literal_sign_of_the_paper_is_unstable(claim, variant, sign, conform):
    plant = Plant(20.0, 80.0, 3800.0, 191.0, 60000.0, 1500.0)
    s = state_space(plant, variant)
    found = np.linalg.eigvals(s.A + sign * s.B2 @ GAIN @ s.C2).real.max()
    k, c = plant.suspension_stiffness + sign * GAIN[0, 0], plant.suspension_damping + sign * GAIN[0, 1]
    cushion, driver = Polynomial([60000.0, 1500.0]), Polynomial([60000.0, 1500.0, 80.0])
    # In eq 15, which eq 19 closes, nothing of the cushion moves the frame.
    frame = Polynomial([k, c, 20.0])
    poles = (frame * driver if variant == "yu2019" else (frame + cushion) * driver - cushion**2).roots()
    exact = poles.real.max()
    claim = f"seat of Yu et al. 2019 under its gain, {claim}: greatest real part of a pole, 1/s"
    conform(claim, "roots of the characteristic polynomial", found, exact, tolerance=1e-6 * abs(exact))
    assert (found < 0) == (sign > 0)


def test_in_the_printed_state_matrix_the_driver_does_not_feel_the_controller(conform):
    s = state_space(seat(), "yu2019")
    driver = [np.linalg.solve(8j * np.eye(4) - s.A - s.B2 @ (scale * GAIN) @ s.C2, s.B1) for scale in (0, 1, 5)]
    answers = [s.C1[1] @ one for one in driver]
    deviation = np.max(np.abs(np.array(answers[1:]) - answers[0])) / np.max(np.abs(answers[0]))
    claim = "eq 15 as printed, response of the driver at 8 rad/s: change by one and five times the gain"
    conform(claim, "misprint of Yu et al. 2019", deviation, tolerance=1e-9)


RELEASED = {"excitation": {"kind": "rest", "duration": 12.0}, "start": {"displacement": 0.02}}
LAST = slice(-2000, None)
BINGHAM = {"model": "original_bingham"}
INVERSES = {"the damper itself": None, "a Bingham damper": BINGHAM, "no temperature": {**BINGHAM, "temperature": 20.0}}


def comes_to_rest(result):
    travel = np.abs(result["suspension_displacement"])
    assert np.max(np.abs(result["suspension_velocity"][LAST])) < 1e-3
    assert travel[-1] <= travel[-4000] + 1e-6
    assert np.max(np.abs(result["driver_acceleration"][LAST])) < 1e-2


@pytest.mark.parametrize("inverse", INVERSES)
@pytest.mark.parametrize(
    ("damper", "temperature"),
    [
        ("bouc_wen", 20.0),
        ("bouc_wen", 80.0),
        pytest.param("modified_bouc_wen", 80.0, marks=pytest.mark.slow),
        pytest.param("yu2019", 80.0, marks=pytest.mark.slow),
    ],
)
def test_no_limit_cycle_of_the_full_loop(kept_seat_file, damper, temperature, inverse):
    settings = {} if damper == "bouc_wen" else {"damper": {"model": damper}}
    fading = {"viscous": -0.0067, "yield_force": -0.0067}
    settings |= {"damper.temperature_factors": fading, "temperature": temperature, "actuator.delay": 0.004}
    settings |= {"controller.inverse": INVERSES[inverse]} if INVERSES[inverse] else {}
    comes_to_rest(seatsim.run(kept_seat_file, settings | RELEASED))
