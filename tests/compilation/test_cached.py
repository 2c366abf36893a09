"""What the key of the cache is made of, module by module, without compiling anything."""

import os
import sys
import types
from pathlib import Path

import numba
import numpy as np
import pytest

from seatsim.compilation import cached
from seatsim.compilation.cached import CheckedCache, find_foreign


@pytest.fixture
def module(tmp_path, monkeypatch):
    """A function that makes a module out of its source, imported under a name."""

    def make(name, text, package=""):
        file = tmp_path / f"{name}.py"
        file.write_text(text)
        made = types.ModuleType(name)
        made.__file__, made.__package__ = str(file), package
        monkeypatch.setitem(sys.modules, name, made)
        exec(compile(text, str(file), "exec"), vars(made))
        return made

    return make


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


def test_what_a_module_names_is_followed_but_not_what_it_imports_within_functions_or_for_types(module):
    made = module(
        "importing",
        "import math\nfrom typing import TYPE_CHECKING\nfrom statistics import mean as average\n"
        "if TYPE_CHECKING:\n    import decimal\nelse:\n    import fractions\n"
        "import json.decoder\n"
        "def f():\n    import random\n",
    )
    found = {named.__name__ for named in cached._list_named(made)}
    assert {"importing", "math", "fractions", "json", "statistics"} <= found
    assert not {"decimal", "random"} & found


def test_libraries_do_not_change(module):
    import json

    assert not cached._changes(numba) and not cached._changes(np) and not cached._changes(json)
    assert not cached._changes(sys) and not cached._changes(types.ModuleType("typed_in"))
    assert cached._changes(cached) and cached._changes(module("own", ""))
    outside = types.ModuleType("pydantic.fields")
    outside.__file__ = cached.__file__
    assert not cached._changes(outside)


def test_the_key_changes_with_every_file_and_with_what_is_loaded(module):
    low = module("low", "import math\nfrom pytest import mark\nA = 1\ndef f(a):\n    return a + 1.0\n")
    module("middle", "import low\n")
    top = module("top", "from middle import low\n")
    keys = [cached.digest([top])]
    assert cached.digest([top]) == cached.digest([top, low]) == keys[0]
    Path(low.__file__).write_text("A = 1 \n")
    keys.append(cached.digest([top]))
    low.A = 2
    keys.append(cached.digest([top]))
    # Other instructions, names, constants, and constants of functions within it.
    for text in ("a - 1.0", "a + 2.0", "math.sin(a)", "math.cos(a)", "[lambda: 1.0][0]", "[lambda: 2.0][0]"):
        exec(f"def f(a):\n    return {text}\n", vars(low))
        keys.append(cached.digest([top]))
    assert len(set(keys)) == 9
    assert all(len(key) == 20 and int(key, 16) >= 0 for key in keys)


def test_a_function_is_kept_where_all_sources_are_files(module, choose, tmp_path):
    choose(tmp_path)
    square = module("squares", "def square(a):\n    return a * a\n").square
    previous = numba.config.CACHE_DIR
    inside = type("Inside", (), {"__module__": "typed_in"})
    del module("typed_in", "").__file__
    for plugged, kept in (((), True), ((Path,), True), ((inside,), False)):
        function = cached.compiled(square, plugged)
        assert isinstance(function._cache, CheckedCache) is kept
        assert function.targetoptions["nogil"] and function.targetoptions["error_model"] == "numpy"
        assert previous == numba.config.CACHE_DIR
        if kept:
            key = cached.digest(sys.modules[part.__module__] for part in (square, *plugged))
            assert Path(function._cache.cache_path).is_relative_to(tmp_path / key)
