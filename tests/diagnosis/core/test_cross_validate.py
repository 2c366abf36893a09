"""Gaps of runs left out, against fits that are computed directly, and the sets of effects that they support."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from seatsim.diagnosis import cross_validate as cv
from seatsim.diagnosis.cross_validate import cross_validate, select_by_cross_validation
from seatsim.diagnosis.noise import weigh_gap
from seatsim.diagnosis.objective import Objective
from seatsim.diagnosis.select import Selection
from seatsim.diagnosis.settings import DiagnosisSettings

from ..builders import refit
from .toy import add_up, draw_signals, make_problem, offer, place, stack, weigh_stated

RUNS = {"first": 80, "second": 100, "third": 120}
NAMES = ["nominal", "nuisance 0", "rig.one", "rig.two", "rig.alike", "rig.overfit", "sensor.lag", "rig.unknown"]
TRUE = {"rig.one": 1.0, "rig.two": 0.7, "rig.unknown": 0.4}


def pose(runs=RUNS, amounts=TRUE, **settings):
    """Return an objective by its gap: two effects at work, their likes, one that fits a single run, and an unknown."""
    default = DiagnosisSettings()
    default = default._replace(cross_validation=default.cross_validation._replace(**settings))
    signals = draw_signals(NAMES, runs)
    for run, own in signals.items():
        own["rig.alike"] = 0.99 * own["rig.one"] + 0.1 * own["rig.alike"]
        own["sensor.lag"] = 0.999 * own["rig.one"] + 0.01 * own["sensor.lag"]
        # It imitates the gap of the last run, and is another thing in the others.
        last = own["rig.one"] + 0.5 * own["rig.two"]
        own["rig.overfit"] = 1.5 * last if run == list(runs)[-1] else 0.5 * own["rig.overfit"]
    problem = make_problem(signals, add_up(signals, amounts), nuisances=1, settings=default)
    nominal = weigh_stated(problem).evaluate([place(problem)])[0]
    return Objective(problem, weigh_gap(problem, nominal.residuals))


def fitted(objective, *names):
    return refit(objective, place(objective.problem, *((offer(name), 0.5) for name in names)))


def left_out(objective, names, folds):
    """Return the errors of runs in the order of the problem, each from least squares over the runs of other folds."""
    problem, errors = objective.problem, []
    for k, run in enumerate(problem.runs):
        others = [other for j, other in enumerate(problem.runs) if j % folds != k % folds]
        matrix, target = stack(objective.on_runs(others), names)
        reach = np.concatenate([[1.0], np.full(len(names), 10.0)])
        best = lsq_linear(matrix, target, (-reach, reach), method="bvls", tol=1e-14).x
        own = problem.signals[run]
        simulated = own["nominal"] + sum(b * own[n] for b, n in zip(best, ["nuisance 0", *names], strict=True))
        left = (problem.measured[run] - simulated) / problem.spread[:, None]
        errors.append(np.sqrt(np.mean(left**2)))
    return np.array(errors)


def leave_out(objective, evaluation):
    return cross_validate(objective, evaluation, objective.linearise_nuisances(evaluation))


@pytest.mark.parametrize("names", [(), ("rig.one",), ("rig.one", "rig.overfit")])
def test_the_gap_of_each_run_is_that_of_a_fit_without_it(names):
    objective = pose()
    found = leave_out(objective, fitted(objective, *names))
    assert found.shape == (3,)
    np.testing.assert_allclose(found, left_out(objective, names, 3), rtol=2e-3)


def test_several_runs_are_left_out_together_where_there_are_more_than_folds(monkeypatch):
    monkeypatch.setattr(cv, "_FOLDS", 2)
    runs = {f"run {k}": 60 + 10 * k for k in range(5)}
    objective = pose(runs)
    names = ("rig.one", "rig.overfit")
    found = leave_out(objective, fitted(objective, *names))
    np.testing.assert_allclose(found, left_out(objective, names, 2), rtol=2e-3)
    assert np.any(np.abs(found / left_out(objective, names, 3) - 1.0) > 0.01)


def test_a_single_run_is_not_left_out():
    objective = pose({"first": 90})
    evaluation = fitted(objective, "rig.one")
    left = evaluation.residuals["first"] / objective.problem.spread[:, None]
    np.testing.assert_allclose(leave_out(objective, evaluation), [np.sqrt(np.mean(left**2))])


def select(objective, *sets):
    """Return the names that runs left out support, and those of the sets that help as much."""
    tried = [[fitted(objective, *names) for names in size] for size in sets]
    calibrated = fitted(objective)
    nuisances = objective.linearise_nuisances(calibrated)
    selection = Selection(calibrated, ((calibrated,), *map(tuple, tried)), nuisances)
    chosen, equivalent, _ = select_by_cross_validation(objective, selection)
    return set(chosen.parameters.names), [set(each.parameters.names) for each in equivalent]


def gain(objective, names, before=()):
    """Return the share of the pooled gap of runs left out that a set of effects takes off."""
    after, alone = (np.mean(left_out(objective, each, 3) ** 2) for each in (names, before))
    return float(1.0 - np.sqrt(after / alone))


def test_what_only_fits_one_run_is_not_chosen_though_it_fits_all_better():
    objective = pose({"first": 80, "second": 100, "third": 300})
    overfit, none = fitted(objective, "rig.overfit"), fitted(objective)
    assert overfit.cost < 0.8 * none.cost
    assert gain(objective, ["rig.overfit"]) < 0.1
    assert select(objective, [("rig.overfit",)]) == (set(), [])
    assert select(objective, [("rig.overfit",), ("rig.two",)]) == ({"rig.two"}, [])


def test_the_smallest_set_is_chosen_that_no_larger_one_betters():
    objective = pose()
    assert gain(objective, ["rig.one"]) > 0.1
    assert gain(objective, ["rig.one", "rig.two"], ["rig.one"]) > 0.1
    assert gain(objective, ["rig.one", "rig.two", "rig.overfit"], ["rig.one", "rig.two"]) < 0.1
    three = ("rig.one", "rig.two", "rig.overfit")
    found = select(objective, [("rig.two",), ("rig.one",)], [("rig.one", "rig.two")], [three])
    assert found == ({"rig.one", "rig.two"}, [])
    # A larger set counts by what it takes off the gap that the smaller one leaves.
    assert select(objective, [("rig.one",)], [("rig.one", "rig.overfit")]) == ({"rig.one"}, [])


def test_sets_that_help_as_much_are_equivalent():
    objective = pose()
    # Two signals that differ by a tenth help alike; another effect does not.
    sets = [("rig.one",), ("rig.alike",), ("rig.two",)]
    ratio = ((1.0 - gain(objective, ["rig.alike"])) / (1.0 - gain(objective, ["rig.one"]))) ** 40
    assert 1.05 < ratio < 2.0
    assert select(objective, sets) == ({"rig.one"}, [{"rig.alike"}])
    assert select(pose(equivalent=0.9 * ratio), sets) == ({"rig.one"}, [])
    assert select(pose(equivalent=1.1 * ratio), sets) == ({"rig.one"}, [{"rig.alike"}])


def test_of_two_that_help_as_much_the_rig_is_chosen_before_the_sensor():
    assert select(pose(), [("sensor.lag",), ("rig.one",)]) == ({"rig.one"}, [{"sensor.lag"}])
    assert select(pose(), [("rig.alike",), ("rig.one",)]) == ({"rig.one"}, [{"rig.alike"}])
    assert select(pose(), [("sensor.lag",)]) == ({"sensor.lag"}, [])


@pytest.mark.parametrize(
    "ratio, pair, is_chosen",
    [
        (1.05, ("rig.one", "rig.two"), True),
        (0.95, ("rig.one", "rig.two"), False),
        (3.2, ("rig.alike", "rig.two"), True),
        (2.8, ("rig.alike", "rig.two"), False),
    ],
)
def test_two_other_effects_take_the_place_of_one_only_where_the_evidence_decides(ratio, pair, is_chosen):
    amounts = TRUE | {"rig.two": 0.4}
    # 0.05 (1 - gain)^-n = ratio
    taken = gain(pose(amounts=amounts), pair, ["rig.one"])
    objective = pose(amounts=amounts, independent=np.log(ratio / 0.05) / -np.log(1.0 - taken))
    chosen = set(pair) if is_chosen else {"rig.one"}
    assert select(objective, [("rig.one",)], [pair]) == (chosen, [])


def test_every_set_tried_is_returned_with_its_weight():
    objective = pose(amounts=TRUE | {"nuisance 0": 0.8})
    calibrated, one, two = (fitted(objective, *names) for names in ((), ("rig.one",), ("rig.two",)))
    selection = Selection(calibrated, ((calibrated,), (one, two)), objective.linearise_nuisances(calibrated))
    tried = select_by_cross_validation(objective, selection).tried
    assert [each for each, _ in tried] == [calibrated, one, two]
    expected = [(1.0 - gain(objective, names)) ** 2 for names in ([], ["rig.one"], ["rig.two"])]
    # The prior of the nuisance parameter raises what is left by as much as it lowers the evidence.
    charged = [np.exp((each.parameters.deviations[0] / 0.58) ** 2 / 40.0) for each in (calibrated, one, two)]
    weights = np.log([1.0, 0.05, 0.05]) - 20.0 * np.log(np.array(expected) * charged)
    np.testing.assert_allclose([weight for _, weight in tried], weights, atol=0.02)


def test_a_lag_of_a_sensor_is_supported_only_where_it_is_no_chance():
    # Its size is 1.3 times its standard deviation, by what the rest of the gap may be.
    weak = pose(amounts={"rig.one": 0.1, "rig.unknown": 1.0}, independent=1e4)
    assert select(weak, [("rig.alike",)]) == ({"rig.alike"}, [])
    assert select(weak, [("sensor.lag",)]) == (set(), [])
    assert select(pose(independent=1e4), [("sensor.lag",)]) == ({"sensor.lag"}, [])
