"""Commands keep their levels where they are put on another time base, and rows of the same time count once."""

import numpy as np
import pytest

from seatsim.importing.alignment import HELD, evened, hold
from seatsim.importing.importing import import_files

from .helpers import read_run, write_csv
from .test_alignment import band_limited

LEVELS = (0.0, 0.3, 1.0)


def staircase(times, length=0.037):
    """A command that jumps among its levels."""
    return np.array(LEVELS)[np.random.default_rng(2).integers(0, 3, 10_000)[(times / length).astype(int)]]


@pytest.mark.parametrize(("rate", "new"), [(100.0, 500.0), (500.0, 300.0), (512.0, 512.0)])
def test_a_held_command_is_that_of_the_last_row_before(rate, new):
    start, times = 0.25, 1.0 + np.arange(4000) / new
    command = staircase(np.arange(5000) / rate)
    found = hold(command, start, rate, times)
    rows = [int(np.nonzero(start + np.arange(5000) / rate <= time + 1e-9)[0][-1]) for time in times]
    np.testing.assert_array_equal(found, command[rows])


def test_before_and_after_its_rows_a_command_is_its_first_and_last_one():
    np.testing.assert_array_equal(hold(np.array([1.0, 2.0, 3.0]), 5.0, 10.0, np.array([0.0, 9.0])), [1.0, 3.0])


@pytest.mark.parametrize("rate", [400.0, 300.0])
def test_a_command_of_another_rate_has_no_level_that_nobody_commanded(rate, tmp_path):
    fast, slow = np.arange(0.0, 20.0, 0.002), np.arange(0.0, 20.0, 1 / rate)
    write_csv(tmp_path / "a.csv", {"time": fast, "floor_acceleration": band_limited(1, fast)})
    write_csv(tmp_path / "b.csv", {"time": slow, "current_command": staircase(slow)})
    found = import_files([tmp_path / "a.csv", tmp_path / "b.csv"], tmp_path / "out")
    table = read_run(tmp_path / "out")
    assert found.rate == 500.0 and set(table.current_command) == set(LEVELS)
    # Each jump is at most a row late.
    assert np.mean(table.current_command != staircase(np.arange(len(table)) / 500.0)) < 1.5 / (0.037 * rate)


@pytest.mark.parametrize("channel", ["floor_acceleration", HELD[0]])
def test_of_rows_of_one_time_the_first_counts(channel):
    times = np.array([0.0, 0.1, 0.21, 0.21, 0.3, 0.41])
    values = np.array([0.0, 0.1, 0.21, 9.0, 0.3, 0.41])
    found = evened("floor_acceleration", values, times, np.array([0.05, 0.2, 0.35]))
    np.testing.assert_allclose(found, [0.05, 0.2, 0.35], atol=1e-12)
    assert evened(channel, values, times, np.array([0.0])) == 0.0


def test_an_uneven_file_with_two_rows_of_one_time_is_read(tmp_path):
    times = np.arange(0.0, 20.0, 0.01) + np.random.default_rng(1).uniform(0.0, 0.004, 2000)
    times[1000] = times[999]
    write_csv(tmp_path / "a.csv", {"time": times, "floor_acceleration": band_limited(1, times, 5.0),
                                   "current_command": staircase(times)})  # fmt: skip
    (tmp_path / "map.yaml").write_text(
        "rig: seat\ntime: {column: time, unit: s}\ngaps: fill\nchannels:\n"
        "  floor_acceleration: {column: floor_acceleration, unit: m/s^2}\n"
        "  current_command: {column: current_command, unit: A}\n"
    )
    found = import_files([tmp_path / "a.csv"], tmp_path / "out", tmp_path / "map.yaml")
    table = read_run(tmp_path / "out")
    even = times[0] + np.arange(len(table)) / found.rate
    assert len(table) == pytest.approx(2000, abs=3)
    np.testing.assert_allclose(table.floor_acceleration[5:-5], band_limited(1, even, 5.0)[5:-5], atol=0.02)
    assert set(table.current_command) == set(LEVELS)
