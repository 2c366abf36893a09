"""Tempered evidences of sets, against weights worked out by hand."""

import pytest

from seatsim.diagnosis.decide import Evidence, weigh_effects

BOUNDS = (0.01, 0.9)
NAMES = ["a", "b", "c"]


def weigh(*sets, power=2.0):
    return weigh_all(Evidence(0.1, 0.02, power), [(frozenset(names), left) for names, left in sets], NAMES)


def weigh_all(evidence, sets, names):
    return weigh_effects([(each, evidence.weigh(each, left)) for each, left in sets], names, BOUNDS)


def test_an_effect_has_the_share_of_the_weight_that_lies_in_sets_with_it():
    found = weigh(("", 1.0), ("a", 0.2), ("b", 0.5), ("ab", 0.1))
    total = 1.0 + 0.1 / 0.04 + 0.1 / 0.25 + 0.01 / 0.01
    assert found["a"] == pytest.approx((2.5 + 1.0) / total)
    assert found["b"] == pytest.approx((0.4 + 1.0) / total)
    assert found["c"] == 0.01 and list(found) == NAMES


def test_probabilities_stay_within_their_bounds():
    assert weigh(("", 1.0), ("a", 1e-9)) == {"a": 0.9, "b": 0.01, "c": 0.01}
    # Without any set nothing is known of any effect.
    assert weigh() == dict.fromkeys(NAMES, 0.01)


def test_a_sensor_has_a_prior_of_its_own():
    sets = [(frozenset(), 1.0), (frozenset({"sensor.gain"}), 0.2), (frozenset({"rig.one", "sensor.gain"}), 0.1)]
    found = weigh_all(Evidence(0.1, 0.02, 2.0), sets, ["sensor.gain", "rig.one"])
    total = 1.0 + 0.02 / 0.04 + 0.1 * 0.02 / 0.01
    assert found == pytest.approx({"sensor.gain": (0.5 + 0.2) / total, "rig.one": 0.2 / total})
