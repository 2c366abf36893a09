"""What the search minimises: gradients against central differences, limits, sizes, the worst of several plants."""

from dataclasses import replace

import numpy as np
import pytest

from controllers.synthesis.objective import NormObjective
from controllers.synthesis.plant import GeneralisedPlant
from controllers.synthesis.search import scale


def objective_of(*plants, limit=50.0):
    limits = np.full(plants[0].free.shape, limit)
    return NormObjective(plants, limits, np.ones_like(limits))


def slopes(function, theta, step=1e-6):
    unit = np.eye(len(theta)) * step
    return np.array([(function(theta + u)[0] - function(theta - u)[0]) / (2 * step) for u in unit])


def stable(plant, margin=0.5):
    A = plant.A - (plant.close(np.zeros(plant.free.shape)).abscissa + margin) * np.eye(plant.order)
    return replace(plant, A=A)


@pytest.mark.parametrize("seed", range(6))
def test_gradient_of_the_abscissa(random_plant, seed):
    objective = objective_of(random_plant(seed, structure=[[1, 1], [0, 1]]), random_plant(seed + 50))
    theta = np.random.default_rng(seed).standard_normal(objective.size)
    np.testing.assert_allclose(objective.abscissa(theta)[1], slopes(objective.abscissa, theta), rtol=1e-4, atol=1e-6)
    loops = [plant.close(objective.gain(objective.entries(theta))) for plant in objective.plants]
    assert objective.abscissa(theta)[0] == pytest.approx(max(loop.abscissa for loop in loops), rel=1e-12)


@pytest.mark.parametrize("e1", [10.0, 50.0])
@pytest.mark.parametrize("gain", [[0.3, 0.5], [-0.2, 1.5]])
def test_gradient_of_the_norm(seat, e1, gain):
    objective = objective_of(scale(seat(e1)).plant, scale(seat(30.0)).plant)
    theta = objective.angles(np.array(gain))
    np.testing.assert_allclose(objective.log_norm(theta)[1], slopes(objective.log_norm, theta), rtol=1e-4, atol=1e-7)


def test_unstable_and_silent_loops(random_plant):
    unstable = objective_of(stable(random_plant(0), margin=-0.5))
    assert unstable.norm(np.zeros(4)) == np.inf
    value, slope = unstable.log_norm(np.zeros(4))
    assert value == np.inf and not slope.any()
    assert unstable.log_norm(np.zeros(4), 0.0)[0] == np.inf
    barely = objective_of(stable(random_plant(0), margin=1e-8))
    assert barely.norm(np.zeros(4)) == np.inf
    p = stable(random_plant(0))
    silent = GeneralisedPlant(p.A, 0 * p.B1, p.B2, p.C1, p.C2, 0 * p.D11, p.D12, 0 * p.D21)
    assert objective_of(silent).log_norm(np.zeros(4))[0] == -np.inf
