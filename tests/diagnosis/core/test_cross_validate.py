"""Gaps of runs left out, against fits that are computed directly, and the sets of effects that they support."""

import dataclasses

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from seatsim.diagnosis.cross_validate import (
    _charge,
    _foresee,
    _list_equals,
    cross_validate,
    select_by_cross_validation,
)
from seatsim.diagnosis.fit import refit
from seatsim.diagnosis.noise import weigh_gap
from seatsim.diagnosis.objective import Evaluation, Objective
from seatsim.diagnosis.parameters import Parameters
from seatsim.diagnosis.problem import normalise_rms_errors
from seatsim.diagnosis.select import Selection
from seatsim.diagnosis.settings.diagnosis_settings import DiagnosisSettings

from .toy import add_up, draw_signals, make_problem, offer, place, stack, weigh_stated

RUNS = {"first": 80, "second": 100, "third": 120}
NAMES = ["nominal", "nuisance 0", "rig.one", "rig.two", "rig.alike", "rig.overfit", "sensor.alike", "rig.unknown"]
TRUE = {"rig.one": 1.0, "rig.two": 0.7, "rig.unknown": 0.4}


def pose(runs=RUNS, amounts=TRUE, **settings):
    """Return an objective by its gap: two effects at work, their likes, one that fits a single run, and an unknown."""
    default = DiagnosisSettings()
    default = default._replace(cross_validation=default.cross_validation._replace(**settings))
    signals = draw_signals(NAMES, runs)
    for run, own in signals.items():
        own["rig.alike"] = 0.99 * own["rig.one"] + 0.1 * own["rig.alike"]
        own["sensor.alike"] = 0.999 * own["rig.one"] + 0.01 * own["sensor.alike"]
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


def test_the_gap_left_out_is_not_that_of_a_fit_with_all_runs():
    objective = pose()
    evaluation = fitted(objective, "rig.overfit")
    inside = normalise_rms_errors(objective.problem, evaluation.residuals)
    found = leave_out(objective, evaluation)
    # The run that the effect imitates is not foreseen by the others.
    assert np.all(found > inside) and found[2] > 2.0 * inside[2]


def test_a_step_that_makes_all_runs_worse_is_shortened():
    objective = pose()
    evaluation = fitted(objective, "rig.one")
    nuisances = objective.linearise_nuisances(evaluation)
    far = place(objective.problem, (offer("rig.one"), 9.0))
    found = _foresee(objective, evaluation, nuisances, ["first"], far)
    left = found["first"] / objective.problem.spread[:, None]
    assert np.sqrt(np.mean(left**2)) == pytest.approx(leave_out(objective, evaluation)[0], rel=1e-3)


def test_a_step_that_makes_the_runs_left_out_no_worse_is_not_fitted_again():
    objective = pose()
    evaluation = fitted(objective, "rig.one")
    nuisances = objective.linearise_nuisances(evaluation)
    objective.problem.calls.clear()
    _foresee(objective, evaluation, nuisances, ["first"], evaluation.parameters)
    assert [run for run, *_ in objective.problem.calls] == ["first"]


def test_several_runs_are_left_out_together_where_there_are_more_than_folds():
    runs = {f"run {k}": 60 + 10 * k for k in range(5)}
    objective = pose(runs, folds=2)
    names = ("rig.one", "rig.overfit")
    found = leave_out(objective, fitted(objective, *names))
    np.testing.assert_allclose(found, left_out(objective, names, 2), rtol=2e-3)
    assert np.any(np.abs(found / left_out(objective, names, 3) - 1.0) > 0.01)


def test_two_runs_are_left_out_in_turn():
    objective = pose({"first": 90, "second": 100})
    found = leave_out(objective, fitted(objective, "rig.overfit"))
    np.testing.assert_allclose(found, left_out(objective, ["rig.overfit"], 3), rtol=2e-3)


def test_a_single_run_is_not_left_out():
    objective = pose({"first": 90})
    evaluation = fitted(objective, "rig.one")
    left = evaluation.residuals["first"] / objective.problem.spread[:, None]
    np.testing.assert_allclose(leave_out(objective, evaluation), [np.sqrt(np.mean(left**2))])


def select(objective, *sets):
    """Return the names that runs left out support, and those of the sets that help as much."""
    tried = [[fitted(objective, *names) for names in size] for size in sets]
    calibrated = fitted(objective)
    chosen, equivalent, _ = select_by_cross_validation(
        objective, Selection(calibrated, ((calibrated,), *map(tuple, tried)), ())
    )
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


