"""The bounded-real certificate and the lower bounds."""

import numpy as np
import pytest

from controllers import synthesise
from controllers.synthesis.bound import pointwise_bound
from controllers.synthesis.certify import certify, largest_lmi_eigenvalue
from controllers.synthesis.norm import hinf_norm
from controllers.synthesis.plant import GeneralisedPlant, Loop


def stable(plant, seed):
    loop = plant.close(np.zeros(plant.free.shape))
    return Loop(loop.A - (loop.abscissa + 0.3) * np.eye(plant.order), loop.B, loop.C, loop.D)


@pytest.mark.parametrize("seed", range(8))
def test_proves_the_norm_and_nothing_below(random_plant, seed):
    loop = stable(random_plant(seed), seed)
    gamma = hinf_norm(loop).value
    proof = certify(loop, gamma)
    assert proof.delta <= 1e-5
    assert proof.gamma == pytest.approx(gamma * (1 + proof.delta))
    P = proof.matrix
    M = np.block(
        [
            [loop.A.T @ P + P @ loop.A, P @ loop.B, loop.C.T],
            [loop.B.T @ P, -proof.gamma * np.eye(2), loop.D.T],
            [loop.C, loop.D, -proof.gamma * np.eye(3)],
        ]
    )
    assert np.linalg.eigvalsh(P)[0] > 0 > np.linalg.eigvalsh(M)[-1]
    assert certify(loop, gamma * 0.98) is None
    assert largest_lmi_eigenvalue(loop, P, gamma * 0.99) > 0
    assert largest_lmi_eigenvalue(loop, -P, gamma) == np.inf


def test_unstable_loop_has_no_certificate():
    one = np.eye(1)
    assert certify(Loop(one, one, one, 0 * one), 5.0) is None


@pytest.mark.parametrize("seed", range(3))
def test_bounds_stand_in_order(random_plant, seed):
    plant = random_plant(seed, n=3)
    design = synthesise(plant, time_budget=3.0)
    assert 0 < pointwise_bound(plant, design.gain) <= design.lower_bound * (1 + 1e-6) <= design.gamma * (1 + 1e-6)


def test_disturbance_without_effect():
    one = np.eye(1)
    design = synthesise(one, 0 * one, one, one, one, 0 * one, 0 * one, 0 * one)
    assert design.gamma == design.lower_bound == 0
    assert design.certificate is None
    assert design.poles.real.max() < 0


def test_bound_is_reached_where_the_whole_state_is_measured():
    # x' = -x + w + u, z = (x, u), y = x: state feedback k gives 1/sqrt(2) at best, with k = -1.
    one, column = np.eye(1), np.zeros((2, 1))
    plant = GeneralisedPlant(-one, one, one, [[1], [0]], one, column, [[0], [1]], 0 * one)
    design = synthesise(plant)
    assert design.gamma == pytest.approx(np.sqrt(0.5), rel=1e-6)
    np.testing.assert_allclose(design.gain, [[-1.0]], rtol=1e-3)
    assert design.lower_bound == pytest.approx(design.gamma, rel=1e-5)
