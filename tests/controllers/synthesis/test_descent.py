"""Multi-start descent on plants whose best gain is known."""

import time

import numpy as np
import pytest

from controllers.synthesis.descent import StartingGain, explore
from controllers.synthesis.objective import NormObjective
from controllers.synthesis.plant import GeneralisedPlant

ONE, COLUMN = np.eye(1), np.zeros((2, 1))
# x' = -x + w + u, z = (x, u), y = x: gamma^2 = (1 + k^2) / (1 - k)^2 is least, 1/2, at k = -1.
STATE = GeneralisedPlant(-ONE, ONE, ONE, [[1], [0]], ONE, COLUMN, [[0], [1]], 0 * ONE)


def objective(plant=STATE, limit=50.0):
    limits = np.full(plant.free.shape, limit)
    return NormObjective([plant], -limits, limits, np.ones_like(limits))


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
