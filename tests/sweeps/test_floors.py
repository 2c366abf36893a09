"""Floors that the runs of a sweep share."""

import numpy as np

from seatsim.scenario.loading import single
from seatsim.sweeps.engines import FLOORS_KEPT, floor_of


def test_a_floor_is_made_once_for_equal_scenarios_and_anew_for_another_seed_or_road(seat_file):
    def floor(**settings):
        return floor_of(single(seat_file, {"excitation.duration": 0.5, **settings}))

    first = floor(seed=1)
    assert floor(seed=1) is first
    for other in (floor(seed=2), floor(seed=1, **{"excitation.spectral_class": "EM1"})):
        assert not np.array_equal(other.acceleration, first.acceleration)
    for seed in range(2, 3 + FLOORS_KEPT):
        floor(seed=seed)
    again = floor(seed=1)
    assert again is not first
    np.testing.assert_array_equal(again.acceleration, first.acceleration)
