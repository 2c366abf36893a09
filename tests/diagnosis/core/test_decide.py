"""A table of verdicts, with probabilities worked out by hand from the thresholds."""

import dataclasses
import math

import numpy as np
import pytest

from seatsim.diagnosis.decide import Evidence, decide_verdict, explain_after_all, weigh_effects
from seatsim.diagnosis.result import Cause
from seatsim.diagnosis.select import Selection
from seatsim.diagnosis.solution import decide_beside_unknown, decide_without, doubt_single

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
    terms = [(offer(name), amount) for name, amount in effects.items()]
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


def decide(objective, before, *sets):
    return decide_verdict(objective.problem, selected(objective, before, *sets), EFFECTS)


def logistic(log_odds):
    return 1.0 / (1.0 + math.exp(-log_odds))


def share_of(name, *sets):
    """Return the probability of an effect, from the names and the excess of each set that counts."""
    weights = [(names, 0.05 ** len(names) / (excess + 0.1) ** 4) for names, excess in sets]
    share = sum(weight for names, weight in weights if name in names) / sum(weight for _, weight in weights)
    return min(max(share, 0.006), 0.98)


@pytest.mark.parametrize("excess, sure", [(0.0, logistic(5.0)), (0.1, logistic(3.0)), (0.149, logistic(2.02))])
def test_where_noise_explains_all_there_is_no_gap(rig, excess, sure):
    found = decide(rig, excess, [({"a.one": 1.0}, max(excess - 0.019, 0.0))])
    assert (found.verdict, found.groups, found.chosen.parameters.terms) == ("none", [], ())
    assert found.none == pytest.approx(sure)
    assert found.unknown == 0.02
    assert found.probabilities == dict.fromkeys(EFFECTS, 0.004) and list(found.probabilities) == EFFECTS


def test_a_material_effect_at_few_frequencies_is_a_gap_however_little_the_noise_leaves(rig, faint):
    found = decide(rig, 0.03, [({"a.one": 1.0}, 0.002), ({"b.two": 1.0}, 0.009)])
    assert (found.verdict, found.groups, set(found.chosen.parameters.names)) == ("known", [], {"a.one"})
    assert decide(faint, 0.03, [({"c.three": 1.0}, 0.0)]).verdict == "none"


def test_sets_of_a_small_gap_are_equivalent_only_where_they_leave_nearly_the_same(rig):
    found = decide(rig, 0.03, [({"a.one": 1.0}, 0.002), ({"b.two": 1.0}, 0.006)])
    assert found.groups == [["a.one", "b.two"]]


@pytest.mark.parametrize(
    ("share", "excess", "verdict"), [(0.8, 2.0, "known"), (0.8, 4.0, "unknown"), (0.5, 2.0, "unknown")]
)
def test_a_set_that_takes_most_of_the_gap_may_leave_more_of_the_excess(rig, share, excess, verdict):
    found = decide(rig, 10.0, [({"a.one": share}, 9.5)], [(both(share, share), excess)])
    assert (found.verdict, set(found.chosen.parameters.names)) == (verdict, {"a.one", "b.two"})


def test_a_gap_that_is_not_material_in_any_channel_is_none(faint):
    # RMS of 0.02 standard deviations are left, and the best effect moves no more.
    found = decide(faint, 0.2, [({"c.three": 1.0}, 0.0)])
    assert found.verdict == "none" and found.none == pytest.approx(logistic(2.0 - 0.05 / 0.05))
    # However large the excess, the verdict is likelier than not.
    assert decide(faint, 5.0, [({"c.three": 1.0}, 0.0)]).none == 0.6


def test_without_any_set_nothing_explains_the_gap(rig, faint):
    assert decide(faint, 5.0).verdict == "none"
    found = decide(rig, 5.0)
    assert found.verdict == "unknown" and found.probabilities == dict.fromkeys(EFFECTS, 0.006)


@pytest.mark.parametrize(
    "share, unknown",
    [
        # logistic((log share - log 0.12) / 0.4), from 0.02 to 0.45.
        (0.0, 0.02),
        (0.001, 0.02),
        (0.05, logistic(math.log(0.05 / 0.12) / 0.4)),
        (0.1, logistic(math.log(0.1 / 0.12) / 0.4)),
    ],
)
def test_a_set_that_leaves_little_is_known(rig, share, unknown):
    # Half of the effect is left, which is a material remainder: only the shares can tell.
    found = decide(rig, 10.0, [({"b.two": 0.5}, 10.0 * share)])
    assert (found.verdict, found.groups) == ("known", [])
    assert found.unknown == pytest.approx(unknown)
    expected = dict.fromkeys(EFFECTS, 0.006) | {"b.two": share_of("b.two", ((), 10.0), (("b.two",), 10.0 * share))}
    assert found.probabilities == pytest.approx(expected) and list(found.probabilities) == EFFECTS
    assert found.none == 0.01
    assert found.chosen.parameters.names == {"b.two"}


