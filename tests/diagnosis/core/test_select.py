"""Selection on a linear rig: the planted effects are found among decoys, along each of the paths of the search."""

import dataclasses
from itertools import combinations

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from seatsim.diagnosis.select import select_effects
from seatsim.diagnosis.settings import DiagnosisSettings

from .toy import Cubed, add_up, draw_signals, make_problem, offer, stack, weigh_stated

DECOYS = [f"decoy.{k}" for k in range(5)]
PLANTED = ["true.one", "true.two", "true.three"]
RUNS = {"first": 80, "second": 120}


def pose(amounts, mixtures=None, nuisances=1, **selection):
    """Return an objective; `mixtures` are signals that are sums of others, `selection` changes settings."""
    settings = DiagnosisSettings()
    settings = settings._replace(selection=settings.selection._replace(**selection))
    signals = draw_signals(["nominal", "nuisance 0", "nuisance 1", *PLANTED, *DECOYS], RUNS)
    for own in signals.values():
        for name, parts in (mixtures or {}).items():
            own[name] = sum(share * own[part] for part, share in parts.items())
    return weigh_stated(make_problem(signals, add_up(signals, amounts), nuisances, settings))


def search(objective, names=(*DECOYS, *PLANTED), **arguments):
    told = []
    found = select_effects(objective, [offer(name, start=0.3) for name in names], told.append, **arguments)
    return dataclasses.replace(found), told


def names_of(sets):
    return [set(each.parameters.names) for each in sets]


def best_cost(objective, names):
    matrix, target = stack(objective, list(names))
    count = matrix.shape[1] - len(names)
    reach = np.concatenate([np.ones(count), np.full(len(names), 10.0)])
    return 2.0 * lsq_linear(matrix, target, (-reach, reach), method="bvls", tol=1e-14).cost


MIXED = {"decoy.mix": {"true.one": 1.0, "true.two": 1.0, "decoy.0": 0.5}}
"""A decoy that explains more alone than either of the planted effects, which it imitates together."""


@pytest.mark.parametrize(
    "amounts",
    [
        {"true.one": 1.4},
        {"true.one": 1.4, "true.two": -0.6},
        {"true.one": 0.3, "true.two": 0.25, "true.three": -0.2},
        {"decoy.mix": 0.8, "true.two": 0.5},
        {"true.one": 1.0, "true.two": 0.9},
    ],
)
def test_no_shortcut_of_the_search_misses_the_best_of_all_sets(amounts):
    objective, offered = pose(amounts, MIXED), ("decoy.mix", *DECOYS[1:], *PLANTED)
    found, _ = search(objective, offered)
    assert len(found.sets) > len(amounts)
    for size, sets in enumerate(found.sets):
        best = min(combinations(offered, size), key=lambda names: best_cost(objective, names))
        assert sets[0].parameters.names == set(best)
        assert sets[0].cost == pytest.approx(best_cost(objective, best), rel=1e-5)


def test_a_search_ends_where_nothing_is_left_or_an_effect_gains_too_little():
    amounts = {"true.one": 1.4, "true.two": -0.6}
    # Nothing that is below a very large excess is worth explaining.
    assert len(search(pose(amounts, nothing_left=1e9))[0].sets) == 2
    # The first effect leaves a sixth of the gap, which is not less than a tenth.
    assert len(search(pose(amounts, worthwhile=0.1))[0].sets) == 2
    assert len(search(pose(amounts, worthwhile=0.9))[0].sets) == 3


def test_an_effect_is_in_a_set_once_and_the_best_structure_of_it_is_kept():
    objective = pose({"true.one": 1.4, "true.two": -0.6})
    candidates = [offer("true.one", "decoy.0", 0.3), offer("true.one", "true.one", 0.3), offer("true.two", start=0.3)]
    found = select_effects(objective, candidates, lambda _: None)
    singles = {next(iter(each.parameters.names)): each for each in found.sets[1]}
    assert singles["true.one"].parameters.terms[0].fixed == {"signal": "true.one"}
    assert len(found.sets[1]) == 2
    assert names_of(found.sets[2]) == [{"true.one", "true.two"}]


def test_an_effect_of_the_same_form_is_fitted_as_closely_in_the_place_of_the_best():
    objective = pose({"true.one": 1.4, "true.two": -0.6}, shortlist=1)
    twins = [
        offer(name, signal, start=0.3) for signal in ("true.one", "true.two") for name in (signal, f"{signal}.twin")
    ]
    found = select_effects(objective, twins, lambda _: None, 2)
    names = [set(each.parameters.names) for each in found.sets[2][:3]]
    assert {"true.one", "true.two"} in names and {"true.one.twin", "true.two"} in names
    costs = [each.cost for each in found.sets[2][:3]]
    assert costs == pytest.approx([costs[0]] * 3, rel=1e-6)


def test_forms_of_one_effect_leave_another_its_place():
    # Both forms of the decoy start at less cost than the effect itself, and two sets are fitted.
    parts = {"true.one": 0.8, "decoy.0": 0.6}
    objective = pose({"true.one": 1.4}, {"decoy.x": parts, "decoy.y": parts}, finalists=2)
    forms = [offer("decoy.x", "decoy.x", 0.3), offer("decoy.x", "decoy.y", 0.3)]
    found = select_effects(objective, [*forms, offer("true.one", "true.one", 0.03, cls=Cubed)], lambda _: None, 1)
    assert names_of(found.sets[1])[0] == {"true.one"}


def test_the_best_effect_is_fitted_in_its_other_forms():
    # The cube gains little at its start, so that the form that only imitates the effect is ahead of it.
    objective = pose({"true.one": 1.4}, {"decoy.x": {"true.one": 0.8, "decoy.0": 0.6}})
    forms = [offer("true.one", "decoy.x", 0.3), offer("true.one", "true.one", 0.03, cls=Cubed)]
    found = select_effects(objective, forms, lambda _: None, 1)
    (amount,) = found.sets[1][0].parameters.values[0]
    assert found.sets[1][0].parameters.terms[0].cls is Cubed and amount**3 == pytest.approx(1.4, rel=0.01)


def test_a_set_that_is_proposed_takes_its_place_by_its_cost_and_is_a_finalist():
    found, _ = search(pose({"true.one": 1.4, "true.two": -0.6}), largest=2)
    singles = found.sets[1]
    cheaper = dataclasses.replace(singles[-1], cost=0.9 * singles[-1].cost)
    added = found.propose([cheaper, dataclasses.replace(singles[0], cost=1.1 * singles[0].cost)])
    assert sorted(map(sorted, names_of(added.sets[1]))) == sorted(map(sorted, names_of(singles)))
    assert added.sets[1][0] is singles[0] and any(each is cheaper for each in added.sets[1])
    assert (added.sets[0], added.sets[2:]) == (found.sets[0], found.sets[2:])
    finalists = names_of(added.list_finalists(1))
    assert finalists == [set(), set(singles[0].parameters.names), set(singles[-1].parameters.names), {*PLANTED[:2]}]
    larger = dataclasses.replace(found, sets=found.sets[:1]).propose(found.sets[2][:1])
    assert larger.sets == (found.sets[0], (), found.sets[2][:1])
