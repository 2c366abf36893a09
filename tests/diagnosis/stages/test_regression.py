"""Regressions on runs left out, against ridge regressions solved as least-squares problems."""

import numpy as np
import pytest
from scipy.signal import lfilter

from seatsim.diagnosis.localise import discrepancy
from seatsim.diagnosis.localise.discrepancy import explain_signal, predict_share

from .toy import CHANNELS, RATE, SKIP, place, pose, record


def draw(counts, regressors=3, seed=1):
    rng = np.random.default_rng(seed)
    return {run: rng.standard_normal((regressors, count)) * [[1.0], [50.0], [0.02]] for run, count in counts.items()}


def ridge_errors(train, test):
    """Return what a ridge regression, each regressor scaled to unit RMS, leaves of a target left out."""
    (known, values), (outside, truth) = train, test
    scale = np.sqrt(np.mean(known**2, axis=1))
    strength = discrepancy._RIDGE * len(values)
    rows = np.vstack([(known / scale[:, None]).T, np.sqrt(strength) * np.eye(len(known))])
    target = np.concatenate([values, np.zeros(len(known))])
    coefficients = np.linalg.lstsq(rows, target, rcond=None)[0] / scale
    return truth - coefficients @ outside


def join(parts, runs):
    return np.hstack([parts[run] for run in runs])


def test_each_run_is_predicted_by_the_others():
    regressors = draw({"a": 60, "b": 90, "c": 40})
    rng, coefficients = np.random.default_rng(2), np.array([1.0, -0.02, 30.0])
    target = {run: coefficients @ known + rng.standard_normal(known.shape[1]) for run, known in regressors.items()}
    missed = 0.0
    for run in target:
        others = [other for other in target if other != run]
        train = join(regressors, others), join(target, others)
        missed += np.sum(ridge_errors(train, (regressors[run], target[run])) ** 2)
    expected = 1.0 - missed / sum(np.sum(values**2) for values in target.values())
    assert 0.3 < expected < 0.8
    assert predict_share(regressors, target) == pytest.approx(expected, rel=1e-6)


FAMILIES = ["displacement", "velocity", "velocity and current", "past motion", "remembered motion", "floor motion"]


@pytest.fixture(scope="module")
def problem(folder):
    """A seat whose current changes slowly, and whose noise is little."""
    runs = {"first": 600, "second": 600}
    commands = {
        run: 0.5 + 0.4 * np.sin(np.arange(SKIP + rows) / 40.0 + k) for k, (run, rows) in enumerate(runs.items())
    }
    return pose(record(folder, runs=runs, channels=CHANNELS, commands=commands, noise=0.01))


def of_motion(problem, make):
    """Return a signal by run, made of travel, velocity, current and floor of the nominal simulation."""
    signals = {}
    for run in problem.runs:
        outputs = dict(zip(problem.channels, problem.simulated(run, problem.nominal, ()), strict=True))
        x, i = outputs["suspension_displacement"], outputs["coil_current"]
        floor = problem.recording.table(run)["floor_acceleration"][SKIP : SKIP + len(x)]
        signals[run] = make(x, np.gradient(x, 1.0 / RATE), i, floor)
    return signals


@pytest.mark.parametrize(
    ("make", "family"),
    [
        (lambda x, v, i, a: 1e5 * x**3, "displacement"),
        (lambda x, v, i, a: 30.0 * np.tanh(v / 0.005), "velocity"),
        (lambda x, v, i, a: 30.0 * i * v, "velocity and current"),
        (lambda x, v, i, a: 500.0 * lfilter([1.0 / RATE], [1.0, 1.0 / RATE - 1.0], x), "remembered motion"),
    ],
)
def test_a_force_that_the_rig_makes_is_predicted_by_its_family(problem, make, family):
    found, _ = explain_signal(problem, place(problem), of_motion(problem, make))
    assert max(FAMILIES, key=lambda each: found[each]) == family
    # Averages of rows blur what bends within a row.
    assert found[family] > 0.3 and found["everything"] >= found[family]


def test_an_offset_is_no_sign_of_the_motion(problem):
    rng = np.random.default_rng(3)
    signals = {run: 2.0 + 0.1 * rng.standard_normal(values.shape[1]) for run, values in problem.measured.items()}
    assert explain_signal(problem, place(problem), signals)[0]["everything"] < 0.1


def test_a_single_run_is_predicted_by_halves():
    regressors = draw({"a": 101})
    known = regressors["a"]
    target = np.array([1.0, -0.02, 30.0]) @ known + np.random.default_rng(2).standard_normal(101)
    halves = slice(0, 50), slice(50, 101)
    errors = [
        ridge_errors((known[:, train], target[train]), (known[:, test], target[test]))
        for train, test in (halves, halves[::-1])
    ]
    expected = 1.0 - np.sum(np.concatenate(errors) ** 2) / np.sum(target**2)
    assert predict_share(regressors, {"a": target}) == pytest.approx(expected, rel=1e-6)