def test_a_set_that_leaves_much_of_one_channel_is_unknown(rig):
    for left, verdict in ((5.2, "unknown"), (4.8, "known")):
        before = state(rig, {}, 10.0)
        after = ({"b.two": 0.5}, 0.5, (left, 0.1))
        found = decide(rig, before, [after])
        assert found.verdict == verdict
    assert found.unknown == pytest.approx(logistic(math.log(0.05 / 0.12) / 0.4))


@pytest.mark.parametrize("other, verdict", [(0.619, "ambiguous"), (0.621, "known")])
def test_an_effect_that_explains_as_well_makes_the_verdict_ambiguous(rig, other, verdict):
    # As well means up to 1.2 times the excess and 0.02 more.
    found = decide(rig, 10.0, [({"b.two": 0.5}, 0.5), ({"d.four": 1.0}, other)])
    assert found.verdict == verdict
    unknown = logistic(math.log(0.05 / 0.12) / 0.4)
    if verdict == "ambiguous":
        assert found.groups == [["b.two", "d.four"]]
    else:
        assert found.groups == []
    counted = ((), 10.0), (("b.two",), 0.5), (("d.four",), other)
    assert found.probabilities["b.two"] == pytest.approx(share_of("b.two", *counted))
    assert found.probabilities["d.four"] == pytest.approx(share_of("d.four", *counted))
    # An effect that leaves a fifth more has about half the weight.
    assert 0.4 < found.probabilities["d.four"] / found.probabilities["b.two"] < 0.6
    assert found.unknown == pytest.approx(unknown) and found.probabilities["e.five"] == 0.006


def test_a_long_group_under_a_small_remainder_explains_nothing(rig):
    first, second = ({"d.four": 1.0, "b.two": 1.0}, 3.0), ({"e.five": 1.0, "b.two": 1.0}, 3.0)
    one = [({"b.two": 1.0}, 8.0)]
    short = decide(rig, 10.0, one, [(both(), 3.0), first])
    assert short.verdict == "ambiguous" and short.groups == [["a.one", "d.four"]]
    long = decide(rig, 10.0, one, [(both(), 3.0), first, second])
    assert (long.verdict, long.groups) == ("unknown", [])
    assert long.unknown == pytest.approx(logistic(math.log(0.3 / 0.12) / 0.4))
    counted = ((), 10.0), (("b.two",), 8.0), *((("b.two", name), 3.0) for name in ("a.one", "d.four", "e.five"))
    for name in ("a.one", "b.two", "d.four"):
        assert long.probabilities[name] == pytest.approx(share_of(name, *counted))
    # Where the excess is explained too, the group may be as long as it is.
    clear = [({"d.four": 1.0, "b.two": 1.0}, 0.3), ({"e.five": 1.0, "b.two": 1.0}, 0.3)]
    assert decide(rig, 10.0, one, [(both(), 0.3), *clear]).verdict == "ambiguous"


@pytest.mark.parametrize(
    "further, second, size",
    # 0.45 of 2, or 0.7 where less than 12 % was left and the gap falls too, as it does with the other true effect.
    [("d.four", 0.89, 2), ("d.four", 0.91, 1), ("a.one", 1.39, 2), ("a.one", 1.41, 1)],
)
def test_a_set_is_enlarged_where_less_than_a_share_is_left(rig, further, second, size):
    found = decide(rig, 17.0, [({"b.two": 1.0}, 2.0)], [({"b.two": 1.0, further: 1.0}, second)])
    assert len(found.chosen.parameters.terms) == size
    if second > 0.9:
        found = decide(rig, 16.0, [({"b.two": 1.0}, 2.0)], [({"b.two": 1.0, further: 1.0}, second)])
        assert len(found.chosen.parameters.terms) == 1


@pytest.mark.parametrize("first, second, size", [(8.9, 4.1, 1), (8.9, 4.0, 2), (9.1, 4.4, 2), (9.1, 9.2, 0)])
def test_a_first_effect_that_helps_little_is_kept_for_now(rig, first, second, size):
    found = decide(rig, 10.0, [({"b.two": 0.5}, first)], [(both(0.5, 0.5), second)])
    assert len(found.chosen.parameters.terms) == size


