"""MAT files as many programs lay them out: channels, units, rates and times are those that stand there."""

import subprocess
import sys

import numpy as np
import pandas as pd
import pytest
from scipy.io import savemat

from seatsim.importing.readers.reading import read_file

from . import exports

TIME = 0.002 * np.arange(500)
FORCE, FLOOR = 100.0 * np.sin(9.0 * TIME), np.cos(7.0 * TIME)


def structures(**fields):
    """Return an array of structures, of lists of what each has."""
    held = np.empty(len(next(iter(fields.values()))), dtype=[(name, object) for name in fields])
    for name, values in fields.items():
        held[name] = values
    return held


def series(name, values, **others):
    """What an object of the class timeseries holds."""
    return {"Name": name, "Data_": values, "DataInfo": {"Units": "N"}, "Events": np.zeros((0, 0)), **others}


EVEN = {"TimeInfo": {"Units": "milliseconds", "Start_": 250.0, "Increment_": 2.0}, "Time_": np.zeros((0, 0))}
HEADERS = ({"SignalName": "force", "Unit": "N", "SampleFrequency": 500.0}, {"SignalName": "floor", "Unit": "m/s²"})
LAYOUTS = {
    "Simulink, structure with time": {
        "ScopeData": {"time": TIME[:, None], "blockName": "rig/Scope",
                      "signals": structures(values=[FORCE, FLOOR], label=["force", "floor"], dimensions=[1.0, 1.0])}},
    "Simulink, three dimensions": {
        "logged": {"time": TIME, "signals": {"values": np.stack([FORCE, FLOOR])[:, None, :], "label": "force"}}},
    "Simulink, Dataset": {
        "logsout": {"Elements_": np.array([{"Name": "force", "Values": series("", FORCE, Time_=TIME)},
                                           {"Name": "floor", "Values": series("", FLOOR, Time_=TIME)}], dtype=object)}},
    "timeseries": {"force": series("force", FORCE, Time_=TIME), "floor": series("floor", FLOOR, Time_=TIME)},
    "timeseries, even": {"force": series("force", FORCE, **EVEN)},
    "dSPACE": {
        "exp_001": {"X": {"Name": "", "Data": TIME[None, :]}, "Description": {"General": "a run"},
                    "Y": structures(Name=["force", "floor"], Data=[FORCE[None, :], FLOOR[None, :]], Unit=["N", "m/s^2"],
                                    XIndex=[1, 1])}},
    "dSPACE, two rates": {
        "exp_001": {"X": structures(Name=["a", "b"], Data=[TIME, 2.0 * TIME]),
                    "Y": structures(Name=["force", "floor"], Data=[FORCE, FLOOR], XIndex=[1, 2])}},
    "catman": {"Channel_1_Data": FORCE, "Channel_1_Header": HEADERS[0], "Channel_2_Data": FLOOR,
               "Channel_2_Header": HEADERS[1], "File_Header": {"SampleFrequency": 500.0}},
    "Dewesoft": {"Data1_force": FORCE, "Data1_time_force": TIME, "Data1_floor": FLOOR[::2],
                 "Data1_time_floor": TIME[::2], "Sample_rate": 500.0, "Start_time": "2026"},
    "imc": {"force": {"y": FORCE, "xdelta": 2.0, "x0": 250.0, "xunit": "ms", "yunit": "N"}},
    "Simulink, outputs": {"tout": TIME, "force": FORCE, "floor": FLOOR},
    "flat": {"force": FORCE, "force_unit": "N", "floor": FLOOR, "fs": 500.0},
    "cells": {"runs": np.array([{"name": "force", "data": FORCE, "dt": 0.002, "unit": "N"}], dtype=object)},
    "matrix": {"t": TIME, "data": np.column_stack([FORCE, FLOOR])},
    "x, y, z": {"x": FORCE, "y": FLOOR, "z": FLOOR, "fs": 500.0},
}  # fmt: skip
EXPECTED = {
    "Simulink, three dimensions": {"force#1", "force#2"},
    "timeseries, even": {"force"},
    "Dewesoft": {"Data1_force", "Data1_floor"},
    "imc": {"force"},
    "cells": {"force"},
    "matrix": {"data#1", "data#2"},
    "x, y, z": {"x", "y", "z"},
}
IN_NEWTON = ("timeseries, even", "dSPACE", "catman", "imc", "flat", "cells", "timeseries")


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
    first = next(name for name in ("force", "force#1", "Data1_force", "data#1", "x") if name in found)
    values, times, unit = found[first]
    start = 0.25 if layout in ("imc", "timeseries, even") else 0.0
    assert np.array_equal(values, FORCE) and times == pytest.approx(start + TIME, abs=1e-9)
    assert unit == ("N" if layout in IN_NEWTON else "") or layout == "Simulink, Dataset"
    if layout in ("Dewesoft", "dSPACE, two rates"):
        assert np.diff(found["Data1_floor" if layout == "Dewesoft" else "floor"][1])[0] == pytest.approx(0.004)
    assert not file.notes


