"""Scaled coordinates: the same loop in other units, without rounding."""

import numpy as np
import pytest

from controllers.synthesis.norm import hinf_norm
from controllers.synthesis.search import scale

GAIN = np.array([[967.0, 2339.0]])


@pytest.fixture
def scaled(seat):
    return scale(seat(30.0))


def test_the_norm_stays_and_the_gain_is_mapped(seat, scaled):
    plant = seat(30.0)
    small = scaled.scaled_gain(GAIN)
    np.testing.assert_array_equal(scaled.physical_gain(small), GAIN)
    raw, moved = hinf_norm(plant.close(GAIN)), hinf_norm(scaled.plant.close(small))
    assert moved.value == pytest.approx(raw.value, rel=1e-12)
    assert moved.frequency * scaled.rate == pytest.approx(raw.frequency, rel=1e-5)


def test_columns_rows_rates_and_both_ends_are_of_one_size(scaled):
    plant = scaled.plant
    for sizes in (np.linalg.norm(plant.B2, axis=0), np.linalg.norm(plant.C2, axis=1)):
        assert np.all((sizes > 0.7) & (sizes < 1.5))
    assert 0.5 <= np.linalg.norm(plant.B1) / np.linalg.norm(plant.C1) <= 2.0
    rates = np.abs(np.linalg.eigvals(plant.A))
    assert 0.7 < np.exp(np.log(rates).mean()) < 1.5
    off = plant.A - np.diag(np.diag(plant.A))
    assert np.abs(off).max() < 20


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