def test_an_immaterial_effect_is_neither_chosen_nor_named_beside_the_chosen_one_nor_probable(rig):
    tiny = {"c.three": 1.0}
    found = decide(rig, 10.0, [(tiny, 0.2), ({"a.one": 1e-5}, 0.25), ({"b.two": 1.0}, 0.3), ({"d.four": 1.0}, 0.31)])
    assert found.chosen.parameters.names == {"b.two"} and found.groups == [["b.two", "d.four"]]
    equal = decide(rig, 10.0, [({"b.two": 1.0}, 0.3), (tiny, 0.3)])
    assert equal.verdict == "known" and equal.probabilities["c.three"] == 0.006
    pair = decide(rig, 10.0, [({"b.two": 1.0}, 5.0)], [(both(), 0.3), ({"b.two": 1.0, "c.three": 1.0}, 0.3)])
    assert (pair.verdict, pair.groups) == ("known", [])
    # Where no set of a size is material, no larger one is looked at.
    skipped = decide(rig, 10.0, [(tiny, 0.2)], [(both(), 0.3)])
    assert skipped.chosen.parameters.terms == ()


@pytest.mark.parametrize(
    ("probability", "shrink", "doubted"), [(0.06, 0.55, True), (0.04, 0.55, False), (0.06, 0.51, False)]
)
def test_a_held_out_run_that_speaks_for_another_effect_makes_a_known_one_ambiguous(rig, probability, shrink, doubted):
    known = decide(rig, 10.0, [({"b.two": 0.5}, 0.1)])
    selection = selected(rig, 10.0, [({name: 1.0}, 5.0) for name in ("a.one", "b.two", "c.three")])
    causes = [
        Cause("b.two", 0.9, 0.5, {}),
        Cause("a.one", probability, shrink, {}),
        Cause("c.three", 0.9, 0.9, {}),
        Cause("d.four", 0.006, 0.9, {}),
    ]
    found = doubt_single(rig.problem, selection, known, causes)
    assert (found.verdict, found.groups) == (("ambiguous", [["b.two", "a.one"]]) if doubted else ("known", []))
    joined = doubt_single(rig.problem, selection, dataclasses.replace(known, groups=[["b.two", "d.four"]]), causes)
    assert joined.groups == [["b.two", "d.four", "a.one"] if doubted else ["b.two", "d.four"]]


@pytest.mark.parametrize(
    ("kept", "verdict", "groups"),
    [
        ({"b.two": 0.5}, "ambiguous", [["b.two", "d.four"]]),
        ({"a.one": 1.0}, "known", []),
        ({}, "unknown", []),
        (both(), "none", []),
    ],
)
def test_what_is_left_once_an_effect_was_given_up(rig, kept, verdict, groups):
    known = decide(rig, 10.0, [({"b.two": 0.5}, 5.0)], [(both(), 0.1)])
    given_up = list(EFFECTS) if verdict == "none" else [name for name in both() if name not in kept]
    rest = state(rig, kept, 1.0)
    if verdict == "none":
        # All that was found is taken for the rig without effects, which then leaves no gap.
        rest = dataclasses.replace(rest, parameters=rest.parameters.remove(*EFFECTS))
    ambiguous = dataclasses.replace(known, verdict="ambiguous", groups=[["b.two", "d.four"]])
    found = decide_without(rig.problem, ambiguous, rest, given_up)
    assert (found.verdict, found.groups, found.chosen) == (verdict, groups, rest)
    assert all(found.probabilities[name] == 0.006 for name in given_up)


@pytest.mark.parametrize(("left", "verdict"), [(0.5, "known"), (8.0, "unknown")])
def test_a_set_of_another_search_that_explains_the_gap_is_no_longer_beside_an_unknown_cause(rig, left, verdict):
    calibrated, chosen = state(rig, {}, 10.0), state(rig, {"b.two": 0.5}, left)
    missed = decide(rig, 10.0, [({"b.two": 0.5}, 8.0)])
    beside = decide_beside_unknown(rig.settings.decision, missed, chosen)
    found = explain_after_all(rig.problem, calibrated, chosen, beside)
    assert (beside.verdict, found.verdict) == ("unknown", verdict) and found.chosen is chosen
    assert found.unknown == (0.02 if verdict == "known" else beside.unknown)


def test_a_sensor_has_a_prior_of_its_own():
    evidence, names = Evidence(0.1, 0.02, 2.0), ["sensor.gain", "rig.one"]
    sets = [(frozenset(), 1.0), (frozenset({"sensor.gain"}), 0.2), (frozenset(names), 0.1)]
    found = weigh_effects([(each, evidence.weigh(each, left)) for each, left in sets], names, (0.01, 0.9))
    total = 1.0 + 0.02 / 0.04 + 0.1 * 0.02 / 0.01
    assert found == pytest.approx({"sensor.gain": (0.5 + 0.2) / total, "rig.one": 0.2 / total})
    # Without any set nothing is known of any effect.
    assert weigh_effects([], names, (0.01, 0.9)) == dict.fromkeys(names, 0.01)
