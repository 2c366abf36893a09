"""Verdicts on sets whose fits are stated, and the figures of the fits from which their probabilities follow."""

import dataclasses
import math

import numpy as np
import pytest

from seatsim.diagnosis.decide import Decision, decide_beside_unknown, decide_verdict, give_up_effects
from seatsim.diagnosis.localise.discrepancy import Discrepancy
from seatsim.diagnosis.localise.disturbance import Disturbance
from seatsim.diagnosis.localise.input_estimate import InputEstimate
from seatsim.diagnosis.noise import weigh_gap
from seatsim.diagnosis.score import WEIGHTS, Search, list_hypotheses, weigh_hypotheses
from seatsim.diagnosis.select import Selection

from .toy import offer, place, pose_tones

RUNS = {"first": 120, "second": 200}
SIZES = {"a.one": (0.3, 0.0), "b.two": (0.0, 0.5), "c.three": (0.02, 0.0), "d.four": (0.3, 0.1), "e.five": (0.2, 0.1)}
EFFECTS = ["z.other", *SIZES]


@pytest.fixture(scope="module")
def rig():
    """Two effects are at work, each in a channel of its own; the others are decoys."""
    return pose_tones(SIZES, (0.001, 0.001), RUNS, ["a.one", "b.two"])


@pytest.fixture(scope="module")
def faint():
    """What is at work moves nothing by a material size."""
    return pose_tones(SIZES, (0.001, 0.001), RUNS, ["c.three"])


def state(objective, effects, excess, channels=None):
    """Return an evaluation with amounts by effect, whose excess is stated, overall and by channel."""
    terms = [(offer(name, name.removesuffix(".twin")), amount) for name, amount in effects.items()]
    found = objective.evaluate([place(objective.problem, *terms)])[0]
    levels = np.sqrt(1.0 + np.array(channels or (excess, excess)))
    whitened = {run: np.outer(levels, np.ones(values.shape[1])) for run, values in found.whitened.items()}
    return dataclasses.replace(found, whitened=whitened, cost=found.rows * (1.0 + excess))


def both(one=1.0, two=1.0):
    return {"a.one": one, "b.two": two}


def selected(objective, before, *sets):
    """Return a selection from the calibrated excess and, by size, lists of (effects, excess, ...)."""
    calibrated = before if not isinstance(before, float) else state(objective, {}, before)
    larger = (tuple(state(objective, *each) for each in size) for size in sets)
    return Selection(calibrated, ((calibrated,), *larger), objective.linearise_nuisances(calibrated))


def list_alone(objective, before, *sets):
    """Return the hypotheses of a search without a disturbance."""
    return list_hypotheses([Search(objective, selected(objective, before, *sets))])


def decide(objective, before, *sets):
    return decide_verdict([Search(objective, selected(objective, before, *sets))], EFFECTS)


def cost(objective, **costs):
    """Return the objective with other costs of answers."""
    settings = objective.settings
    changed = settings._replace(decision=settings.decision._replace(**costs))
    return dataclasses.replace(objective, problem=dataclasses.replace(objective.problem, settings=changed))


def test_probabilities_are_those_of_all_hypotheses(rig):
    sets = [({"b.two": 1.0}, 0.5), ({"d.four": 1.0}, 3.0)], [(both(), 0.1)]
    selection = selected(rig, 10.0, *sets)
    hypotheses = list_hypotheses([Search(rig, selection)])
    assert [each.names for each in hypotheses] == [{"b.two"}, {"d.four"}, {"a.one", "b.two"}, set()]
    assert hypotheses[-1].rig is None
    scores = [sum(WEIGHTS[name].weight * value for name, value in each.features.items()) for each in hypotheses]
    expected = np.exp(scores) / np.sum(np.exp(scores))
    assert weigh_hypotheses(hypotheses) == pytest.approx(expected)
    found = decide_verdict([Search(rig, selection)], EFFECTS)
    present = {"a.one": expected[2], "b.two": expected[0] + expected[2], "d.four": expected[1]}
    assert found.probabilities == pytest.approx(present | dict.fromkeys(("z.other", "c.three", "e.five"), 0.0))
    assert (found.none, found.unknown) == pytest.approx((0.0, expected[-1]))


def test_features_are_figures_of_the_fits(rig):
    # Both true effects leave no gap; one of them alone leaves that of the other, 0.3 standard deviations in a channel.
    before = state(rig, {}, 10.0, (4.0, 16.0))
    one, two = ({"b.two": 1.0}, 2.0, (3.9, 0.1)), (both(), 0.1, (0.1, 0.1))
    single, pair, unknown = list_alone(rig, before, [one], [two])
    gaps = np.hypot(0.3, 0.5), 0.3, 0.0
    left = [math.log((gap + 0.02) / (gaps[0] + 0.02)) for gap in gaps]
    stated = {"gap": left[1], "gap_gain": left[1], "worst": math.log(3.4 / 4.0 + 0.02), "parameters": 1.0}
    assert single.features == pytest.approx(stated | dict.fromkeys(("movement", "prior", "sensors"), 0.0), abs=3e-2)
    assert pair.features["gap"] == pytest.approx(left[2], abs=0.05)
    assert pair.features["gap_gain"] == pytest.approx(left[2] - left[1], abs=0.05)
    assert pair.features["parameters"] == 2.0
    # An unknown cause has the refitted parameters of the rig without effects.
    assert unknown.features == {"unknown": 1.0, "unknown_prior": 0.0}
    assert {*single.features, *unknown.features} < set(WEIGHTS)


