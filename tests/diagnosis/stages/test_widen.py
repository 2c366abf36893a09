"""A second search where parameters end at their bounds: when it is made, when it is stated, and what is said."""

import numpy as np
import pytest

from seatsim.diagnosis.solve import solve
from seatsim.diagnosis.widen import find_at_bound, search_wider
from seatsim.effects.seat import Mass

from .toy import CHANNELS, Added, offer, place, pose, record

RUNS = {"first": 300, "second": 360}
WITHOUT = ["driver.mass"]


def search(problem, said=None):
    first = solve(problem, WITHOUT, lambda _: None)
    progress = (lambda _: None) if said is None else said.append
    return first, *search_wider(first, WITHOUT, progress)


@pytest.fixture(scope="module")
def absorbed(folder):
    """A rig whose nominal mass is off by two and a half times its tolerance of 8 kg, and nothing else is wrong."""
    return pose(record(folder, (Mass(20.0),), RUNS, CHANNELS[:4], noise=0.02), 2)


def test_what_no_parameter_can_take_is_left_to_the_first_search(folder):
    truth = (Mass(9.0), Added("three", 3.0))
    first, second, notes = search(pose(record(folder, truth, RUNS, CHANNELS[:4], noise=0.02), 2))
    assert second is first
    assert len(notes) in (0, 2) and all("the stated tolerance holds" in note for note in notes[1:])


def test_a_parameter_at_its_bound_has_its_values_and_its_key(absorbed):
    rig = place(absorbed, deviations=[-1.0, 0.97])
    assert find_at_bound(absorbed, rig.add(offer("driver.mass", "mass"), np.ones(1))) == {}
    assert find_at_bound(absorbed, rig) == {0: "plant.driver_mass 80 (fitted 72)"}
    assert list(find_at_bound(absorbed, place(absorbed, deviations=[0.2, 0.985]))) == [1]
    assert find_at_bound(absorbed, place(absorbed, deviations=np.zeros(2))) == {}
