"""Several files of one run: unequal rates, offsets between clocks, gaps, and the way onto one time base."""

import numpy as np
import pytest

from seatsim.importing.alignment import evened, resample
from seatsim.importing.importing import import_files
from seatsim.schema.errors import InputError

from .helpers import read_run, write_csv

OFFSET = 0.3137


def sines(times, frequencies=(1.3, 4.1, 11.0)):
    return sum(np.sin(2 * np.pi * f * times + f) for f in frequencies)


@pytest.mark.parametrize(("rate", "new"), [(1000.0, 500.0), (200.0, 500.0), (512.0, 300.0)])
def test_what_lies_in_the_band_survives_a_change_of_rate(rate, new):
    times = np.arange(0.0, 20.0, 1 / rate)
    grid = np.arange(1.0, 19.0, 1 / new) + 0.00037
    assert np.max(np.abs(resample(sines(times), 0.0, rate, grid, new) - sines(grid))) < 2e-4


def test_what_lies_above_the_new_band_is_not_folded():
    times, grid = np.arange(0.0, 20.0, 1e-3), np.arange(1.0, 19.0, 0.01)
    assert np.max(np.abs(resample(sines(times, (70.0,)), 0.0, 1000.0, grid, 100.0))) < 1e-3


def band_limited(seed, times, highest=20.0):
    generator = np.random.default_rng(seed)
    frequencies = generator.uniform(0.4, highest, 60)
    return sum(np.sin(2 * np.pi * f * times + p) for f, p in zip(frequencies, generator.uniform(0, 6, 60), strict=True))


@pytest.fixture(scope="module")
def two_files(tmp_path_factory):
    """A fast file of accelerations and a slower one whose clock started later; both have the current."""
    folder = tmp_path_factory.mktemp("two")
    fast, slow = np.arange(0.0, 20.0, 0.002), np.arange(0.0, 18.0, 0.005)
    at = slow + OFFSET
    noise = 0.01 * np.random.default_rng(3).standard_normal(len(slow))
    floor, current = band_limited(1, fast), 0.5 + 0.05 * band_limited(2, fast)
    travel, again = 0.002 * band_limited(4, at), 0.5 + 0.05 * band_limited(2, at) + noise
    return [
        write_csv(folder / "fast.csv", {"time": fast, "floor_acceleration": floor, "coil_current": current}),
        write_csv(folder / "slow.csv", {"time": slow, "suspension_displacement": travel, "coil_current": again}),
    ]


@pytest.fixture(scope="module")
def joined(two_files, tmp_path_factory):
    """The folder of the recording that both give, and what was found of it."""
    folder = tmp_path_factory.mktemp("joined") / "out"
    return folder, import_files(two_files, folder)


def test_a_shared_channel_shows_the_offset(joined):
    folder, found = joined
    assert found.map.align["slow.csv"] == pytest.approx(OFFSET, abs=5e-4)
    said = next(note for note in found.notes if "moved against fast.csv" in note)
    assert "coil_current" in said and found.rate == 500.0
    table = read_run(folder)
    # The run begins where the later file does.
    expected = 0.002 * band_limited(4, OFFSET + table["time"])
    inner = slice(200, -200)
    assert np.std((table["suspension_displacement"] - expected)[inner]) < 0.01 * np.std(expected)


def test_a_stated_offset_is_used_as_it_is(two_files, joined, tmp_path):
    text = (joined[0] / "map.yaml").read_text()
    assert "align: {slow.csv: 0.313" in text
    stated = tmp_path / "map.yaml"
    stated.write_text(text.replace("align: {slow.csv: 0.313", "align: {slow.csv: 0.213"))
    found = import_files(two_files, tmp_path / "out", stated)
    assert found.map.align["slow.csv"] == pytest.approx(0.2137, abs=1e-3)
    assert not any("moved against" in note for note in found.notes)


def test_files_without_anything_in_common_are_said(tmp_path):
    times, generator = np.arange(0, 5, 0.002), np.random.default_rng(1)
    files = [
        write_csv(tmp_path / f"{name}.csv", {"time": times, name: generator.standard_normal(len(times))})
        for name in ("floor_acceleration", "suspension_displacement")
    ]
    assert any("shares no channel" in note for note in import_files(files, tmp_path / "out").notes)