def test_an_effect_that_moves_less_than_material_has_a_feature_of_its_own(rig):
    tiny, large, _ = list_alone(rig, 10.0, [({"c.three": 1.0}, 0.2), ({"b.two": 1.0}, 0.3)])
    assert tiny.features["movement"] == pytest.approx(math.log(0.02 / 0.05 + 0.01), abs=1e-3)
    assert large.features["movement"] == 0.0


def test_an_effect_of_a_set_that_is_not_material_is_not_named(rig):
    single, pair, _ = list_alone(rig, 10.0, [({"b.two": 1.0}, 0.3)], [({"b.two": 1.0, "c.three": 1.0}, 0.1)])
    assert single.names == pair.names == {"b.two"}
    found = decide(rig, 10.0, [({"d.four": 1.0}, 9.0)], [({"b.two": 1.0, "c.three": 1.0}, 0.1)])
    assert found.chosen.parameters.names == {"b.two"}


def test_a_search_beside_a_disturbance_adds_its_sets_and_the_disturbance_alone(rig):
    calibrated, one, both_ = (state(rig, *each) for each in (({}, 10.0), ({"b.two": 1.0}, 6.0), (both(), 0.5)))
    nuisances = rig.linearise_nuisances(calibrated)
    signals = {run: np.sin(np.arange(count)) for run, count in RUNS.items()}
    found = Discrepancy("floor", "force", "N", signals, {"everything": 0.2})
    estimates = {
        run: InputEstimate(values, rig.weights.weights[run] * np.array([[0.4], [0.0]]), np.ones(1), values)
        for run, values in signals.items()
    }
    selection = Selection(calibrated, ((one,), (both_,)), nuisances)
    beside = Search(rig, selection, Disturbance("z.other", found, estimates, rig.weights))
    first = Search(rig, selected(rig, 10.0, [({"b.two": 1.0}, 6.0)]))
    alone, disturbed, with_effects, unknown = list_hypotheses([first, beside])
    assert [each.names for each in (alone, disturbed, with_effects, unknown)] == [
        {"b.two"}, {"b.two", "z.other"}, {"a.one", "b.two", "z.other"}, set()
    ]  # fmt: skip
    assert {*alone.features, *with_effects.features, *unknown.features} == set(WEIGHTS)
    assert "predicted" not in alone.features and with_effects.features["predicted"] == 0.2
    # What the same effects leave without it; a set that was not fitted alone leaves all.
    assert disturbed.features["open"] == pytest.approx(math.log(6.02 / 10.02), abs=1e-3)
    assert with_effects.features["open"] == 0.0
    # Beside a disturbance an effect has credit for what it takes alone, a set that was not fitted alone for nothing.
    assert (disturbed.features["gap"], with_effects.features["gap"]) == (alone.features["gap"], 0.0)
    decision = decide_verdict([first, beside], EFFECTS)
    weights = weigh_hypotheses([alone, disturbed, with_effects, unknown])
    assert decision.probabilities["z.other"] == pytest.approx(weights[1] + weights[2])


def test_where_nothing_material_is_left_there_is_no_gap(rig, faint):
    found = decide(rig, 0.149, [({"a.one": 1.0}, 0.13)])
    assert (found.verdict, found.groups, found.chosen.parameters.terms, found.none) == ("none", [], (), 0.93)
    assert found.none + found.unknown + sum(found.probabilities.values()) == pytest.approx(1.0)
    # RMS of 0.02 standard deviations are left, and the best effect moves no more.
    assert decide(faint, 5.0, [({"c.three": 1.0}, 0.0)]).verdict == "none" == decide(faint, 5.0).verdict
    assert decide(faint, 0.03, [({"c.three": 1.0}, 0.0)]).verdict == "none"


def test_a_material_effect_at_few_frequencies_is_a_gap_however_little_the_noise_leaves(rig):
    assert decide(rig, 0.03, [({"a.one": 1.0}, 0.0), ({"b.two": 1.0}, 0.009)]).verdict != "none"


@pytest.mark.parametrize(
    ("sets", "verdict", "chosen"),
    [
        ([[({"b.two": 0.5}, 5.0)]], "unknown", {"b.two"}),
        ([[({"b.two": 1.0}, 6.0)], [(both(), 0.02)]], "known", {"a.one", "b.two"}),
        ([[({"b.two": 0.1}, 9.5)], [(both(0.1, 0.1), 9.0)]], "unknown", {"b.two"}),
        ([], "unknown", set()),
    ],
)
def test_what_takes_the_gap_is_known(rig, sets, verdict, chosen):
    found = decide(rig, 10.0, *sets)
    assert (found.verdict, found.chosen.parameters.names) == (verdict, chosen)


