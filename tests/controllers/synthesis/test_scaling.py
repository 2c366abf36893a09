"""Scaled coordinates: the same loop in other units, without rounding."""

import numpy as np
import pytest

from controllers.synthesis.scaling import scale


@pytest.mark.parametrize("seed", range(3))
def test_the_coordinates_do_not_depend_on_the_units_of_disturbance_performance_and_time(random_plant, seed):
    p, far = random_plant(seed), 2.0**20
    made = scale(p)
    louder = scale(type(p)(p.A, p.B1, p.B2, far * p.C1, p.C2, p.D11, p.D12, p.D21))
    faster = scale(type(p)(far * p.A, far * p.B1, far * p.B2, p.C1, p.C2, p.D11, p.D12, p.D21))
    np.testing.assert_array_equal(louder.plant.A, made.plant.A)
    np.testing.assert_array_equal(faster.plant.A, made.plant.A)
    np.testing.assert_array_equal(faster.plant.C2, made.plant.C2)
    assert faster.rate == far * made.rate
