"""From plants to a design: limits, lower bound, time budget, and one gain for several plants."""

import time

import control
import numpy as np
import pytest

from controllers.synthesis.design import Design
from controllers.synthesis.plant import GeneralisedPlant
from controllers.synthesis.solve import SEAT_TIME_BUDGET, _collect_plants, _limits, synthesise
from seatsim.schema.errors import InputError, SynthesisError

ONE, COLUMN = np.eye(1), np.zeros((2, 1))


def state_feedback(weight=1.0):
    return GeneralisedPlant(-ONE, ONE, ONE, [[weight], [0]], ONE, COLUMN, [[0], [1]], 0 * ONE)


def test_the_design_is_that_of_the_known_optimum():
    lines = []
    design = synthesise(state_feedback(), progress=lines.append, max_gain=7.0)
    assert design.gamma == pytest.approx(np.sqrt(0.5), rel=1e-6)
    assert design.lower_bound == pytest.approx(design.gamma, rel=1e-5) and design.lower_bound <= design.gamma
    assert design.max_gain == 7.0
    assert lines[0] == "searching" and lines[-1] == "the bound of any controller"


def test_limits_come_from_the_largest_gain_and_from_bounds(random_plant):
    plant = random_plant(0)
    low, high = _limits(plant, 5.0, None)
    np.testing.assert_array_equal(low, np.full((2, 2), -5.0))
    np.testing.assert_array_equal(high, np.full((2, 2), 5.0))
    low, high = _limits(plant, 5.0, ([-9.0, 1.0], 3.0))
    np.testing.assert_array_equal(low, [[-5.0, 1.0], [-5.0, 1.0]])
    np.testing.assert_array_equal(high, np.full((2, 2), 3.0))
    for bounds in ((6.0, 7.0), (1.0, 1.0), (2.0, 1.0)):
        with pytest.raises(InputError, match="no room"):
            _limits(plant, 5.0, bounds)
    structured = random_plant(0, structure=[[1, 0], [0, 1]])
    _limits(structured, 5.0, ([[0.0, 1.0], [1.0, 0.0]], [[1.0, 1.0], [1.0, 1.0]]))
    for bounds in ((1.0, 2.0, 3.0), ("a", 1.0), (np.zeros(3), 1.0)):
        with pytest.raises(InputError, match=r"bounds must be \(low, high\)"):
            _limits(plant, 5.0, bounds)


def position_of_an_unstable_mass():
    """x'' = x' + u + w1, y = x + w2, z = (x, u): any static gain leaves the sum of the poles at 1."""
    A, B2, C2 = [[0, 1], [0, 1]], [[0], [1]], [[1, 0]]
    return GeneralisedPlant(A, [[0, 0], [1, 0]], B2, [[1, 0], [0, 0]], C2, np.zeros((2, 2)), [[0], [1]], [[0, 1]])


def test_that_no_gain_stabilises_is_proven_and_said():
    with pytest.raises(SynthesisError, match=r"no gain with \|gain\| <= 100 stabilises this plant: proven for all"):
        synthesise(position_of_an_unstable_mass(), max_gain=100.0)


def test_a_controller_of_first_order_reaches_the_optimum_of_any_order(tmp_path):
    plant = position_of_an_unstable_mass()
    found = synthesise(plant, order=1, max_gain=100.0, time_budget=SEAT_TIME_BUDGET)
    # The bound is that of the linear matrix inequalities of full order; at the optimum one order less suffices.
    assert found.gamma == pytest.approx(found.lower_bound, rel=1e-4)
    assert found.certificate is not None
    found.save(tmp_path / "design.yaml")
    K = Design.load(tmp_path / "design.yaml").controller
    assert K.nstates == 1
    P = control.ss(
        plant.A, np.hstack([plant.B1, plant.B2]), np.vstack([plant.C1, plant.C2]),
        np.block([[plant.D11, plant.D12], [plant.D21, np.zeros((1, 1))]]),
    )  # fmt: skip
    loop = P.lft(K)
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


def test_plants_are_taken_as_they_come(random_plant):
    plant, others = random_plant(0), (None,) * 7
    assert _collect_plants(plant, others, None) == [plant]
    both = [plant, random_plant(1)]
    assert _collect_plants(both, others, None) == both
    parts = [plant.B1, plant.B2, plant.C1, plant.C2, plant.D11, plant.D12, plant.D21]
    (made,) = _collect_plants(plant.A, parts, None)
    np.testing.assert_array_equal(made.D12, plant.D12)
    with pytest.raises(InputError, match="the plant lacks B2, D21; give all of A, B1"):
        _collect_plants(plant.A, [plant.B1, None, *parts[2:6], None], None)
    with pytest.raises(InputError, match="plant 1 has 1 controls, 2 measurements"):
        _collect_plants([plant, random_plant(0, nu=1)], others, None)


def test_time_is_kept(random_plant):
    begin = time.monotonic()
    synthesise(random_plant(7, n=3), max_gain=20.0, time_budget=1.0)
    assert time.monotonic() - begin < 400.0, "a slow computer takes long for its first semidefinite program"
