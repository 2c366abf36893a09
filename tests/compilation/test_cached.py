"""The folder of the cache: the one that was chosen, and safe from other users."""

import os

import pytest

from seatsim.compilation import cached
from seatsim.compilation.cached import find_foreign


@pytest.fixture
def choose(monkeypatch):
    """Choose the folder of the cache, or none."""

    def call(folder):
        monkeypatch.setenv("SEATSIM_CACHE_DIR", str(folder or ""))

    return call


def test_the_folder_is_the_one_that_was_chosen(choose, tmp_path):
    choose(tmp_path)
    assert cached.cache_folder() == tmp_path
    choose(None)
    assert cached.cache_folder().name == "compiled" and cached.cache_folder().is_absolute()


def test_a_folder_is_made_for_its_user_alone_unless_it_cannot_be(tmp_path, choose):
    choose(tmp_path / "a" / "b")
    before = os.umask(0o002)
    try:
        assert cached.find_folder("key") == tmp_path / "a" / "b" / "key"
    finally:
        os.umask(before)
    assert (tmp_path / "a").stat().st_mode & 0o777 == 0o700
    assert cached.find_folder("key") == tmp_path / "a" / "b" / "key"
    (tmp_path / "file").touch()
    choose(tmp_path / "file")
    assert cached.find_folder("key") is None


@pytest.mark.parametrize("level", ["above", "above/cache", "above/cache/key"])
@pytest.mark.parametrize("mode", [0o775, 0o777, 0o757, 0o1777])
def test_nothing_is_kept_in_a_folder_that_others_may_write(level, mode, tmp_path, choose):
    cache = tmp_path / "above" / "cache"
    choose(cache)
    assert cached.find_folder("key") == cache / "key"
    (tmp_path / level).chmod(mode)
    cached._warn_of.cache_clear()
    if mode == 0o1777 and level != "above/cache/key":  # as in /tmp, nobody can exchange what is another's
        assert cached.find_folder("key") == cache / "key"
        return
    with pytest.warns(UserWarning, match=rf"{tmp_path / level} may be written by other users.*SEATSIM_CACHE_DIR"):
        assert cached.find_folder("key") is None


def test_a_way_over_a_link_is_as_safe_as_both_of_its_ends(tmp_path):
    (tmp_path / "open").mkdir()
    (tmp_path / "own" / "key").mkdir(parents=True)
    (tmp_path / "open" / "link").symlink_to(tmp_path / "own")
    (tmp_path / "open").chmod(0o777)
    assert find_foreign(tmp_path / "own" / "key") is None
    assert find_foreign(tmp_path / "open" / "link" / "key") == tmp_path / "open"
    if os.getuid() == 0:
        os.chown(tmp_path / "own", 12345, -1)
        assert find_foreign(tmp_path / "own" / "key") == tmp_path / "own"
