"""Rows that were written twice, and rows that are equal by chance."""

import numpy as np
import pytest

from seatsim.recordings.quality.runs import check_rows, find_repeated_rows

NOISE = np.random.default_rng(0).standard_normal(2000)


SLOW_SINE = 10.0 * np.sin(4.0 * np.pi * np.arange(4000) / 200.0) + 0.03 * np.random.default_rng(1).standard_normal(4000)


@pytest.mark.parametrize(
    ("values", "again"),
    [
        # single rows, and a whole buffer, that were written twice
        (NOISE[np.sort([*range(2000), *range(700, 705)])], [701, 703, 705, 707, 709]),
        (NOISE[[*range(708), *range(700, 2000)]], list(range(708, 716))),
        # a slow sine of a coarse converter, and a rig at rest, repeat themselves by chance
        (np.round(SLOW_SINE, 2), []),
        (np.round(NOISE, 0), []),
    ],
)
def test_rows_that_were_written_twice_are_told_from_equal_ones(values, again):
    assert len(np.unique(values)) < len(values)
    assert find_repeated_rows(values).tolist() == again


def test_coarse_channels_repeat_each_other_by_chance():
    time, generator = np.arange(6000) / 500.0, np.random.default_rng(2)
    slow = np.array([10.0 * np.sin(np.pi * time), np.cos(np.pi * time)])
    motion = slow + 0.01 * generator.standard_normal((2, 6000))
    coarse = np.round(motion / 0.015) * 0.015
    assert np.sum(np.all(coarse[:, 1:] == coarse[:, :-1], axis=0)) > 25
    assert len(find_repeated_rows(coarse)) == 0


@pytest.mark.parametrize(("others", "found"), [(NOISE[::-1], 0), (None, 5)])
def test_rows_are_written_twice_only_if_every_channel_repeats(under_test, others, found):
    rows = np.sort([*range(1995), *range(700, 705)])
    table = {name: NOISE[rows] * size for name, size in (("driver_acceleration", 1.0), ("frame_acceleration", 2.0))}
    table["coil_current"] = NOISE[rows] if others is None else others
    run = under_test(table, 500.0, dict.fromkeys(table, 1.0))
    assert [issue.sentence.split()[1] for issue in check_rows(run)] == ["5"] * (found > 0)
