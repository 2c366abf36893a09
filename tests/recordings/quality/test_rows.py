"""Rows that were written twice, and rows that are equal by chance."""

import numpy as np

from seatsim.recordings.quality.rows import find_repeated_rows

NOISE = np.random.default_rng(0).standard_normal(2000)


def test_single_rows_that_were_written_twice_are_found():
    rows = np.sort([*range(2000), *range(700, 705)])
    assert find_repeated_rows(NOISE[rows]).tolist() == [701, 703, 705, 707, 709]


def test_a_buffer_that_was_written_twice_is_found():
    rows = [*range(708), *range(700, 2000)]
    assert find_repeated_rows(NOISE[rows]).tolist() == list(range(708, 716))


def test_a_slow_sine_of_a_coarse_converter_repeats_itself_by_chance():
    time = np.arange(4000) / 200.0
    noise = 0.03 * np.random.default_rng(1).standard_normal(4000)
    travel = np.round(10.0 * np.sin(4.0 * np.pi * time) + noise, 2)
    assert len(np.unique(travel)) < 4000 and len(find_repeated_rows(travel)) == 0


def test_a_rig_at_rest_repeats_itself_by_chance():
    assert len(find_repeated_rows(np.round(NOISE, 0))) == 0
