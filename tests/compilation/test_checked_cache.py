"""Damaged entries of the cache of compiled code are discarded, and a cache that cannot be written is no error."""

import errno
import os
import shutil
from functools import partial

import numba
import pytest

from seatsim.compilation.cached import CheckedCache, _CheckedFile


def double(x):
    return 2.0 * x


DAMAGES = {
    "empty": lambda content: b"",
    "truncated": lambda content: content[: len(content) // 2],
    "zeros": lambda content: bytes(len(content)),
    "longer": lambda content: content + b"x",
    "one bit": lambda content: content[:-5] + bytes([content[-5] ^ 1]) + content[-4:],
    "another entry": lambda content: content[:32] + content[33:],
}


def load(folder):
    """Compile `double`, or take it from the cache, as a new process does; return how often it was taken."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(numba.config, "CACHE_DIR", str(folder))
        dispatcher = numba.njit(double)
        dispatcher._cache = CheckedCache(double)
        assert dispatcher(3.0) == 6.0
    return sum(dispatcher.stats.cache_hits.values())


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    """A cache that holds `double`, which no test edits."""
    folder = tmp_path_factory.mktemp("kept")
    assert (load(folder), load(folder)) == (0, 1)
    return folder


@pytest.fixture
def start(kept, tmp_path):
    """Return a function that loads `double` from a copy of that cache in `tmp_path`."""
    shutil.copytree(kept, tmp_path, dirs_exist_ok=True)
    return partial(load, tmp_path)


@pytest.mark.parametrize(
    ("damage", "ending"),
    [*((damage, "nbc") for damage in DAMAGES), ("empty", "nbi"), ("truncated", "nbi"), ("one bit", "nbi")],
)
def test_a_damaged_entry_is_discarded_and_made_again(start, tmp_path, ending, damage):
    (entry,) = tmp_path.rglob(f"*.{ending}")
    entry.write_bytes(DAMAGES[damage](entry.read_bytes()))
    with pytest.warns(UserWarning, match="is damaged; it is discarded and compiled again"):
        assert start() == 0
    assert start() == 1


def test_an_entry_that_is_gone_is_made_again(start, tmp_path):
    for entry in tmp_path.rglob("*.nbc"):
        entry.unlink()
    assert (start(), start()) == (0, 1)


def test_a_full_disk_is_no_error(start, tmp_path, monkeypatch):
    for entry in [*tmp_path.rglob("*.nbc"), *tmp_path.rglob("*.nbi")]:
        entry.unlink()

    def fail(self, path):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(_CheckedFile, "_open_for_write", fail)
    with pytest.warns(UserWarning, match="cannot be kept in .*No space left"):
        assert start() == 0


@pytest.mark.skipif(os.name != "posix" or os.getuid() != 0, reason="only root can give files away")
def test_an_entry_of_another_user_is_not_taken(start, tmp_path):
    for entry in [*tmp_path.rglob("*.nbc"), *tmp_path.rglob("*.nbi")]:
        os.chown(entry, 12345, -1)
    assert (start(), start()) == (0, 1)
