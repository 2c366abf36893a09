"""BFGS on functions with known minima, its update by the secant equation, its line search by Wolfe's conditions."""

import time

import numpy as np
import pytest

from controllers.synthesis.bfgs import minimise

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


def later():
    return time.monotonic() + 60


@pytest.mark.parametrize(
    ("make", "lowest", "error", "most"), [(bowl, CENTRE, 1e-6, 25), (rosenbrock, [1.0, 1.0], 1e-4, 80)]
)
def test_smooth_minima_are_found_in_few_evaluations(make, lowest, error, most):
    function = make()
    found = minimise(function, np.array([-1.2, 1.0]), np.ones(2), later(), progress=1e-12)
    np.testing.assert_allclose(found.x, lowest, atol=error)
    assert found.value == pytest.approx(function.value(found.x), abs=0)
    assert function.calls < most
