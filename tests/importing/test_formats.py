"""The same recording in every format becomes the same numbers, and a damaged file one clear error."""

import shutil
import sys

import numpy as np
import pytest

from seatsim.importing.importing import import_files
from seatsim.importing.inspection import inspect_file
from seatsim.importing.readers.reading import read_file
from seatsim.schema.errors import InputError

from . import exports
from .helpers import LET_LIBRARIES_WARN, read_run

pytestmark = LET_LIBRARIES_WARN


@pytest.fixture(scope="module")
def table(seat_table):
    """The beginning of the recorded seat."""
    return {name: values[:1501] for name, values in seat_table.items()}


@pytest.fixture(params=exports.FORMATS, scope="module")
def exported(request, tmp_path_factory, table):
    path = tmp_path_factory.mktemp("formats") / request.param
    exports.FORMATS[request.param](path, table)
    return path


def test_every_format_gives_the_same_numbers_whatever_the_file_is_called(exported, tmp_path, table):
    found = import_files([shutil.copy(exported, tmp_path / "data.bin")], tmp_path / "out")
    assert found.rate == 500.0
    assert set(found.map.channels) == set(exports.UNITS)
    got = read_run(tmp_path / "out")
    assert len(got) == len(table["time"])
    for name in exports.UNITS:
        assert np.max(np.abs(got[name] - table[name])) <= 1e-6 * np.std(table[name]), name


def test_a_truncated_file_is_one_clear_error(exported, tmp_path):
    content = exported.read_bytes()
    cut = tmp_path / exported.name
    # A reader has all of the header and lacks some of the numbers; a text is cut in the middle of a line.
    end = int(0.9 * len(content))
    separator = {"a.csv": b",", "german.csv": b";", "a.lvm": b"\t"}.get(exported.name)
    if separator:
        end = content.rindex(separator, 0, end)
    cut.write_bytes(content[:end])
    with pytest.raises(InputError, match="truncated") as raised:
        read_file(cut)
    assert str(cut) in str(raised.value)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("name", "content", "expected"),
    [
        ("a.pdf", b"%PDF-1.7 and more" + bytes(9), "no table in a known format; permitted: Parquet"),
        ("a.xls", b"\xd0\xcf\x11\xe0" + b"\1" * 600, "save it as .xlsx"),
        ("a.mat", b"time,force\n1,2\n", "does not begin as MAT v5 does"),
        ("a.csv", b"\x00\x01\x02\x03" * 50, "no table in a known format"),
        ("a.csv", b"a letter to nobody\nwith two lines\n", "no row of numbers"),
        ("a.csv", b"a,b\n", "no row of numbers"),
        ("a.h5", b"", "is empty"),
        ("a.mdf", b"MDF     3.30    TGT 15.0" + bytes(64), "is MDF of version 3.30; save it as version 4"),
    ],
)
def test_a_file_of_another_kind_is_one_clear_error(tmp_path, name, content, expected):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(InputError, match=expected):
        read_file(path)


def test_acquisitions_below_each_other_are_one_table(tmp_path):
    """As a testing machine writes them: headings that differ, then names and units again."""
    names = "Time\tAxial Displacement\tAxial Force\nSec\tmm\tkN\n"
    heading = "Data Acquisition: Timed {0}\tStation: A\tTime: {0}.5 Sec\n\n"
    rows = [[f"{0.1 * (5 * block + k):.1f}\t{k}\t-{k}.5\n" for k in range(5)] for block in range(3)]
    path = tmp_path / "machine.dat"
    text = "".join(heading.format(block) + names + "".join(part) + "\n" for block, part in enumerate(rows))
    path.write_text(f"MTS793|MPT|ENU|1|2|.|/|:|1|0|0|A\n{text}")
    file = read_file(path)
    [group] = file.groups
    np.testing.assert_allclose(group.signals[0].values, 0.1 * np.arange(15))
    np.testing.assert_allclose(group.signals[2].values, [-0.5, -1.5, -2.5, -3.5, -4.5] * 3)
    assert [signal.unit for signal in group.signals[1:]] == ["mm", "kN"]
    assert any("names again" in note for note in file.notes)


def test_a_missing_library_is_one_sentence_with_the_command(tmp_path, monkeypatch):
    path = tmp_path / "a.tdms"
    path.write_bytes(b"TDSm" + b"\0" * 60)
    monkeypatch.setitem(sys.modules, "nptdms", None)
    with pytest.raises(InputError, match=r'pip install "seatsim\[formats\]"'):
        read_file(path)


@pytest.mark.parametrize("number", ["inf", "-1e300"])
def test_numbers_beyond_all_measurements_are_rows_without_a_number(tmp_path, number):
    rows = "".join(f"{0.002 * row},{number if row == 40 else row % 7}\n" for row in range(1000))
    (tmp_path / "a.csv").write_text("time,force [N]\n" + rows)
    (group,) = read_file(tmp_path / "a.csv").groups
    values = group.signals[-1].values
    assert np.isnan(values[40]) and np.isfinite(np.delete(values, 40)).all()
    assert inspect_file(tmp_path / "a.csv")
