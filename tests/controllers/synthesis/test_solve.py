"""From plants to a design: limits, lower bound, time budget, and one gain for several plants."""

import control
import numpy as np
import pytest

from controllers.synthesis.plant import GeneralisedPlant
from controllers.synthesis.solve import SEAT_TIME_BUDGET, synthesise
from seatsim.schema.errors import InputError, SynthesisError

ONE, COLUMN = np.eye(1), np.zeros((2, 1))


def state_feedback():
    return GeneralisedPlant(-ONE, ONE, ONE, [[1], [0]], ONE, COLUMN, [[0], [1]], 0 * ONE)


@pytest.mark.parametrize(("limit", "gain"), [(5.0, -1.0), (0.5, -0.5)])
def test_the_largest_gain_is_kept(limit, gain):
    # Without limits the best gain is -1.
    assert synthesise(state_feedback(), max_gain=limit).gain[0, 0] == pytest.approx(gain, rel=1e-3)


def position_of_an_unstable_mass():
    """x'' = x' + u + w1, y = x + w2, z = (x, u): any static gain leaves the sum of the poles at 1."""
    A, B2, C2 = [[0, 1], [0, 1]], [[0], [1]], [[1, 0]]
    return GeneralisedPlant(A, [[0, 0], [1, 0]], B2, [[1, 0], [0, 0]], C2, np.zeros((2, 2)), [[0], [1]], [[0, 1]])


def test_that_no_gain_stabilises_is_proven_and_said():
    with pytest.raises(SynthesisError, match=r"no gain with \|gain\| <= 100 stabilises this plant: proven for all"):
        synthesise(position_of_an_unstable_mass(), max_gain=100.0)


def test_a_controller_of_first_order_reaches_the_optimum_of_any_order():
    plant = position_of_an_unstable_mass()
    found = synthesise(plant, order=1, max_gain=100.0, time_budget=SEAT_TIME_BUDGET)
    # The bound is that of the linear matrix inequalities of full order; at the optimum one order less suffices.
    assert found.gamma == pytest.approx(found.lower_bound, rel=1e-4)
    assert found.certificate is not None
    K = found.controller
    assert K.nstates == 1
    loop = control.ss(*plant.system).lft(K)
    response = loop(1j * np.geomspace(1e-3, 1e3, 4000)).transpose(2, 0, 1)
    assert loop.poles().real.max() < 0
    assert np.linalg.norm(response, 2, axis=(1, 2)).max() == pytest.approx(found.gamma, rel=1e-4)


@pytest.mark.parametrize("order", [-1, 5, 0.5])
def test_an_order_beyond_four_is_refused(order):
    with pytest.raises(InputError, match=r"order is .*; a controller of order 0 \(a static gain\) to 4 is wanted"):
        synthesise(state_feedback(), order=order)


@pytest.mark.parametrize("option", [{"max_gain": 0.0}, {"max_gain": np.inf}, {"time_budget": -1.0}])
def test_options_are_finite_and_positive(option):
    with pytest.raises(InputError, match=f"{next(iter(option))} is .* a finite number above 0"):
        synthesise(state_feedback(), **option)


def test_plants_of_other_controls_and_matrices_that_are_missing_are_refused(random_plant):
    p = random_plant(0)
    with pytest.raises(InputError, match="the plant lacks B2, D21; give all of A, B1"):
        synthesise(p.A, p.B1, None, p.C1, p.C2, p.D11, p.D12, None)
    with pytest.raises(InputError, match="plant 1 has 1 controls, 2 measurements"):
        synthesise([p, random_plant(0, nu=1)])
