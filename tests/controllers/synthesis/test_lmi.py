"""Linear matrix inequalities: their matrices against numpy, their answers against known optima and by eigenvalues."""

import time

import numpy as np
import pytest

from controllers.synthesis.lmi import find_single_step_gain
from controllers.synthesis.norm import hinf_norm
from controllers.synthesis.plant import GeneralisedPlant
from controllers.synthesis.search import scale


def later():
    return time.monotonic() + 30


@pytest.mark.parametrize("e1", [10.0, 30.0, 50.0])
def test_the_single_step_gain_of_the_seat_is_near_the_best(seat, designed, e1):
    scaled = scale(seat(e1))
    gain = find_single_step_gain(scaled.plant, 1.0, later())
    norm = hinf_norm(scaled.plant.close(gain)).value
    assert norm < hinf_norm(scaled.plant.close(0 * gain)).value
    # A solution of the LMI with the structured Lyapunov matrix is no optimum, but within a factor of it.
    assert designed(e1).gamma <= norm < 1.75 * designed(e1).gamma


@pytest.mark.parametrize("size", [1 / 30, 1.0, 30.0])
def test_the_single_step_gain_of_a_measured_state_is_near_the_best_in_any_unit_of_the_state(size):
    # Where y is the state, the structured Lyapunov matrix is no restriction.
    one, column = np.eye(1), np.zeros((2, 1))
    plant = GeneralisedPlant(-one, size * one, size * one, [[1 / size], [0]], one / size, column, [[0], [1]], 0 * one)
    gain = find_single_step_gain(plant, 1.0, later())
    assert hinf_norm(plant.close(gain)).value == pytest.approx(np.sqrt(0.5), rel=0.1)
