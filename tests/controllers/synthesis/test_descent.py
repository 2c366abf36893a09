"""Multi-start descent on plants whose best gain is known."""

import time

import numpy as np
import pytest

from controllers.synthesis.descent import Descent, StabilisingGain, StartingGain, explore, improve
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


def candidates(*gammas):
    return [StabilisingGain(float(gamma), np.array([gamma])) for gamma in gammas]


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


def test_two_explorations_join():
    joint = Descent(candidates(1.0, 3.0), -0.5, 2).with_more(Descent(candidates(2.0), -0.1, 5))
    assert [c.gamma for c in joint.candidates] == [1.0, 2.0, 3.0]
    assert (joint.abscissa, joint.starts) == (-0.5, 7)
    assert not joint.agrees
    assert Descent(candidates(1.0, 1.001), 0.0, 2).agrees
    assert not Descent(candidates(1.0, 1.001), 0.0, 3).agrees


def test_improving_looks_about_the_best_and_never_loses_it():
    poor = StabilisingGain(objective().norm(np.array([-0.3])), np.array([-0.3]))
    better = improve(objective(), poor, 3, later())
    assert better.gamma == pytest.approx(np.sqrt(0.5), rel=1e-6)
    again = improve(objective(), poor, 3, later())
    np.testing.assert_array_equal(again.entries, better.entries)
    assert improve(objective(), poor, 3, time.monotonic() - 1) is poor
    none = StabilisingGain(0.0, np.array([0.0]))
    assert improve(objective(), none, 3, later()) is none