def test_a_search_ends_at_the_first_size_that_does_not_gain():
    objective = pose({"first": 80, "second": 100, "third": 300})
    assert select(objective, [("rig.overfit",)], [("rig.one", "rig.two")]) == (set(), [])


@pytest.mark.parametrize("factor, chosen", [(1.05, {"rig.two"}), (0.95, set())])
def test_an_effect_is_chosen_whose_evidence_outweighs_its_prior(factor, chosen):
    # 0.05 (1 - gain)^-n = 1
    least = -np.log(0.05) / -np.log(1.0 - gain(pose(), ["rig.two"]))
    assert select(pose(independent=factor * least), [("rig.two",)]) == (chosen, [])


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
    assert select(pose(), [("sensor.alike",), ("rig.one",)]) == ({"rig.one"}, [{"sensor.alike"}])
    assert select(pose(), [("rig.alike",), ("rig.one",)]) == ({"rig.one"}, [{"rig.alike"}])
    assert select(pose(), [("sensor.alike",)]) == ({"sensor.alike"}, [])


def test_every_set_tried_is_returned_with_its_weight():
    objective = pose()
    calibrated, one, two = (fitted(objective, *names) for names in ((), ("rig.one",), ("rig.two",)))
    selection = Selection(calibrated, ((calibrated,), (one, two)), ())
    tried = select_by_cross_validation(objective, selection).tried
    assert [each for each, _ in tried] == [calibrated, one, two]
    expected = [(1.0 - gain(objective, names)) ** 2 for names in ([], ["rig.one"], ["rig.two"])]
    # The prior of the nuisance parameter raises what is left by as much as it lowers the evidence.
    charged = [np.exp((each.parameters.deviations[0] / 0.58) ** 2 / 40.0) for each in (calibrated, one, two)]
    weights = np.log([1.0, 0.05, 0.05]) - 20.0 * np.log(np.array(expected) * charged)
    np.testing.assert_allclose([weight for _, weight in tried], weights, atol=0.02)


def test_what_a_structure_is_charged_raises_what_it_leaves():
    rig = Parameters(np.zeros(1))
    assert _charge(pose(), Evaluation(rig, {}, {}, 0.0), 0.5) == 0.5
    assert _charge(pose(), Evaluation(rig, {}, {}, 0.0, charge=1.1), 0.5) == pytest.approx(0.55)
    # The prior of a deviation, exp(-d^2 / (2 std^2)), is one of the evidence, left^-20.
    off = Evaluation(Parameters(np.array([0.3])), {}, {}, 0.0)
    assert (_charge(pose(), off, 0.5) / 0.5) ** -20 == pytest.approx(np.exp(-0.5 * (0.3 / 0.58) ** 2))


def test_a_set_whose_prior_makes_up_for_what_it_leaves_is_equal():
    objective = pose()
    none, one = fitted(objective), fitted(objective, "rig.one")
    # 0.05 left^-20 = 1
    level = 0.05 ** (1.0 / 20.0)
    assert [each for each, _ in _list_equals(objective, [(none, 1.0), (one, level)])] == [none, one]
    assert [each for each, _ in _list_equals(objective, [(none, 1.0), (one, 0.9 * level)])] == [one]
    # Beside a set of a better prior, one that leaves hardly more than the least is equal, too.
    assert [each for each, _ in _list_equals(objective, [(none, 1.0), (one, 0.99)])] == [none, one]


def test_only_the_first_sets_of_a_size_are_cross_validated():
    assert select(pose(sets_compared=1), [("rig.two",), ("rig.one",)])[0] == {"rig.two"}
    assert select(pose(sets_compared=2), [("rig.two",), ("rig.one",)])[0] == {"rig.one"}


def test_an_immaterial_effect_is_not_chosen_however_it_helps():
    objective = pose(amounts={"rig.one": 0.02, "rig.unknown": 0.02})
    loud = dataclasses.replace(
        objective, problem=dataclasses.replace(objective.problem, settings=pose(independent=1e4).settings)
    )
    evaluation = fitted(loud, "rig.one")
    selection = Selection(evaluation, ((fitted(loud),), (evaluation,)), ())
    assert gain(loud, ["rig.one"]) > 0.001
    assert select_by_cross_validation(loud, selection)[0].parameters.terms == ()
