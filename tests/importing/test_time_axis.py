"""Times that are rounded, have gaps or run back, and the runs that become of them."""

import numpy as np
import pytest

from seatsim.importing.importing import import_files
from seatsim.importing.signals import measured_axis
from seatsim.schema.errors import InputError

from .helpers import kinds, write_csv

GENERATOR = np.random.default_rng(4)


def even(rate, rows=2000):
    return 17.3 + np.arange(rows) / rate


@pytest.mark.parametrize("rate", [37.0, 250.0, 333.3, 1024.0])
@pytest.mark.parametrize("step", [0.001, 0.01, 0.1, 1.0])
@pytest.mark.parametrize("rounded", [np.floor, np.round])
def test_rounded_stamps_give_the_rate_to_within_a_row(rate, step, rounded):
    times = even(rate, int(max(2000, 5.0 * rate * step)))
    axis = measured_axis(step * rounded(times / step))
    assert axis.is_even and not len(axis.breaks)
    assert axis.rate == pytest.approx(rate, rel=2.0 / len(times) + 2.0 * step / np.ptp(times) * (step * rate < 1.0))


@pytest.mark.parametrize(("rows", "count"), [([500], 1), ([500, 900, 901], 3)])
def test_lost_and_repeated_rows_are_no_rounding(rows, count):
    lost = measured_axis(np.delete(even(500.0), rows))
    repeated = measured_axis(np.sort(np.append(even(500.0), even(500.0)[rows])))
    assert lost.lost == count and repeated.repeated == count
    assert lost.resolution == repeated.resolution == 0.0 and lost.rate == repeated.rate == 500.0


def test_coarse_stamps_with_a_hole_are_not_even():
    times = np.floor(np.delete(even(250.0, 5000), slice(1500, 2600)))
    axis = measured_axis(times)
    assert not axis.is_even and axis.resolution == 1.0


@pytest.mark.parametrize("times", [even(100.0)[::-1], np.full(50, 3.0), np.array([1.0, 2.0])])
def test_what_does_not_rise_is_no_time(times):
    assert measured_axis(times) is None


def recorded(tmp_path, times, map_text=""):
    table = {"t": times, "floor_acceleration": GENERATOR.standard_normal(len(times))}
    path, stated = write_csv(tmp_path / "a.csv", table), None
    if map_text:
        stated = tmp_path / "map.yaml"
        stated.write_text(f"channels: {{floor_acceleration: {{column: floor_acceleration}}}}\n{map_text}")
    return import_files([path], tmp_path / "out", stated)


def test_a_part_that_is_too_short_for_a_run_is_named(tmp_path):
    times = even(250.0, 1000) + 0.27 * (np.arange(1000) >= 750)
    found = recorded(tmp_path, times)
    assert found.runs == ("run-a-1",)
    assert any("parts of less than 1 s are left out: 0.996 s from 20.57 s on" in note for note in found.notes)


@pytest.mark.parametrize(
    ("times", "map_text", "sentence"),
    [
        (even(250.0, 200), "", "run-a: its channels have 0.796 s in common by their times, at 250 Hz; a run needs 1 s"),
        (
            np.floor(np.delete(even(250.0, 5000), slice(1500, 2600))),
            "",
            "not even by them; state the rate by sample_rate",
        ),
    ],
)
def test_an_import_is_refused_for_the_true_reason(tmp_path, times, map_text, sentence):
    with pytest.raises(InputError, match=sentence):
        recorded(tmp_path, times, map_text)


def test_a_stated_rate_takes_the_place_of_coarse_stamps(tmp_path):
    times = np.floor(even(256.0, 2000))
    assert "rounded" in kinds(recorded(tmp_path, times).doubts)
    found = recorded(tmp_path, times, "time: {column: t, unit: s}\nsample_rate: 256\n")
    assert found.rate == 256.0 and "rounded" not in kinds(found.doubts)
