"""MAT files as many programs lay them out: channels, units, rates and times are those that stand there."""

import h5py
import numpy as np
import pytest
from scipy.io import savemat

from seatsim.importing.readers.reading import read_file

TIME = 0.002 * np.arange(500)
FORCE, FLOOR = 100.0 * np.sin(9.0 * TIME), np.cos(7.0 * TIME)


def structures(**fields):
    """Return an array of structures, of lists of what each has."""
    held = np.empty(len(next(iter(fields.values()))), dtype=[(name, object) for name in fields])
    for name, values in fields.items():
        held[name] = values
    return held


HEADERS = ({"SignalName": "force", "Unit": "N", "SampleFrequency": 500.0}, {"SignalName": "floor", "Unit": "m/s²"})
LAYOUTS = {
    "Simulink, structure with time": {
        "ScopeData": {"time": TIME[:, None], "blockName": "rig/Scope",
                      "signals": structures(values=[FORCE, FLOOR], label=["force", "floor"], dimensions=[1.0, 1.0])}},
    "Simulink, three dimensions": {
        "logged": {"time": TIME, "signals": {"values": np.stack([FORCE, FLOOR])[:, None, :], "label": "force"}}},
    "dSPACE": {
        "exp_001": {"X": {"Name": "", "Data": TIME[None, :]}, "Description": {"General": "a run"},
                    "Y": structures(Name=["force", "floor"], Data=[FORCE[None, :], FLOOR[None, :]], Unit=["N", "m/s^2"],
                                    XIndex=[1, 1])}},
    "catman": {"Channel_1_Data": FORCE, "Channel_1_Header": HEADERS[0], "Channel_2_Data": FLOOR,
               "Channel_2_Header": HEADERS[1], "File_Header": {"SampleFrequency": 500.0}},
    "imc": {"force": {"y": FORCE, "xdelta": 2.0, "x0": 250.0, "xunit": "ms", "yunit": "N"}},
    "Simulink, outputs": {"tout": TIME, "force": FORCE, "floor": FLOOR},
    "flat": {"force": FORCE, "force_unit": "N", "floor": FLOOR, "fs": 500.0},
    "cells": {"runs": np.array([{"name": "force", "data": FORCE, "dt": 0.002, "unit": "N"}], dtype=object)},
    "matrix": {"t": TIME, "data": np.column_stack([FORCE, FLOOR])},
    "x, y, z": {"x": FORCE, "y": FLOOR, "z": FLOOR, "fs": 500.0},
}  # fmt: skip
EXPECTED = {"Simulink, three dimensions": {"force#1", "force#2"}, "matrix": {"data#1", "data#2"}}
EXPECTED |= {"imc": {"force"}, "cells": {"force"}, "x, y, z": {"x", "y", "z"}}
IN_NEWTON = ("dSPACE", "catman", "imc", "flat", "cells")


def clocked(file):
    """Return values, times in s and unit of every channel."""
    found = {}
    for group in file.groups:
        time = next((each.values for each in group.signals if each.name in ("time", "t")), None)
        for signal in group.signals:
            even = (group.start or 0.0) + np.arange(group.rows) / group.rate if group.rate else None
            if signal.name not in ("time", "t"):
                found[signal.name] = (signal.values, time if time is not None else even, signal.unit)
    return found


@pytest.mark.parametrize("layout", LAYOUTS)
def test_channels_have_the_times_and_units_that_stand_beside_them(layout, tmp_path):
    savemat(tmp_path / "a.mat", LAYOUTS[layout])
    file = read_file(tmp_path / "a.mat")
    found = clocked(file)
    assert set(found) == EXPECTED.get(layout, {"force", "floor"})
    first = next(name for name in ("force", "force#1", "data#1", "x") if name in found)
    values, times, unit = found[first]
    start = 0.25 if layout == "imc" else 0.0
    assert np.array_equal(values, FORCE) and times == pytest.approx(start + TIME, abs=1e-9)
    assert unit == ("N" if layout in IN_NEWTON else "")
    assert not file.notes


def test_structures_cells_and_texts_of_version_7_3_are_those_of_version_5(tmp_path):
    path = tmp_path / "a.mat"
    with h5py.File(path, "w", userblock_size=512) as file:

        def put(place, values, kind):
            file.create_dataset(place, data=values).attrs["MATLAB_class"] = np.bytes_(kind)
            return file[place].ref

        def put_text(place, text):
            return put(place, np.array([[ord(letter)] for letter in text], np.uint16), "char")

        put("one/data", FORCE[None, :], "double")
        put_text("one/unit", "N")
        file["one"].attrs["MATLAB_class"] = np.bytes_("struct")
        put("one/time", TIME[None, :], "double")
        names = [put_text(f"#refs#/{name}", name) for name in ("first", "second")]
        values = [put(f"#refs#/{k}", k * FLOOR[None, :], "double") for k in (1, 2)]
        file["several/name"], file["several/data"] = (np.array([[a], [b]], h5py.ref_dtype) for a, b in (names, values))
        file["several"].attrs["MATLAB_class"] = np.bytes_("struct")
        put("table", np.zeros((6, 1), np.uint32), "table")
        file["table"].attrs["MATLAB_object_decode"] = 3
    path.write_bytes(b"MATLAB 7.3 MAT-file".ljust(124) + b"\0\2IM" + path.read_bytes()[128:])
    file = read_file(path)
    found = {signal.name: signal for group in file.groups for signal in group.signals}
    assert found["one"].unit == "N" and np.array_equal(found["one"].values, FORCE)
    assert np.array_equal(found["second"].values, 2.0 * FLOOR) and set(found) == {"time", "one", "first", "second"}
    assert "parquetwrite): table" in file.notes[0]


def test_what_is_no_column_of_real_numbers_is_named(tmp_path):
    held = {"force": FORCE, "spectrum": FORCE + 1j, "cube": np.zeros((3, 4, 5)), "gone": np.zeros((0, 0)), "fs": 500.0}
    savemat(tmp_path / "a.mat", {**held, "run": {"force": np.zeros((0, 1))}, "note": "a text"})
    (note,) = read_file(tmp_path / "a.mat").notes
    assert "spectrum" in note and "cube" in note and "run.force" in note and "note" not in note
