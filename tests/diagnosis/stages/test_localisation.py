"""Shares of the gap by block: from movements of effects, from evidence, and ties between blocks that move as one."""

import itertools

import pytest

from seatsim.diagnosis.localise.localisation import Remainder, share_gap

from .toy import Added, offer, place, pose, record, weigh_stated


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
