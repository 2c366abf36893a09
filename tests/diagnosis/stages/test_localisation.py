"""Shares of the gap by block: from movements of effects, from evidence, and ties between blocks that move as one."""

import itertools

import numpy as np
import pytest

from seatsim.diagnosis.localise.localisation import Remainder, share_gap

from .toy import CHANNELS, Added, offer, place, pose, record, weigh_stated


@pytest.fixture(scope="module")
def objective(folder):
    return weigh_stated(pose(record(folder, (Added("one", 0.5),))))


def rig(objective, *effects):
    terms = [(offer(name, cause), amount) for name, cause, amount in effects]
    return objective.evaluate([place(objective.problem, *terms)])[0]


def as_dict(shares):
    assert all(a.share >= b.share for a, b in itertools.pairwise(shares))
    assert sum(each.share for each in shares) == pytest.approx(1.0)
    return {each.block: each.share for each in shares}


def test_effects_share_the_gap_by_the_power_that_they_move(objective):
    # The same cause twice as strong moves four times the power; two effects of a block add up.
    chosen = rig(objective, ("coil.a", "one", 1.0), ("damper.b", "one", 2.0), ("coil.c", "one", -1.0))
    found = as_dict(share_gap(objective, chosen, None))
    assert list(found) == ["damper", "coil"]
    assert found == pytest.approx({"damper": 4.0 / 6.0, "coil": 2.0 / 6.0})


def test_movements_count_in_standard_deviations_over_all_channels(folder, objective):
    problem = objective.problem
    found = as_dict(share_gap(objective, rig(objective, ("a.x", "frame alone", 1.0), ("b.x", "one", 1.0)), None))
    power = {}
    for cause in ("frame alone", "one"):
        parts = [
            problem.simulated(r, problem.nominal, (Added(cause, 1.0),)) - problem.simulated(r, problem.nominal, ())
            for r in problem.runs
        ]
        power[cause] = np.mean(np.mean(np.concatenate(parts, axis=1) ** 2, axis=1) / problem.spread**2)
    assert found["a"] / found["b"] == pytest.approx(power["frame alone"] / power["one"])
    assert CHANNELS[:2] == problem.channels


def test_a_remainder_stands_first_by_a_fifth_over_the_largest_effect(objective):
    chosen = rig(objective, ("coil.a", "one", 1.0), ("damper.b", "one", 2.0))
    remainder = Remainder({}, {"cushion": 0.8, "driver": 0.2})
    found = as_dict(share_gap(objective, chosen, remainder))
    # 1.2 times 4 to the likeliest block, a quarter of that to the other.
    total = 4.8 + 1.2 + 4.0 + 1.0
    assert list(found)[:2] == ["cushion", "damper"]
    assert found == pytest.approx(
        {"cushion": 4.8 / total, "damper": 4.0 / total, "driver": 1.2 / total, "coil": 1.0 / total}
    )


def test_a_remainder_in_the_block_of_an_effect_adds_to_it(objective):
    found = as_dict(
        share_gap(objective, rig(objective, ("damper.b", "one", 2.0)), Remainder({}, {"damper": 0.5, "coil": 0.5}))
    )
    assert found == pytest.approx({"damper": 2.2 / 3.4, "coil": 1.2 / 3.4})
