"""Rows that were written twice, and rows that are equal by chance."""

import numpy as np
import pytest

from seatsim.recordings.quality.damage import find_repeated_rows
from seatsim.recordings.quality.runs import check_rows

NOISE = np.random.default_rng(0).standard_normal(2000)


SLOW_SINE = 10.0 * np.sin(4.0 * np.pi * np.arange(4000) / 200.0) + 0.03 * np.random.default_rng(1).standard_normal(4000)


def test_rows_that_were_written_twice_are_told_from_those_of_coarse_channels():
    again = NOISE[np.sort([*range(2000), *range(700, 705)])]
    assert find_repeated_rows([again, again**2]).tolist() == [701, 703, 705, 707, 709]
    for coarse in (np.round(SLOW_SINE, 1), np.round(NOISE, 0)):
        assert np.sum(np.diff(coarse) == 0.0) > 25 and len(find_repeated_rows([coarse, coarse**3])) == 0


@pytest.mark.parametrize(("others", "found"), [(NOISE[::-1], 0), (None, 5)])
def test_rows_are_written_twice_only_if_every_channel_repeats(under_test, others, found):
    rows = np.sort([*range(1995), *range(700, 705)])
    table = {name: NOISE[rows] * size for name, size in (("driver_acceleration", 1.0), ("frame_acceleration", 2.0))}
    table["coil_current"] = NOISE[rows] if others is None else others
    run = under_test(table, 500.0, dict.fromkeys(table, 1.0))
    assert [issue.sentence.split()[1] for issue in check_rows(run)] == ["5"] * (found > 0)
