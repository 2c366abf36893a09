"""Linear systems: weightings with states, and an input that is held."""

import numpy as np
import pytest

from controllers.seat_plant import connect_in_parallel, frequency_weighting, second_order_section
from controllers.synthesis.norm import frequency_response
from controllers.synthesis.plant import LinearSystem
from seatsim.metrics import weighting
from seatsim.rig.plant import zero_order_hold

OMEGA = np.geomspace(0.5, 300.0, 40)


def gains(system):
    return frequency_response(LinearSystem(*system), OMEGA)


@pytest.mark.parametrize("name", ["Wk", "Wd"])
def test_weighting_with_states_is_that_of_the_standard(name, conform):
    expected = weighting.frequency_response(OMEGA / (2 * np.pi), name)
    deviation = np.max(np.abs(gains(frequency_weighting(name))[:, 0, 0] / expected - 1))
    claim = f"{name} as state space, greatest relative deviation of the complex gain"
    conform(claim, "the analog filter of the standard", deviation, tolerance=1e-9)


def test_a_section_is_its_quotient_and_its_states_are_of_one_size():
    system, s = second_order_section((3.0, 0.2, 0.05), (2.0, 0.1, 0.04)), 1j * OMEGA
    exact = (3.0 + 0.2 * s + 0.05 * s**2) / (2.0 + 0.1 * s + 0.04 * s**2)
    np.testing.assert_allclose(gains(system)[:, 0, 0], exact, rtol=1e-12)
    assert system.A[0, 1] == -system.A[1, 0] == system.B[1, 0]


def test_a_held_input_moves_a_free_mass_and_a_lag_exactly(conform):
    mass = LinearSystem(np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [2.0]]), np.eye(2), np.zeros((2, 1)))
    lag = LinearSystem(*(np.array([[value]]) for value in (-3.0, 3.0, 1.0, 0.0)))
    flow, push = zero_order_hold(*connect_in_parallel(mass, lag)[:2], 0.5)
    exact = [[1.0, 0.5, 0.0, 0.25, 0.0], [0.0, 1.0, 0.0, 1.0, 0.0], [0.0, 0.0, np.exp(-1.5), 0.0, 1 - np.exp(-1.5)]]
    claim = "held input of a free mass and a lag, greatest deviation of an entry"
    conform(claim, "closed form", np.max(np.abs(np.hstack([flow, push]) - exact)), tolerance=1e-12)