def test_sets_that_explain_as_much_are_named_together_as_far_as_a_further_name_is_worth_it(rig):
    sets = [({"b.two": 1.0}, 3.0)], [(both(), 0.02), ({"b.two": 1.0, "a.one.twin": 1.0}, 0.021)]
    cheap, dear = (decide(cost(rig, further_name=each, wrong_name=0.0), 10.0, *sets) for each in (0.01, 0.6))
    assert (cheap.verdict, cheap.groups) == ("ambiguous", [["a.one", "a.one.twin"]])
    assert (dear.verdict, dear.groups) == ("known", [])


def test_the_dearer_a_wrong_name_the_more_is_unknown(rig):
    sets = [({"b.two": 1.0}, 1.0)], [(both(), 0.4)]
    verdicts = [decide(cost(rig, wrong_name=each), 10.0, *sets).verdict for each in (0.0, 1e6)]
    assert verdicts == ["known", "unknown"]


@pytest.mark.parametrize(("left", "verdict"), [({}, "unknown"), (both(), "none")])
def test_what_is_left_once_the_effects_were_given_up(rig, left, verdict):
    known = decide(rig, 10.0, [({"b.two": 0.5}, 5.0)], [(both(), 0.1)])
    rest = state(rig, left, 1.0)
    # All that was found is taken for the rig without effects, which then leaves no gap.
    rest = dataclasses.replace(rest, parameters=rest.parameters.remove(*EFFECTS))
    ambiguous = dataclasses.replace(known, verdict="ambiguous", groups=[["b.two", "d.four"]])
    found = give_up_effects(rig.problem, ambiguous, rest)
    assert (found.verdict, found.groups, found.chosen) == (verdict, [], rest)
    assert all(found.probabilities[name] == 0.0 for name in both())


BESIDE = {"a.one": (0.3, 0.3), "b.two": (0.02, 0.02), "z.other": (0.3, 0.3)}


def decide_beside(planted, *sets):
    """Return the decision on amounts by effect, in sets by size, where `z.other`, which is not offered, stays open."""
    noise = pose_tones(BESIDE, (0.001, 0.001), RUNS, planted)
    calibrated = noise.evaluate([place(noise.problem)])[0]
    uniform = dataclasses.replace(noise, weights=weigh_gap(noise.problem, calibrated.residuals))
    search = Search(uniform, selected(uniform, uniform.weigh_again(calibrated), *sets))
    unknown = Decision("unknown", calibrated, [], dict.fromkeys(BESIDE, 0.0), 0.0, 0.4)
    hypotheses = list_hypotheses([search], noise)
    return decide_beside_unknown(noise, unknown, search), hypotheses, weigh_hypotheses(hypotheses, True)


def test_beside_an_unknown_cause_the_effect_is_stated_that_takes_most_of_the_gap():
    small, large = ({"b.two": 1.0}, 9.0), ({"a.one": 1.0}, 5.0)
    found, hypotheses, weights = decide_beside([*BESIDE], [large, small], [({"a.one": 1.0, "b.two": 1.0}, 4.9)])
    assert (found.verdict, found.chosen.parameters.names, found.groups) == ("unknown", {"a.one"}, [])
    assert found.unknown == 0.55
    # Half of the power of the gap is that of the effect, the rest that of what is unknown.
    assert hypotheses[0].features["gap"] == pytest.approx(-0.5 * math.log(2.0), abs=0.03)
    scores = [sum(WEIGHTS[name].beside_unknown * value for name, value in each.features.items()) for each in hypotheses]
    np.testing.assert_allclose(weights, np.exp(scores) / np.sum(np.exp(scores)))
    expected = {"a.one": weights[0] + weights[2], "b.two": weights[1], "z.other": 0.0}
    assert found.probabilities == pytest.approx(expected)


def test_beside_an_unknown_cause_nothing_is_stated_that_takes_little():
    found, _, weights = decide_beside(["z.other"], [({"b.two": 1.0}, 9.0)])
    assert found.chosen.parameters.names == set()
    assert found.probabilities["b.two"] == pytest.approx(weights[0])


def test_effects_beside_an_unknown_cause_that_take_as_much_are_named_together():
    found, _, _ = decide_beside([*BESIDE], [({"a.one": 1.0}, 5.0), ({"a.one.twin": 1.0}, 5.0)])
    assert found.groups == [["a.one", "a.one.twin"]]


def test_two_that_stand_in_for_each_other_are_stated_though_neither_alone_is_likelier_than_nothing():
    found, _, weights = decide_beside([*BESIDE], [({"a.one": 0.1}, 9.0), ({"a.one.twin": 0.1}, 9.0)])
    assert max(weights[:2]) < weights[2] < sum(weights[:2])
    assert (found.chosen.parameters.names, found.groups) == ({"a.one"}, [["a.one", "a.one.twin"]])