@pytest.mark.parametrize("version", ["v7", "v7.3"])
def test_tables_and_timetables_of_matlab_are_groups(version, tmp_path):
    matio = pytest.importorskip("matio")
    timed = pd.DataFrame({"force": FORCE, "floor": FLOOR}, index=pd.to_timedelta(TIME, unit="s"))
    held = {"timed": timed, "table": pd.DataFrame({"t": TIME[::2], "force": FORCE[::2]}), "none": timed.head(0)}
    with pytest.warns(matio.utils.matclass.MatConvertWarning):
        matio.save_to_mat(str(tmp_path / "a.mat"), held, version=version)
    file = read_file(tmp_path / "a.mat")
    groups = {group.name: group for group in file.groups}
    assert set(groups) == {"timed", "table"}
    assert groups["timed"].find("time").values == pytest.approx(TIME)
    assert np.array_equal(groups["timed"].find("floor").values, FLOOR)
    assert np.array_equal(groups["table"].find("force").values, FORCE[::2])
    assert "none.force" in file.notes[0]


def test_pandas_keeps_texts_as_before_a_table_of_matlab_was_read(tmp_path):
    exports.mat_timetable(tmp_path / "table.mat", {"time": TIME, "force": FORCE})
    program = (
        "import sys, warnings; from pathlib import Path; import pandas as pd; warnings.simplefilter('ignore');"
        "from seatsim.importing.readers.reading import read_file; pd.set_option('future.infer_string', False);"
        "assert read_file(Path(sys.argv[1])).groups and 'matio' in sys.modules;"
        "assert not pd.get_option('future.infer_string')"
    )
    subprocess.run([sys.executable, "-c", program, str(tmp_path / "table.mat")], check=True)


@pytest.mark.parametrize("version", ["v7", "v7.3"])
def test_objects_of_classes_such_as_timeseries_are_channels(version, tmp_path):
    matio = pytest.importorskip("matio")

    def made(class_name, **properties):
        return matio.utils.matclass.MatlabOpaque(properties, class_name)

    info = made("tsdata.datametadata", Units="N")
    force, inner = (
        made("timeseries", Name=name, Data_=FORCE[:, None], Time_=TIME[:, None], DataInfo=info)
        for name in ("force", "")
    )
    logged = made("Simulink.SimulationData.Signal", Name="logged", Values=inner)
    matio.save_to_mat(str(tmp_path / "a.mat"), {"force": force, "signal": logged}, version=version)
    (group,) = read_file(tmp_path / "a.mat").groups
    assert [(signal.name, signal.unit) for signal in group.signals] == [("time", "s"), ("force", "N"), ("logged", "N")]
    assert group.signals[0].values == pytest.approx(TIME) and np.array_equal(group.signals[2].values, FORCE)


def test_what_is_no_column_of_real_numbers_is_named(tmp_path):
    held = {"force": FORCE, "spectrum": FORCE + 1j, "cube": np.zeros((3, 4, 5)), "gone": np.zeros((0, 0)), "fs": 500.0}
    savemat(tmp_path / "a.mat", {**held, "run": {"force": np.zeros((0, 1))}, "note": "a text"})
    (note,) = read_file(tmp_path / "a.mat").notes
    assert "spectrum" in note and "cube" in note and "run.force" in note and "note" not in note
