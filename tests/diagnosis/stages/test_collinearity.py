"""Collinearity of effects of a linear seat, against angles between what ridge regressions leave of their signals."""

import numpy as np
import pytest

from seatsim.diagnosis.design.separability import measure_collinearity

from .toy import offer, place, pose, record, weigh_stated, whiten

PRIOR = 0.58


def make_objective(folder, nuisances=2, truth=(), **settings):
    return weigh_stated(pose(record(folder, truth), nuisances, **settings))


def linearise(objective, *terms):
    """Return the linearisation of the rig with terms (candidate, values), which need no fit here."""
    rig = objective.evaluate([place(objective.problem, *terms)])[0]
    return objective.linearise_nuisances(rig)


def compare(objective, nuisances, *names):
    return measure_collinearity(objective, nuisances, names)


def leave(objective, signal, nuisances=("mass", "stiffness")):
    """Return what a ridge regression on the nuisance parameters, a tenth each, leaves of a whitened signal."""
    columns = np.array([0.1 * whiten(objective, cause) for cause in nuisances]).T
    rows = np.vstack([columns, np.eye(len(nuisances)) / PRIOR])
    target = np.concatenate([signal, np.zeros(len(nuisances))])
    return target - rows @ np.linalg.lstsq(rows, target, rcond=None)[0]


def cosine(a, b):
    return abs(a @ b) / np.linalg.norm(a) / np.linalg.norm(b)


def test_fitted_effects_are_as_collinear_as_what_nuisances_leave_of_their_signals(folder):
    objective = make_objective(folder)
    terms = [(offer(f"x.{cause}", cause), size) for cause, size in [("one", 1.0), ("two", -2.0), ("three", 0.5)]]
    names, matrix = compare(objective, linearise(objective, *terms), "x.three", "x.one", "x.two")
    left = [leave(objective, whiten(objective, cause)) for cause in ("three", "one", "two")]
    assert names == ["x.three", "x.one", "x.two"]
    assert np.allclose(matrix, [[cosine(a, b) for b in left] for a in left], atol=1e-6)


def test_names_that_cannot_act_here_are_left_out_and_repeated_ones_said_once(folder):
    objective = make_objective(folder)
    nuisances = linearise(objective, (offer("a", "one"), 1.0))
    found = compare(objective, nuisances, "a", "no.such", "a")
    assert found.effects == ["a"] and np.array_equal(found.matrix, [[1.0]])
    assert compare(objective, nuisances).matrix.shape == (0, 0)


def bend(objective, share):
    return share * whiten(objective, "one") + share**2 * whiten(objective, "three")


@pytest.mark.parametrize("amount", [2.0, 0.5, 0.001, 15.0])
def test_an_effect_that_the_rig_lacks_is_made_as_large_as_the_largest_fitted_one(folder, amount):
    objective = make_objective(folder)
    nuisances = linearise(objective, (offer("a", "two"), amount), (offer("b", "three"), 0.1 * amount))
    sizes = [np.linalg.norm(amount * share * whiten(objective, cause)) for cause, share in [("two", 1), ("three", 0.1)]]
    assert sizes[0] > sizes[1]
    # From its start of 0.2, by no more than a factor of 8, within its bounds of 0 to 0.95.
    share = min(0.2 * np.clip(sizes[0] / np.linalg.norm(bend(objective, 0.2)), 1.0 / 8.0, 8.0), 0.95)
    expected = cosine(leave(objective, whiten(objective, "two")), leave(objective, bend(objective, share)))
    names, matrix = compare(objective, nuisances, "a", "driver.biodynamics", "b")
    assert names[1] == "driver.biodynamics"
    assert matrix[0, 1] == pytest.approx(expected, abs=1e-6)
