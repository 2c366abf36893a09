"""What becomes of one run, whatever happens in it."""

import numpy as np
import pytest

from seatsim.metrics.table import METRICS, Metric
from seatsim.scenario.loading import single
from seatsim.schema.errors import RunError
from seatsim.sweeps.outcome import FLOORS_KEPT, floor_of, history_path, outcome_of, simulate_run

NONE = (None,) * len(METRICS)


@pytest.mark.parametrize(
    ("error", "said"), [(RunError("it is too stiff"), "it is too stiff"), (ValueError("no\nway"), "ValueError: no")]
)
def test_whatever_goes_wrong_is_a_failed_run_without_figures(error, said):
    def make():
        raise error

    found = simulate_run(7, make, None)
    assert (found.run, found.state, found.seed) == (7, "failed", 0)
    assert found.reason.endswith(said) and found.metrics == NONE


def test_a_run_that_fails_after_it_was_made_keeps_its_seed(seat_file):
    made = single(seat_file, {"seed": 9, "excitation.duration": 0.1, "damper.parameters.k0": -1e12})
    found = simulate_run(2, lambda: made, None)
    assert (found.run, found.state, found.seed, found.metrics) == (2, "failed", 9, NONE)


def test_a_run_that_ends_has_figures_and_its_channels_are_kept_where_asked(seat_file, tmp_path):
    made = single(seat_file, {"seed": 9, "excitation.duration": 0.2})
    alone, kept = (simulate_run(4, lambda: made, folder) for folder in (None, tmp_path))
    assert alone == kept and (alone.run, alone.state, alone.reason, alone.seed) == (4, "done", "", 9)
    assert [path.name for path in tmp_path.glob("*.parquet")] == ["run-0000004.parquet"]


def test_figures_stand_in_the_order_of_the_metrics_and_a_missing_one_is_none():
    names = list(METRICS)
    given = {name: Metric(float(k), "m", "") for k, name in enumerate(names) if k != 1}
    found = outcome_of(3, 5, dict(reversed(given.items())), "")
    assert (found.run, found.state, found.reason, found.seed) == (3, "done", "", 5)
    assert found.metrics == (0.0, None, *map(float, range(2, len(names))))
    doubted = outcome_of(3, 5, given, "beyond the data")
    assert (doubted.state, doubted.reason, doubted.metrics) == ("unverified", "beyond the data", found.metrics)


def test_files_of_histories_sort_by_run(tmp_path):
    files = [history_path(tmp_path, number) for number in (2, 10, 1_000_000)]
    assert files == sorted(files) and len(set(files)) == 3
    assert {path.parent for path in files} == {tmp_path}


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
