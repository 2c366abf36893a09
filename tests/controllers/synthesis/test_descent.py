"""The descent: its starts, BFGS on functions with known minima, and several starts on plants with a known best gain."""

import time

import numpy as np
import pytest
from scipy.linalg import solve_continuous_are

from controllers.synthesis.descent import StartingGain, explore, minimise, project_state_feedback
from controllers.synthesis.objective import NormObjective
from controllers.synthesis.plant import GeneralisedPlant

ONE, COLUMN = np.eye(1), np.zeros((2, 1))
# x' = -x + w + u, z = (x, u), y = x: gamma^2 = (1 + k^2) / (1 - k)^2 is least, 1/2, at k = -1.
STATE = GeneralisedPlant(-ONE, ONE, ONE, [[1], [0]], ONE, COLUMN, [[0], [1]], 0 * ONE)


def objective(plant=STATE, limit=50.0):
    limits = np.full(plant.free.shape, limit)
    return NormObjective([plant], limits, np.ones_like(limits))


def starts(*gains):
    return [StartingGain(np.array([[float(gain)]]), ONE) for gain in gains]


def later():
    return time.monotonic() + 30


def test_every_start_descends_to_the_known_optimum():
    found = explore(objective(), starts(0.0, -20.0, 5.0), later())
    assert found.starts == 3 and len(found.candidates) == 3 and found.agrees
    assert found.abscissa < -1e-2
    np.testing.assert_allclose([c.gamma for c in found.candidates], np.sqrt(0.5), rtol=2e-3)
    assert found.candidates == sorted(found.candidates, key=lambda c: c.gamma)
    assert found.candidates[0].gamma == objective().norm(found.candidates[0].entries)


def test_a_start_that_is_not_stabilised_tells_how_near_it_came():
    # 1/s^2 with y the position alone: no static gain moves the poles left of the imaginary axis.
    A = np.array([[0.3, 1.0], [0.0, 0.3]])
    plant = GeneralisedPlant(A, [[0], [1]], [[0], [1]], [[1, 0]], [[1, 0]], [[0]], [[0]], [[0]])
    found = explore(objective(plant), starts(0.0, -1.0), later())
    assert not found.candidates and found.starts == 2 and not found.agrees
    assert found.abscissa == pytest.approx(0.3, abs=1e-6)


BOWL = np.array([[3.0, 1.0], [1.0, 40.0]])
CENTRE = np.array([2.0, -1.0])


class Counted:
    """A function with its number of evaluations."""

    def __init__(self, value, gradient):
        self.value, self.gradient, self.calls = value, gradient, 0

    def __call__(self, x, ceiling):
        self.calls += 1
        return float(self.value(x)), np.asarray(self.gradient(x), dtype=float)


def bowl():
    return Counted(lambda x: 0.5 * (x - CENTRE) @ BOWL @ (x - CENTRE), lambda x: BOWL @ (x - CENTRE))


def rosenbrock():
    return Counted(
        lambda x: 100 * (x[1] - x[0] ** 2) ** 2 + (1 - x[0]) ** 2,
        lambda x: [-400 * x[0] * (x[1] - x[0] ** 2) - 2 * (1 - x[0]), 200 * (x[1] - x[0] ** 2)],
    )


@pytest.mark.parametrize(
    ("make", "lowest", "error", "most"), [(bowl, CENTRE, 1e-6, 25), (rosenbrock, [1.0, 1.0], 1e-4, 80)]
)
def test_smooth_minima_are_found_in_few_evaluations(make, lowest, error, most):
    function = make()
    found = minimise(function, np.array([-1.2, 1.0]), np.ones(2), later(), progress=1e-12)
    np.testing.assert_allclose(found.x, lowest, atol=error)
    assert found.value == pytest.approx(function.value(found.x), abs=0)
    assert function.calls < most


def test_state_feedback_is_that_of_the_riccati_equation_where_the_state_is_measured(random_plant):
    plant = random_plant(1, n=3, ny=3)
    P = solve_continuous_are(plant.A, plant.B2, np.eye(3), np.eye(2))
    np.testing.assert_allclose(project_state_feedback(plant) @ plant.C2, -plant.B2.T @ P, rtol=1e-9)
    assert plant.close(project_state_feedback(plant)).abscissa < 0
