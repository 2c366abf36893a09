"""Files are written whole or not at all; JSON holds plain values only."""

import json
import math
from typing import NamedTuple

import numpy as np
import pytest

from seatsim.schema.errors import InputError, OutputError, SeatsimError, nearest
from seatsim.schema.files import plain, write_json, write_text, write_whole


class Point(NamedTuple):
    x: float
    y: tuple[float, ...]


def test_values_become_plain():
    found = plain(
        {1: Point(math.inf, (1.5, math.nan)), "n": np.int64(3), "f": np.float64(0.25), "t": True, "none": None}
    )
    assert found == {"1": {"x": None, "y": [1.5, None]}, "n": 3, "f": 0.25, "t": True, "none": None}
    assert type(found["n"]) is int and type(found["f"]) is float and found["t"] is True


def test_json_is_written_with_missing_folders(tmp_path):
    path = write_json(tmp_path / "a" / "b.json", {"point": Point(1.0, (2.0,))})
    assert json.loads(path.read_text()) == {"point": {"x": 1.0, "y": [2.0]}}
    assert path.stat().st_mode & 0o777 == 0o644


def test_a_failed_write_leaves_the_old_file_and_nothing_else(tmp_path):
    path = write_text(tmp_path / "kept.txt", "before")

    def fail(part):
        part.write_text("half of it")
        raise OSError("disk full")

    with pytest.raises(OutputError, match=r"kept.txt: cannot be written: disk full; nothing of it is left"):
        write_whole(path, fail)
    assert path.read_text() == "before"
    assert list(tmp_path.iterdir()) == [path]


def test_a_folder_that_cannot_be_made_is_bad_input(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match=r"cannot be written: .*; give another --out"):
        write_text(tmp_path / "file" / "result.txt", "")


def test_the_nearest_name_is_proposed_where_one_is_near():
    assert nearest("fricton", ["friction", "end_stop"]) == " (did you mean 'friction'?)"
    assert nearest("xyz", ["friction", "end_stop"]) == ""
    assert (InputError.exit_status, SeatsimError.exit_status) == (2, 1)
