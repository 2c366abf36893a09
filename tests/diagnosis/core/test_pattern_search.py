"""A pattern search, against a known minimum."""

import numpy as np
import pytest

from seatsim.diagnosis.fit import list_directions, search_pattern

from .toy import offer, place, pose_tones


@pytest.mark.parametrize(("count", "directions"), [(1, 2), (2, 8), (3, 18)])
def test_neighbours_lie_along_one_parameter_or_two(count, directions):
    found = list_directions(count)
    assert found.shape == (directions, count)
    assert np.all(np.isin(np.count_nonzero(found, axis=1), (1, 2)))
    assert len({tuple(each) for each in found}) == directions


def test_the_search_ends_within_its_smallest_step_of_the_minimum_and_evaluates_no_point_twice():
    objective = pose_tones({"a.one": (0.3, 0.1)}, (0.01, 0.01), {"run": 200}, ["a.one"])
    # The true amount is 1.
    start = objective.evaluate([place(objective.problem, (offer("a.one"), 0.3))])[0]
    found = search_pattern(objective, start)
    # The simulation of the start is the first of them.
    amounts = [round(effect.amount, 9) for _, _, (effect,) in objective.problem.calls]
    assert len(amounts) == len(set(amounts)) > 5
    smallest = objective.settings.fit.pattern_steps[-1] * float(offer("a.one").scale[0])
    assert found.parameters.values[-1][0] == pytest.approx(1.0, abs=smallest)
    assert found.cost < start.cost and np.array_equal(found.parameters.deviations, start.parameters.deviations)
    assert search_pattern(objective, found) is found
