"""A pattern search, against a known minimum."""

from dataclasses import dataclass, field

import numpy as np
import pytest

from seatsim.diagnosis.objective import Objective
from seatsim.diagnosis.pattern_search import list_directions, search_pattern

from .toy import offer, place, pose_tones


@dataclass(frozen=True)
class Spy(Objective):
    """An objective that notes the amounts that it is asked for."""

    places: list = field(default_factory=list)

    def evaluate(self, several):
        self.places.extend(each.vector[-1].round(9) for each in several)
        return super().evaluate(several)


@pytest.mark.parametrize(("count", "directions"), [(1, 2), (2, 8), (3, 18)])
def test_neighbours_lie_along_one_parameter_or_two(count, directions):
    found = list_directions(count)
    assert found.shape == (directions, count)
    assert np.all(np.isin(np.count_nonzero(found, axis=1), (1, 2)))
    assert len({tuple(each) for each in found}) == directions


def test_the_search_ends_within_its_smallest_step_of_the_minimum():
    objective = pose_tones({"a.one": (0.3, 0.1)}, (0.01, 0.01), {"run": 200}, ["a.one"])
    # The true amount is 1.
    start = objective.evaluate([place(objective.problem, (offer("a.one"), 0.3))])[0]
    found = search_pattern(objective, start)
    smallest = objective.settings.fit.pattern_steps[-1] * float(offer("a.one").scale[0])
    assert found.parameters.values[-1][0] == pytest.approx(1.0, abs=smallest)
    assert found.cost < start.cost and np.array_equal(found.parameters.deviations, start.parameters.deviations)
    assert search_pattern(objective, found) is found


def test_no_point_is_evaluated_twice():
    objective = pose_tones({"a.one": (0.3, 0.1)}, (0.01, 0.01), {"run": 200}, ["a.one"])
    start = objective.evaluate([place(objective.problem, (offer("a.one"), 0.3))])[0]
    spy = Spy(objective.problem, objective.weights)
    found = search_pattern(spy, start)
    assert found.cost == search_pattern(objective, start).cost
    assert len(spy.places) == len(set(spy.places)) and start.parameters.vector[-1].round(9) not in spy.places
