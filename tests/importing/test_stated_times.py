"""The time that a file states counts: starts of channels, columns of x, indices of dates, abscissas."""

import nptdms
import numpy as np
import pandas as pd
import pytest

from seatsim.importing.importing import import_files
from seatsim.importing.readers.reading import read_file
from seatsim.schema.errors import InputError

from ..text import beside, words
from .helpers import LET_LIBRARIES_WARN, read_run
from .test_alignment import band_limited

pytestmark = LET_LIBRARIES_WARN
TIME = 0.002 * np.arange(5000)
MORNING = np.datetime64("2026-03-01T09:51:40.500")


def tdms(path, starts):
    """Write a motion that every channel records from its own start on, in s."""
    channels = []
    for name, (start, stated) in starts.items():
        properties = {"unit_string": "m/s^2", "wf_increment": 0.002} | ({"wf_start_time": stated} if stated else {})
        channels.append(nptdms.ChannelObject("A", name, band_limited(1, start + TIME), properties))
    with nptdms.TdmsWriter(path) as writer:
        writer.write_segment(channels)


def after(seconds):
    return MORNING + np.timedelta64(round(1e6 * seconds), "us")


def test_channels_of_tdms_that_start_one_after_the_other_are_laid_on_one_clock(tmp_path):
    starts = {"floor_acceleration": (1.25, after(1.25)), "driver_acceleration": (0.0, after(0.0))}
    tdms(tmp_path / "a.tdms", starts)
    assert not import_files([tmp_path / "a.tdms"], tmp_path / "out").map.align
    table = read_run(tmp_path / "out")
    assert len(table) == pytest.approx(5000 - 625, abs=1)
    assert np.max(np.abs(table["floor_acceleration"] - table["driver_acceleration"])) < 1e-9


def test_a_start_that_is_missing_or_was_never_set_is_said(tmp_path):
    epoch = np.datetime64("1904-01-01T00:00:00.000000")
    tdms(tmp_path / "a.tdms", {"one": (0.0, after(0.0)), "two": (0.0, None), "three": (0.0, epoch)})
    file = read_file(tmp_path / "a.tdms")
    assert "no wf_start_time is stated of two, three" in file.notes[0]
    assert all(not group.start for group in file.groups)
    tdms(tmp_path / "b.tdms", {"one": (0.0, None), "two": (0.0, None)})
    assert not read_file(tmp_path / "b.tdms").notes


@pytest.mark.parametrize("step", [0.0, -0.002, 1e-310, np.nan, 1e300])
def test_a_rate_that_no_logger_has_is_refused(tmp_path, step):
    with nptdms.TdmsWriter(tmp_path / "a.tdms") as writer:
        writer.write_segment([nptdms.ChannelObject("A", "force", TIME, {"wf_increment": step})])
    if step:
        with pytest.raises(InputError, match="states a sample rate of"):
            read_file(tmp_path / "a.tdms")
    else:
        assert read_file(tmp_path / "a.tdms").groups[0].rate is None


@pytest.mark.parametrize(
    ("kind", "index"),
    [("parquet", "dates"), ("feather", "dates"), *(("parquet", each) for each in words("durations named zone column"))],
)
def test_a_column_of_dates_is_the_time(tmp_path, kind, index):
    times = pd.to_timedelta(TIME[:1000], unit="s")
    dates = pd.Timestamp("2026-03-01") + times
    floor, driver = (band_limited(seed, TIME[:1000]) for seed in (1, 2))
    frame = pd.DataFrame({"floor_acceleration": floor, "driver_acceleration": driver})
    several = {"durations": times, "named": dates.rename("Datum"), "zone": dates.tz_localize("Europe/Berlin")}
    frame.index = several.get(index, dates)
    frame = frame.reset_index(names="Datum") if index == "column" else frame
    getattr(frame, f"to_{kind}")(tmp_path / f"a.{kind}")
    assert import_files([tmp_path / f"a.{kind}"], tmp_path / "out").rate == 500.0
    assert read_run(tmp_path / "out")["floor_acceleration"].to_numpy() == pytest.approx(floor, rel=1e-6)


HEAD = beside(__file__, "data_set_58.txt")


def uff(path, values, points=None, kind=1, even=1, axis=17, label="Time", unit="s"):
    """Write a data set of 58 with full lines of six values."""
    filled = np.append(values, np.zeros(-len(values) % 6)).reshape(-1, 6)
    head = HEAD.format(kind=kind, points=points or len(values), even=even, axis=axis, label=label, unit=unit)
    rows = "".join("".join(f"{value:13.5E}" for value in row) + "\n" for row in filled)
    path.write_text(head + rows + "    -1\n")


@pytest.mark.parametrize("count", [500, 501, 505])
def test_the_zeros_that_fill_the_last_line_of_a_data_set_are_no_values(tmp_path, count):
    values = 1.0 + np.sin(np.arange(count))
    uff(tmp_path / "a.uff", values)
    (group,) = read_file(tmp_path / "a.uff").groups
    assert group.signals[0].values == pytest.approx(values, abs=1e-4) and group.rate == 250.0
    assert (group.signals[0].name, group.signals[0].unit) == ("Fahrer", "m/s^2")


def test_an_uneven_abscissa_of_a_data_set_is_its_time(tmp_path):
    times = np.cumsum(np.where(np.arange(60) % 3, 0.01, 0.02))
    uff(tmp_path / "a.uff", np.column_stack([1e3 * times, np.sin(times)]).ravel(), points=60, even=0, unit="ms")
    (group,) = read_file(tmp_path / "a.uff").groups
    assert group.signals[0].values == pytest.approx(times, abs=1e-4) and group.signals[0].unit == "s"
    assert group.signals[1].values == pytest.approx(np.sin(times), abs=1e-4)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"kind": 2}, "data set 1 is a function of type 2, such as a spectrum"),
        ({"kind": 0, "axis": 18, "label": "Frequency", "unit": "Hz"}, "data set 1 is a function over Frequency"),
        ({"points": 490}, "has 498 values where it states 490"),
        ({"points": 600}, "has 498 of 600 values; the file is truncated"),
    ],
)
def test_a_data_set_that_is_no_response_over_time_is_called_what_it_is(tmp_path, changes, said):
    uff(tmp_path / "a.uff", np.sin(np.arange(498.0)), **changes)
    with pytest.raises(InputError, match=said):
        read_file(tmp_path / "a.uff")
