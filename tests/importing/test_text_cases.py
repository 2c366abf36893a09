"""Text tables of many writers: each is read right, or refused with one true sentence."""

import re

import numpy as np
import pytest

from seatsim.importing.importing import import_files
from seatsim.importing.readers.reading import read_file
from seatsim.importing.signals import find_clock
from seatsim.schema.errors import InputError
from seatsim.standards.comfort import comfort

from .helpers import read_run
from .text_tables import PLAIN, RATE, READ, REFUSED, ROWS, TRAVEL, T, X, Y, Z, table


def write(folder, content):
    path = folder / "a.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


@pytest.mark.parametrize("name", READ)
def test_a_table_is_read_right(tmp_path, name):
    content, columns, rate = READ[name]
    path = write(tmp_path, content)
    groups = read_file(path).groups
    found = {signal.name: signal for group in groups for signal in group.signals}
    for column, (unit, values) in (columns or {}).items():
        assert found[column].unit == unit
        np.testing.assert_allclose(found[column].values, values, rtol=1e-6, atol=1e-9)
    axes = [(group, clock.axis if (clock := find_clock(group)) else None) for group in groups]
    rates = [axis.rate if axis else group.rate for group, axis in axes]
    if rate is None:
        assert rates == [None]
    else:
        assert rates == pytest.approx(rate if isinstance(rate, list) else [rate], rel=1e-3)


@pytest.mark.parametrize("name", REFUSED)
def test_a_file_is_refused_for_its_true_reason(tmp_path, name):
    content, sentence = REFUSED[name]
    with pytest.raises(InputError, match=sentence):
        read_file(write(tmp_path, content))


@pytest.mark.parametrize(
    ("content", "rate", "expected"),
    [
        (READ["savetxt"][0], RATE, {"x": X, "y": Y, "z": Z}),
        (READ["label among names"][0], None, {"x": X, "y": Y, "z": Z}),
        (table(T, X, Y, Z, head=["t [s];Sitz x [m/s^2];Sitz y [m/s^2];Sitz z [m/s^2]"], sep=";"), None,
         {"x": X, "y": Y, "z": Z}),
        (table(T, TRAVEL, X, Y, Z, head=["t,x [mm],acc_x,acc_y,acc_z"]), None, {"x": X, "y": Y, "z": Z}),
        (table(T, X, Y, Z, X, Y, Z, head=["t,Seat X,Seat Y,Seat Z,Floor X,Floor Y,Floor Z"]).replace(" X", " Ax")
         .replace(" Y", " Ay").replace(" Z", " Az"), None, {"x": X, "y": Y, "z": Z}),
    ],
)  # fmt: skip
def test_comfort_takes_each_axis_from_its_column(tmp_path, content, rate, expected):
    found = comfort(write(tmp_path, content), rate=rate)
    plain = comfort(write(tmp_path, table(*expected.values(), head=[",".join(expected)])), rate=RATE)
    rms, of_plain = ({axis: each.dose.rms for axis, each in some.axes.items()} for some in (found, plain))
    assert rms == pytest.approx(of_plain, rel=1e-6)


SPECTRUM = table(T * RATE / 2, np.abs(Z), head=["Frequency [Hz],acc_z [m/s^2]"])


@pytest.mark.parametrize(
    ("content", "rate", "sentence"),
    [
        (SPECTRUM, None, "over 'Frequency', not over time: it is a spectrum"),
        (SPECTRUM, 500.0, "it is a spectrum"),
        (READ["a count is no time"][0], None, "no column holds the time"),
        (table(1e3 * T, Z, head=["time,acc_z"]), None, "'time' has no unit, and its rows are 4 apart; give --rate"),
        (table(T + 0.27 * (T > 1), Z, head=["t,acc_z"]), None, "67 rows are missing, the first at 1 s"),
        (table(T, X, 2 * T, Y, head=["t1,x,t2,y"]), None, "y of 't2' has another time than x of 't1'"),
        (table(T, X, Z, Z, head=["t,acc_x,Sitz z [g],Fahrer z [g]"]), None, "Sitz z and Fahrer z may be axis z"),
    ],
)
def test_comfort_is_refused_for_the_true_reason(tmp_path, content, rate, sentence):
    with pytest.raises(InputError, match=sentence):
        comfort(write(tmp_path, content), rate=rate)


@pytest.mark.parametrize(
    ("content", "rate", "sentence"),
    [
        (table(X, T, Z, 2 * T, head=["acc_x,t1,acc_z,t2"]), None, "t1: is taken for the time of all columns; t2 has"),
        (READ["whole seconds"][0], None, "the rate is estimated as 250 Hz: state it .* by --rate"),
        (READ["first column without a name"][0], None, "column 1: no column is called time; this one rises evenly"),
        (table(T, X, 2 * T, Z, head=["t1,a_Boden,t2,a_Sitz"]), 250.0, "'t2' is evaluated alone"),
        (table(T, 2000.0 * Z, head=["t,acc_z"]), None, "acc_z: reaches .* more than a seat does"),
        (PLAIN, 500.0, "the file states 250 Hz; the stated 500 Hz is taken"),
        (table(T + 0.27 * (T > 1), Z, head=["t,acc_z"]), 250.0, "67 rows are missing"),
        (table(T, ["-"] * ROWS, Z, head=["t,acc_x,acc_z"]), None, "columns that hold no numbers: acc_x"),
    ],
)
def test_comfort_says_what_it_assumes_of_a_file(tmp_path, content, rate, sentence):
    notes = comfort(write(tmp_path, content), rate=rate).notes
    assert any(re.search(sentence, note) for note in notes), notes


def test_columns_with_times_of_their_own_are_put_on_one(tmp_path):
    floor, travel = np.sin(4.0 * np.pi * T), np.sin(4.0 * np.pi * 2.0 * T)
    path = write(tmp_path, table(T, floor, 2.0 * T, travel, head=["t1;a_Boden [g];t2;Federweg [mm]"], sep=";", dec=","))
    found = import_files([path], tmp_path / "out")
    assert found.rate == RATE and not any("t2" in note for note in found.notes)
    got = read_run(tmp_path / "out")
    np.testing.assert_allclose(1e3 * got["suspension_displacement"], np.sin(4.0 * np.pi * got["time"]), atol=0.01)


def test_cells_without_a_value_are_missing_and_texts_are_named(tmp_path):
    gone = ["NaN" if row == 3 else f"{row}" for row in range(ROWS)]
    file = read_file(write(tmp_path, table(T, gone, ["run"] * ROWS, head=["time,force,state"])))
    assert np.isnan(file.groups[0].signals[1].values).sum() == 1
    assert file.notes == ("columns that hold no numbers: state",)
