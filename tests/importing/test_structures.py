"""Files whose channels stand in groups, structures or matrices, with units and rates beside them."""

import struct

import asammdf
import h5py
import numpy as np
import pandas as pd
import pytest
from scipy.io import loadmat, savemat

from seatsim.importing.importing import import_files
from seatsim.importing.readers.matlab import read_values
from seatsim.importing.readers.reading import TextLayout, read_file
from seatsim.schema.errors import InputError

from .helpers import LET_LIBRARIES_WARN, read_run
from .test_alignment import band_limited

pytestmark = LET_LIBRARIES_WARN
FAST, SLOW = np.arange(0.0, 20.0, 0.002), np.arange(0.0, 20.0, 0.01)


def found_in(file):
    return {(group.name, signal.name): (signal.unit, group.rate) for group in file.groups for signal in group.signals}


def test_a_matrix_of_hdf5_has_names_and_units_in_attributes(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        matrix = file.create_dataset("run/data", data=np.column_stack([FAST, band_limited(1, FAST)]))
        matrix.attrs["columns"] = ["time", "acc floor"]
        matrix.attrs["units"] = ["s", "m/s^2"]
        file["table"] = np.array(list(zip(SLOW, SLOW, strict=True)), dtype=[("t", "f8"), ("x", "f4")])
    found = found_in(read_file(tmp_path / "a.h5"))
    assert found["run", "time"] == ("s", None)
    assert found["run", "acc floor"] == ("m/s^2", None)
    assert any(name == "x" for _, name in found)


def test_groups_of_other_rates_and_starts_share_the_clock_of_their_file(tmp_path):
    slow = SLOW[:1500] + 0.25
    with asammdf.MDF(version="4.10") as file:
        floor = asammdf.Signal(band_limited(1, FAST), FAST, name="floor_acceleration", unit="m/s^2")
        file.append([floor, asammdf.Signal(band_limited(2, FAST), FAST, name="current_command", unit="A")])
        travel = asammdf.Signal(1e3 * band_limited(3, slow), slow, name="Federweg", unit="mm")
        file.append([travel, asammdf.Signal(band_limited(2, slow - 0.02), slow, name="coil_current", unit="A")])
        file.save(tmp_path / "a.mf4")
    found = import_files([tmp_path / "a.mf4"], tmp_path / "out")
    assert found.rate == 500.0
    assert found.map.align == {}
    table = read_run(tmp_path / "out")
    expected = band_limited(3, 0.25 + table["time"])
    inner = slice(400, -400)
    assert np.std((table["suspension_displacement"] - expected)[inner]) < 0.01 * np.std(expected)
    lagging = band_limited(2, 0.25 + table["time"] - 0.02)
    assert np.std((table["coil_current"] - lagging)[inner]) < 0.01 * np.std(lagging)


def test_every_sheet_of_a_workbook_with_numbers_is_a_group(tmp_path):
    frame = pd.DataFrame({"time": FAST[:500], "floor_acceleration": band_limited(1, FAST[:500])})
    with pd.ExcelWriter(tmp_path / "a.xlsx") as book:
        pd.DataFrame({"remark": ["a", "b"]}).to_excel(book, sheet_name="notes", index=False)
        frame.to_excel(book, sheet_name="run 1", index=False, startrow=3)
    file = read_file(tmp_path / "a.xlsx")
    assert [group.name for group in file.groups] == ["run 1"]
    assert file.groups[0].rows == 500
    assert [signal.name for signal in file.groups[0].signals] == ["time", "floor_acceleration"]
    with pytest.raises(InputError, match=r"sheet run 1: has .* lines; csv\.header 999"):
        read_file(tmp_path / "a.xlsx", TextLayout(header=999))


def test_cells_of_a_sheet_may_be_dates_and_texts_of_several_lines(tmp_path):
    moments = pd.Timestamp("2026-03-01 09:51:40") + pd.to_timedelta(FAST[:500], unit="s")
    sheet = {"Zeit": moments, "a_Sitz\n[g]": FAST[:500], "remark": "two\nlines"}
    pd.DataFrame(sheet).to_excel(tmp_path / "a.xlsx", index=False)
    file = read_file(tmp_path / "a.xlsx")
    time, seat = file.groups[0].signals
    assert (time.unit, seat.name, seat.unit) == ("s", "a_Sitz", "g")
    np.testing.assert_allclose(time.values, FAST[:500], atol=1e-6)
    np.testing.assert_allclose(seat.values, FAST[:500], atol=1e-9)
    assert file.notes == ("sheet Sheet1: columns that hold no numbers: remark",)


def test_units_stand_in_the_metadata_of_parquet(tmp_path):
    import pyarrow as pa
    import pyarrow.parquet as pq

    time, floor = pa.field("t", pa.float64(), metadata={"unit": "ms"}), pa.field("acc floor", pa.float32())
    schema = pa.schema([time, floor.with_metadata({"unit": "g"})])
    table = pa.table([1e3 * FAST, band_limited(1, FAST).astype("f4")], schema=schema)
    pq.write_table(table, tmp_path / "a.parquet")
    assert found_in(read_file(tmp_path / "a.parquet")) == {("", "t"): ("ms", None), ("", "acc floor"): ("g", None)}
    assert import_files([tmp_path / "a.parquet"], tmp_path / "out").rate == 500.0


@pytest.mark.parametrize("packed", [False, True])
def test_variables_of_mat_files_are_those_that_scipy_reads(tmp_path, packed):
    inner = {"x": np.eye(2), "unit": "m/s²", "deeper": {"y": np.arange(3.0)}}
    stored = {"matrix": np.arange(6.0).reshape(2, 3), "short": np.arange(5, dtype=np.int16), "text": "hällo"}
    stored |= {"on": np.array([True, False]), "empty": np.zeros((0, 3)), "inner": inner}
    stored |= {"cells": np.array(["a", 1.0], dtype=object), "complex": np.array([1 + 2j])}
    savemat(tmp_path / "a.mat", stored, do_compression=packed)
    found = read_values(tmp_path / "a.mat", (tmp_path / "a.mat").read_bytes())
    expected = loadmat(tmp_path / "a.mat")
    for name in ("matrix", "short", "on", "empty"):
        assert np.array_equal(found[name], expected[name])
    assert found["text"] == "hällo" and found["inner"]["unit"] == "m/s²"
    assert np.array_equal(found["inner"]["x"], np.eye(2)) and found["inner"]["deeper"]["y"].tolist() == [[0, 1, 2]]
    assert found["cells"] == ["a", 1.0] and found["complex"] is None


def test_a_channel_beyond_its_rows_and_rows_beyond_the_file_are_refused(tmp_path):
    signals = [asammdf.Signal(band_limited(k, FAST), FAST, name=f"channel {k}") for k in range(3)]
    with asammdf.MDF(version="4.10") as file:
        file.append(signals, common_timebase=True)
        file.save(tmp_path / "a.mf4")
    content = (tmp_path / "a.mf4").read_bytes()
    # Rows of four numbers of 64 bits: where the last one begins, and how many rows there are.
    begins, far = struct.pack("<II", 24, 64), struct.pack("<II", 2**31, 64)
    rows, many = struct.pack("<Q", len(FAST)), struct.pack("<Q", 2**40)
    for old, new, said in ((begins, far, "lies beyond the end of its rows"), (rows, many, "of memory; permitted")):
        assert old in content
        (tmp_path / "a.mf4").write_bytes(content.replace(old, new))
        with pytest.raises(InputError, match=said):
            read_file(tmp_path / "a.mf4")
