"""Modes that no gain moves, by the tests of Popov, Belevitch and Hautus."""

from dataclasses import replace

import numpy as np
import pytest

from controllers.synthesis.plant import GeneralisedPlant
from controllers.synthesis.search import require_stabilisable, scale
from seatsim.schema.errors import SynthesisError


def plant(modes, B2, C2, structure=None):
    n, B2, C2 = len(modes), np.array(B2, dtype=float), np.array(C2, dtype=float)
    one, nu, ny = np.ones((n, 1)), B2.shape[1], len(C2)
    A = np.diag(np.array(modes, dtype=float))
    return GeneralisedPlant(A, one, B2, one.T, C2, [[0]], np.zeros((1, nu)), np.zeros((ny, 1)), structure)


SEEN = [[1, 1, 1]]


def test_stable_modes_may_be_out_of_reach():
    require_stabilisable(scale(plant([-1, 2.5, -3], [[0], [1], [1]], SEEN)))
    require_stabilisable(scale(plant([-1, 2.5, -3], [[1], [1], [1]], [[0, 1, 1]])))


@pytest.mark.parametrize("mode", [0.0, 2.5])
def test_modes_that_are_not_stable_may_not(mode):
    with pytest.raises(SynthesisError, match=f"mode {mode:g} 1/s is not reached by the control input"):
        require_stabilisable(scale(plant([-1, mode, -3], [[1], [0], [1]], SEEN)))
    with pytest.raises(SynthesisError, match=f"mode {mode:g} 1/s is not seen by the measurement"):
        require_stabilisable(scale(plant([-1, mode, -3], [[1], [1], [1]], [[1, 0, 1]])))


def test_a_structure_may_fix_a_mode_that_full_gains_move():
    B2, C2 = [[1, 0], [0, 1], [0, 0]], [[0, 1, 0], [1, 0, 0]]
    require_stabilisable(scale(plant([-1, 2.5, -3], B2, C2)))
    require_stabilisable(scale(plant([-1, 2.5, -3], B2, C2, [[0, 1], [1, 1]])))
    with pytest.raises(SynthesisError, match=r"mode 2\.5 1/s is moved by no gain of this structure"):
        require_stabilisable(scale(plant([-1, 2.5, -3], B2, C2, [[0, 1], [0, 1]])))


def turn(some, seed=0):
    """The same plant in other states, in which nothing is exact."""
    T = np.linalg.qr(np.random.default_rng(seed).standard_normal(some.A.shape))[0]
    return replace(some, A=T @ some.A @ T.T, B1=T @ some.B1, B2=T @ some.B2, C1=some.C1 @ T.T, C2=some.C2 @ T.T)


@pytest.mark.parametrize("rate", [1e-3, 1.0, 1e3])
def test_a_double_fixed_mode_is_fixed_although_rounding_splits_it(rate):
    # The first control reaches the last state of a chain of two, the second measurement alone sees its first; the
    # structure uses the first measurement only.
    chain = plant([-1e-3, 1e3, 1e3, -2e-3], [[0, 1], [0, 0], [1, 0], [0, 1]], [[1, 0, 0, 1], [0, 1, 0, 0]])
    chain = replace(chain, A=rate * (chain.A + np.outer([0, 1, 0, 0], [0, 0, 1, 0])))
    require_stabilisable(scale(turn(chain)))
    with pytest.raises(SynthesisError, match=r"is moved by no gain of this structure"):
        require_stabilisable(scale(turn(replace(chain, structure=np.array([[1, 0], [1, 0]])))))
