"""Gradients, scaling, starts and the convex start."""

import time
from itertools import islice

import numpy as np
import pytest

from controllers.synthesis.lmi import find_single_step_gain
from controllers.synthesis.norm import hinf_norm
from controllers.synthesis.objective import NormObjective
from controllers.synthesis.scaling import scale
from controllers.synthesis.starts import generate_starting_gains, project_state_feedback


def objective_of(plant, limit=50.0):
    limits = np.full(plant.free.shape, limit)
    return NormObjective([plant], -limits, limits, np.ones_like(limits))


def slopes(function, theta, step=1e-6):
    unit = np.eye(len(theta)) * step
    return np.array([(function(theta + u)[0] - function(theta - u)[0]) / (2 * step) for u in unit])


@pytest.mark.parametrize("seed", range(6))
def test_gradient_of_the_abscissa(random_plant, seed):
    objective = objective_of(random_plant(seed, structure=[[1, 1], [0, 1]]))
    theta = np.random.default_rng(seed).standard_normal(objective.size)
    np.testing.assert_allclose(objective.abscissa(theta)[1], slopes(objective.abscissa, theta), rtol=1e-4, atol=1e-6)


@pytest.mark.parametrize("e1", [10.0, 50.0])
@pytest.mark.parametrize("gain", [[0.3, 0.5], [-0.2, 1.5]])
def test_gradient_of_the_norm(seat, e1, gain):
    objective = objective_of(scale(seat(e1)).plant)
    theta = objective.angles(np.array(gain))
    np.testing.assert_allclose(objective.log_norm(theta)[1], slopes(objective.log_norm, theta), rtol=1e-4, atol=1e-7)


def test_angles_undo_entries(seat):
    objective = objective_of(scale(seat(30.0)).plant)
    np.testing.assert_allclose(objective.entries(objective.angles(np.array([3.0, -49.0]))), [3.0, -49.0])
    assert np.abs(objective.entries(np.array([1e3, -77.0]))).max() <= 50.0


def test_scaling_keeps_the_norm_and_maps_the_gain(seat):
    plant = seat(30.0)
    scaled = scale(plant)
    gain = np.array([[967.0, 2339.0]])
    small = scaled.scaled_gain(gain)
    np.testing.assert_array_equal(scaled.physical_gain(small), gain)
    raw, moved = hinf_norm(plant.close(gain)), hinf_norm(scaled.plant.close(small))
    assert moved.value == pytest.approx(raw.value, rel=1e-12)
    assert moved.frequency * scaled.rate == pytest.approx(raw.frequency, rel=1e-5)
    assert np.abs(scaled.plant.A).max() < 100


def test_starts_are_seeded_and_respect_the_structure(random_plant):
    plant = random_plant(0, structure=[[1, 0], [1, 1]])
    unit = np.full((2, 2), 8.0)
    first, second = (list(islice(generate_starting_gains([plant], unit, 5), 7)) for _ in range(2))
    np.testing.assert_array_equal(first, second)
    assert not np.any(np.array(first)[:, 0, 0, 1])


def test_sizes_of_changes_are_the_entries_own(random_plant):
    limits, unit = np.full((2, 2), 9.0), np.array([[1.0, 50.0], [1.0, 1.0]])
    objective = NormObjective([random_plant(0, structure=[[1, 1], [0, 0]])], -limits, limits, unit)
    np.testing.assert_allclose(objective.sizes(np.array([4.0, 0.0])), [4.0, 2.0])
    np.testing.assert_allclose(objective.sizes(np.zeros(2)), [1.0, 50.0])


def test_projected_state_feedback_stabilises_where_the_state_is_measured(random_plant):
    plant = random_plant(1, n=3, ny=3)
    assert plant.close(project_state_feedback(plant)).abscissa < 0


@pytest.mark.parametrize("e1", [10.0, 30.0, 50.0])
def test_convex_start_stabilises_the_seat(seat, e1):
    plant = scale(seat(e1)).plant
    gain = find_single_step_gain(plant, 1.0, time.monotonic() + 20)
    assert hinf_norm(plant.close(gain)).value < hinf_norm(plant.close(0 * gain)).value


def test_convex_start_takes_in_measurement_noise(random_plant):
    noisy = random_plant(3, n=2, ny=2, nu=1)
    object.__setattr__(noisy, "D12", 0 * noisy.D12)
    gain = find_single_step_gain(noisy, 1.0, time.monotonic() + 20)
    assert gain.shape == (1, 2) and noisy.close(gain).abscissa < 0


def test_convex_start_knows_what_it_cannot(seat):
    assert find_single_step_gain(scale(seat(30.0, structure=[[0, 1]])).plant, 1.0, time.monotonic() + 20) is None
    assert find_single_step_gain(scale(seat(30.0)).plant, 1.0, time.monotonic() - 1) is None
