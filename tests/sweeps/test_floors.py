"""What becomes of one run, whatever happens in it."""

import numpy as np

from seatsim.metrics.table import METRICS
from seatsim.scenario.loading import single
from seatsim.sweeps.outcome import FLOORS_KEPT, floor_of, simulate_run

NONE = (None,) * len(METRICS)


def test_a_run_that_fails_after_it_was_made_keeps_its_seed(seat_file):
    made = single(seat_file, {"seed": 9, "excitation.duration": 0.1, "damper.parameters.k0": -1e12})
    found = simulate_run(2, lambda: made, None)
    assert (found.run, found.state, found.seed, found.metrics) == (2, "failed", 9, NONE)


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
