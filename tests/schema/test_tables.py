"""Tables within limits: rows of equal length, regular files, and nothing unpacked that is too large."""

import gzip
import os
from pathlib import Path

import numpy as np
import pytest

from seatsim.excitations.motion import samples
from seatsim.schema import bounds
from seatsim.schema.errors import InputError
from seatsim.schema.guarded import read_bytes, read_json
from seatsim.schema.tables import numbers, read_table

TEXT = b"time,force\n0,1.5\n0.1,-2e3\n"


@pytest.mark.parametrize("pack", [bytes, gzip.compress])
def test_a_table_is_read_plain_and_packed(tmp_path, pack):
    path = tmp_path / "a.csv"
    path.write_bytes(pack(b"\xef\xbb\xbf" + TEXT))
    frame = read_table(path)
    assert list(frame) == ["time", "force"]
    assert numbers(frame, "force")[0].tolist() == [1.5, -2000.0]


def test_numbers_are_read_to_the_last_bit(tmp_path):
    values = np.random.default_rng(1).standard_normal(2000) * 10.0 ** np.arange(-20, 20).repeat(50)
    (tmp_path / "a.csv").write_text("a\n" + "\n".join(map(repr, values.tolist())) + "\n")
    assert numbers(read_table(tmp_path / "a.csv"), "a")[0].tobytes() == values.tobytes()


def test_what_is_no_finite_number_is_told_by_its_row(tmp_path):
    (tmp_path / "a.csv").write_bytes(b"a,b\n1,\n,x\ninf,3\n1_0,\xc3\xbf\n")
    frame = read_table(tmp_path / "a.csv")
    assert numbers(frame, "a")[1].tolist() == [1, 2, 3]
    assert numbers(frame, "b")[1].tolist() == [0, 1, 3]


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        (b"a,b\n1,2\n1,2,3\n", "line 3: has 3 columns where the others have 2"),
        (b"a,b\n1,2\n1\n1,2,3\n", r"line 3: has 1 columns where the others have 2 \(and 1 more lines\)"),
        (b"a,b\n1,2,\n", "line 2: has 3 columns"),
        (b'a,b\n1,"\n2,3\n4,"\n5,6\n', "line 2: a quotation mark is not closed in its line"),
        (b"a,a\n1,2\n", "line 1: column 'a' stands twice"),
        (b"", "the file is empty"),
        (b"a,b\n1,\xff\n", "line 2: cannot be read as a table: is not UTF-8 text"),
        (b"\xff\xfea\0,\0b\0\n\0", "cannot be read as a table"),
        (b"x" * 2**21, "first line does not end"),
        (b",".join([b"a"] * 5000) + b"\n", "5000 columns"),
        (gzip.compress(TEXT, mtime=0)[:-9], "cannot be unpacked"),
        (b"\x1f\x8b junk", "cannot be unpacked"),
    ],
)
def test_a_damaged_table_is_one_error(tmp_path, content, problem):
    (tmp_path / "a.csv").write_bytes(content)
    with pytest.raises(InputError, match=problem):
        read_table(tmp_path / "a.csv")


def test_a_table_packed_otherwise_is_refused(tmp_path):
    (tmp_path / "a.csv.xz").write_bytes(b"\xfd7zXZ")
    with pytest.raises(InputError, match="packed otherwise than by gzip; unpack it"):
        read_table(tmp_path / "a.csv.xz")


def test_no_more_is_unpacked_than_is_permitted(tmp_path):
    (tmp_path / "a.csv.gz").write_bytes(gzip.compress(bytes(2**25)))
    with pytest.raises(InputError, match=r"what it unpacks to would take at least 17 MiB.*permitted.*are 16 MiB"):
        read_table(tmp_path / "a.csv.gz")


def test_memory_is_foreseen(tmp_path, monkeypatch):
    monkeypatch.setattr(bounds, "find_available", lambda: 1000)
    (tmp_path / "a.csv").write_bytes(TEXT * 100)
    with pytest.raises(InputError, match=r"rows need .* of memory, where .* are free; split the table"):
        read_table(tmp_path / "a.csv")
    with pytest.raises(InputError, match="60 000 000 000 steps need"):
        samples(60.0, 1e-9)


def test_only_regular_files_are_read(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path / "pipe", tmp_path, Path("/dev/zero")):
        with pytest.raises(InputError, match=r"no regular file|Is a directory"):
            read_table(path)
    for path in (tmp_path / "absent", tmp_path / ("long" * 100), Path("null\0byte")):
        with pytest.raises(InputError, match=r"cannot be read|is no path"):
            read_table(path)
    (tmp_path / "large").write_bytes(bytes(2**21))
    with pytest.raises(InputError, match="holds 2 MiB; permitted: at most 1 MiB"):
        read_bytes(tmp_path / "large", 2**20, "a table")


@pytest.mark.parametrize("text", ["[" * 100_000, "{", "9" * 5000, "", "\xff"])
def test_json_that_is_none_is_one_error(tmp_path, text):
    (tmp_path / "a.json").write_bytes(text.encode("latin-1"))
    with pytest.raises(InputError, match="is no diagnosis"):
        read_json(tmp_path / "a.json", "diagnosis")
