"""Files are written whole or not at all; JSON holds plain values only."""

import math
import os
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from seatsim.schema.errors import InputError, OutputError, SeatsimError
from seatsim.schema.files import check_folder, plain, write_text, write_together, write_whole


class Point(NamedTuple):
    x: float
    y: tuple[float, ...]


def test_values_become_plain():
    numbers = {1: Point(math.inf, (1.5, math.nan)), "n": np.int64(3), "f": np.float64(0.25)}
    found = plain(numbers | {"t": True, "none": None})
    assert found == {"1": {"x": None, "y": [1.5, None]}, "n": 3, "f": 0.25, "t": True, "none": None}
    assert type(found["n"]) is int and type(found["f"]) is float and found["t"] is True


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


@pytest.mark.parametrize("mask", [0o022, 0o077])
def test_files_have_the_mode_that_the_umask_leaves(tmp_path, mask):
    before = os.umask(mask)
    try:
        write_text(tmp_path / "a.txt", "")
        write_together(tmp_path / "set", lambda part: [write_text(part / "b.txt", "")])
    finally:
        os.umask(before)
    for path in (tmp_path / "a.txt", tmp_path / "set" / "b.txt"):
        assert path.stat().st_mode & 0o777 == 0o666 & ~mask
    assert (tmp_path / "set").stat().st_mode & 0o777 == 0o777 & ~mask


def write_two(part):
    return [write_text(part / "a.txt", "new"), write_text(part / "b" / "c.txt", "new")]


def contents(folder):
    return {str(path.relative_to(folder)): path.read_text() for path in sorted(folder.rglob("*")) if path.is_file()}


def test_files_that_belong_together_replace_others_together(tmp_path):
    folder = tmp_path / "set"
    assert write_together(folder, write_two) == [folder / "a.txt", folder / "b" / "c.txt"]
    (folder / "a.txt").write_text("old")
    (folder / "other.txt").write_text("stays")
    write_together(folder, write_two)
    assert contents(folder) == {"a.txt": "new", "b/c.txt": "new", "other.txt": "stays"}
    assert list(tmp_path.iterdir()) == [folder]


def test_where_one_cannot_be_put_in_place_all_stay_as_they_were(tmp_path):
    folder = tmp_path / "set"
    (folder / "b" / "c.txt").mkdir(parents=True)
    (folder / "a.txt").write_text("old")
    with pytest.raises(OutputError, match="is a folder; it is as it was"):
        write_together(folder, write_two)
    assert contents(folder) == {"a.txt": "old"}
    assert list(tmp_path.iterdir()) == [folder]


@pytest.mark.parametrize("name", ["a\0b", "x" * 300])
def test_a_name_that_no_file_can_have_is_bad_input(tmp_path, name):
    for write in (check_folder, lambda path: write_text(path, ""), lambda path: write_together(path, write_two)):
        with pytest.raises(SeatsimError, match=r"cannot be written"):
            write(tmp_path / name if "x" in name else Path(name))
    assert list(tmp_path.iterdir()) == []


def test_files_take_the_place_of_links_and_folders_that_are_links_are_refused(tmp_path):
    victim, out = tmp_path / "victim", tmp_path / "out"
    victim.mkdir()
    (victim / "file").write_text("precious")
    out.mkdir()
    for name in ("a", "b"):
        (out / name).symlink_to(victim / "file")
    write_text(out / "a", "new")
    write_together(out, lambda part: [write_text(part / "b", "new")])
    assert (out / "a").read_text() == (out / "b").read_text() == "new" and not (out / "b").is_symlink()
    (out / "plots").symlink_to(victim)
    with pytest.raises(InputError, match="plots: is a link, through which nothing is written"):
        write_together(out, lambda part: [write_text(part / "b", "newer"), write_text(part / "plots" / "file", "x")])
    assert (victim / "file").read_text() == "precious" and (out / "b").read_text() == "new"
    (tmp_path / "results").symlink_to(out)  # a place that the user names may be a link
    assert write_together(tmp_path / "results", lambda part: [write_text(part / "c", "new")])[0].read_text() == "new"


@pytest.mark.skipif(os.name != "posix" or os.getuid() != 0, reason="only root can make another user's link")
def test_nothing_is_written_over_another_users_link(tmp_path):
    (tmp_path / "victim").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "victim")
    assert write_text(tmp_path / "link" / "deep" / "own", "").exists()
    os.lchown(tmp_path / "link", 12345, -1)
    for write in (write_text, lambda path, text: write_together(path, lambda part: [write_text(part / "a", text)])):
        with pytest.raises(InputError, match="link: is another user's link"):
            write(tmp_path / "link" / "deep" / "other", "")
    assert [path.name for path in (tmp_path / "victim" / "deep").iterdir()] == ["own"]
