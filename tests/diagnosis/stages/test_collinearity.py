"""Collinearity of effects of a linear seat, against angles between what ridge regressions leave of their signals."""

import numpy as np
import pytest

from seatsim.diagnosis.design.separability import measure_collinearity
from seatsim.diagnosis.screen import measure_sensitivities
from seatsim.diagnosis.select import Selection

from .toy import offer, place, pose, record, weigh_stated, whiten

PRIOR = 0.58


def make_objective(folder, nuisances=2, truth=()):
    return weigh_stated(pose(record(folder, truth), nuisances))


def compare(objective, names, fitted, offered=()):
    """Return the collinearity of effects, from single ones as they were fitted and from candidates."""
    calibrated, *singles = objective.evaluate([place(objective.problem, *each) for each in ((), *fitted)])
    nuisances = objective.linearise_nuisances(calibrated)
    sensitivities = measure_sensitivities(objective, calibrated, offered)
    selection = Selection(calibrated, ((calibrated,), tuple(singles)), nuisances, sensitivities=sensitivities)
    return measure_collinearity(objective, selection, names)


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
    fitted = [[(offer(f"x.{cause}", cause), size)] for cause, size in [("one", 1.0), ("two", -2.0), ("three", 0.5)]]
    names, matrix = compare(objective, ["x.three", "x.one", "x.two"], fitted)
    left = [leave(objective, whiten(objective, cause)) for cause in ("three", "one", "two")]
    assert names == ["x.three", "x.one", "x.two"]
    assert np.allclose(matrix, [[cosine(a, b) for b in left] for a in left], atol=1e-6)


def test_an_effect_that_was_not_fitted_is_taken_as_its_first_candidate_starts(folder):
    objective = make_objective(folder)
    offered = [offer("a", "one"), offer("b", "three"), offer("b", "one")]
    names, matrix = compare(objective, ["b", "a"], [[(offer("a", "two"), 1.0)]], offered)
    left = [leave(objective, whiten(objective, cause)) for cause in ("three", "two")]
    assert names == ["b", "a"] and matrix[0, 1] == pytest.approx(cosine(*left), abs=1e-6)