def test_runs_that_are_complete_stay_runs(noisy_table, tmp_path):
    files = [write_csv(tmp_path / f"{name}.csv", noisy_table) for name in ("first", "second")]
    assert import_files(files, tmp_path / "out").runs == ("first", "second")


def test_gaps_are_named_and_left_to_the_map(noisy_table, tmp_path):
    kept = np.ones(5001, dtype=bool)
    kept[2000:2010] = False
    path = write_csv(tmp_path / "a.csv", {name: values[kept] for name, values in noisy_table.items()})
    stated = tmp_path / "map.yaml"
    text = "time: {column: time, unit: s}\nchannels: {floor_acceleration: {column: floor_acceleration}}\n"
    stated.write_text(text)
    with pytest.raises(InputError, match=r"10 rows are missing, the first at 3\.998 s.*gaps: split"):
        import_files([path], tmp_path / "out", stated)
    assert not (tmp_path / "out").exists()
    stated.write_text(text + "gaps: split\n")
    assert import_files([path], tmp_path / "out", stated).runs == ("run-a-1", "run-a-2")


def test_a_slow_channel_in_a_fast_table_keeps_its_own_rate(noisy_table, tmp_path):
    temperature = np.full(5001, np.nan)
    temperature[::50] = 20.0 + np.sin(np.arange(101) / 20.0)
    path = write_csv(tmp_path / "a.csv", noisy_table, **{"Temperatur Dämpfer [°C]": temperature})
    import_files([path], tmp_path / "out")
    table = read_run(tmp_path / "out")
    expected = 20.0 + np.sin(table["time"] / 0.1 / 20.0)
    assert np.max(np.abs(table["damper_temperature"] - expected)) < 2e-3


def test_unevenly_spaced_rows_are_evened(tmp_path):
    generator = np.random.default_rng(2)
    times = np.cumsum(0.002 * (1.0 + 0.4 * generator.uniform(-1, 1, 8000)))
    path = write_csv(tmp_path / "a.csv", {"time": times, "floor_acceleration": sines(times)})
    found = import_files([path], tmp_path / "out")
    assert any(issue.kind == "uneven" for issue in found.doubts)
    table = read_run(tmp_path / "out")
    error = table["floor_acceleration"] - sines(times[0] + table["time"])
    assert np.max(np.abs(error[50:-50])) < 1e-3


LEVELS = (0.0, 0.3, 1.0)


def staircase(times, length=0.037):
    """A command that jumps among its levels."""
    return np.array(LEVELS)[np.random.default_rng(2).integers(0, 3, 10_000)[(times / length).astype(int)]]


def test_a_command_of_another_rate_has_no_level_that_nobody_commanded(tmp_path):
    rate = 300.0
    fast, slow = np.arange(0.0, 20.0, 0.002), np.arange(0.0, 20.0, 1 / rate)
    write_csv(tmp_path / "a.csv", {"time": fast, "floor_acceleration": band_limited(1, fast)})
    write_csv(tmp_path / "b.csv", {"time": slow, "current_command": staircase(slow)})
    found = import_files([tmp_path / "a.csv", tmp_path / "b.csv"], tmp_path / "out")
    table = read_run(tmp_path / "out")
    assert found.rate == 500.0 and set(table.current_command) == set(LEVELS)
    # Each jump is at most a row late.
    assert np.mean(table.current_command != staircase(np.arange(len(table)) / 500.0)) < 1.5 / (0.037 * rate)


@pytest.mark.parametrize("channel", ["floor_acceleration", "current_command"])
def test_of_rows_of_one_time_the_first_counts(channel):
    times = np.array([0.0, 0.1, 0.21, 0.21, 0.3, 0.41])
    values = np.array([0.0, 0.1, 0.21, 9.0, 0.3, 0.41])
    found = evened("floor_acceleration", values, times, np.array([0.05, 0.2, 0.35]))
    np.testing.assert_allclose(found, [0.05, 0.2, 0.35], atol=1e-12)
    assert evened(channel, values, times, np.array([0.0])) == 0.0
