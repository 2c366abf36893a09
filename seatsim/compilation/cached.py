"""Compiled functions on disk, keyed by the sources of everything that is compiled into them.

numba keys its cache by the file of the outermost function alone; a changed callee (an edited damper model) would be
served from a stale entry. Here every combination of sources has a cache folder of its own. The key holds the files and
what is loaded of them, since a file may be edited after its import.

numba unpickles what it finds, and hands the code in it to the processor: a truncated entry is a traceback, a damaged
one may end the process. Here every file begins with the SHA-256 of the rest: an entry that is not as it was written is
discarded, and a full disk is no error. What an entry holds is as trustworthy as whoever may write it, so that neither a
folder nor a file is used that another user may have written.
"""

from __future__ import annotations

import gc
import hashlib
import os
import pickle
import stat
import sys
import sysconfig
import threading
import warnings
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import TypeVar, cast

import numba
import numpy as np
import platformdirs
from numba.core import event
from numba.core.caching import FunctionCache, IndexDataCacheFile
from numba.core.dispatcher import Dispatcher

from seatsim.compilation.jit import ARITHMETIC
from seatsim.compilation.messages import report
from seatsim.schema.registry import current_order

_DIGEST = hashlib.sha256().digest_size


class CheckedCache(FunctionCache):  # type: ignore[misc]  # numba has no types
    """The cache of one function."""

    def __init__(self, function: Callable[..., object]) -> None:
        super().__init__(function)
        locator = self._impl.locator
        self._cache_file = _CheckedFile(self._cache_path, self._impl.filename_base, locator.get_source_stamp())

    def save_overload(self, sig: object, data: object) -> None:
        """Keep a compiled function; where that fails it is compiled again by the next process."""
        try:
            super().save_overload(sig, data)
        except OSError as error:
            warnings.warn(f"compiled code cannot be kept in {self.cache_path}: {error.strerror}", stacklevel=2)


class _CheckedFile(IndexDataCacheFile):  # type: ignore[misc]  # numba has no types
    """The files of one function: an index of signatures, and the compiled code of each."""

    def _load_index(self) -> dict[object, str]:
        content = _read(Path(self._index_path))
        version, stamp, names = pickle.loads(content) if content else (None, None, {})
        return names if (version, stamp) == (self._version, self._source_stamp) else {}

    def _save_index(self, overloads: dict[object, str]) -> None:
        self._write(self._index_path, (self._version, self._source_stamp, overloads))

    def _load_data(self, name: str) -> object:
        content = _read(Path(self._data_path(name)))
        if content is None:
            raise FileNotFoundError(name)  # which numba takes for an entry that is not there
        return pickle.loads(content)

    def _save_data(self, name: str, data: object) -> None:
        self._write(self._data_path(name), data)

    def _write(self, path: str, value: object) -> None:
        content = self._dump(value)
        with self._open_for_write(path) as file:
            file.write(hashlib.sha256(content).digest() + content)


def _read(path: Path) -> bytes | None:
    """Return the content of an entry, None where there is none, where it is another's, or not as it was written."""
    try:
        with path.open("rb") as file:
            if not _is_own(os.fstat(file.fileno())):
                return None
            content = file.read()
    except OSError:
        return None
    if hashlib.sha256(content[_DIGEST:]).digest() == content[:_DIGEST]:
        return content[_DIGEST:]
    warnings.warn(f"{path} is damaged; it is discarded and compiled again", stacklevel=2)
    return None


def find_foreign(folder: Path) -> Path | None:
    """Return a folder, of one and those above it, in which another user may exchange files; None where there is none.

    It must belong to this user or the system, and neither its group nor all may write in it. Above the innermost one
    they may where each can remove only what is his own, as in `/tmp`.
    """
    if not hasattr(os, "getuid"):
        return None
    for innermost in (folder.absolute(), folder.resolve()):
        for level in (innermost, *innermost.parents):
            status = level.stat()
            shared = status.st_mode & (stat.S_IWGRP | stat.S_IWOTH)
            if not _is_own(status) or (shared and (level == innermost or not status.st_mode & stat.S_ISVTX)):
                return level
    return None


def _is_own(status: os.stat_result) -> bool:
    return not hasattr(os, "getuid") or status.st_uid in (os.getuid(), 0)


_F = TypeVar("_F", bound=Callable[..., object])
_OUTSIDE = ("numba", "numpy", "scipy", "llvmlite", "pydantic", "control", "cvxpy")
"""Libraries whose sources change with their version only: they are not part of the key."""
_STANDARD = Path(sysconfig.get_path("stdlib"))
_DIGITS = 20
"""Hexadecimal digits of the key that are kept: 80 bits, in which no two of a user's models meet by chance."""
_ONE_AT_A_TIME = threading.Lock()
"""Runs on threads share numba's setting of the cache folder, and Python 3.11 cannot parse on two of them at once."""


class _Watch(event.Listener):  # type: ignore[misc]  # numba has no types
    """Reports what numba compiles, functions within functions; what is taken from the disk is no such event.

    Meanwhile garbage is left alone: the compiler makes many objects and few cycles, and collecting took a tenth of the
    time.
    """

    def __init__(self) -> None:
        self.depth, self.parts, self.collected = 0, 0, True

    def on_start(self, event: object) -> None:
        """Count a function that begins."""
        if self.depth == 0:
            self.collected = gc.isenabled()
            gc.disable()
        self.depth, self.parts = self.depth + 1, self.parts + 1
        report(self.parts)

    def on_end(self, event: object) -> None:
        """Report the end of the outermost function."""
        self.depth -= 1
        if self.depth == 0:
            report(0)
            if self.collected:
                gc.enable()


event.register("numba:compile", _Watch())


def compiled(function: _F, plugged: Iterable[type]) -> _F:
    """Return the compiled `function`, cached on disk under its sources and those of the `plugged` classes.

    `plugged` are the classes of all records that `function` is called with and whose methods it calls: a class left out
    may run from a stale cache. Where the folder cannot be written, or a source is not in a file, nothing is kept.
    """
    with _ONE_AT_A_TIME:
        return cast("_F", _compiled(function, frozenset(plugged)))


@cache
def _compiled(function: Callable[..., object], plugged: frozenset[type]) -> Callable[..., object]:
    modules = {sys.modules[part.__module__] for part in (function, *plugged)}
    # A notebook has no source.
    folder = find_folder(digest(modules)) if all(map(_source, modules)) else None
    previous = numba.config.CACHE_DIR
    # Without a folder numba would cache beside the source, where it may find stale code.
    numba.config.CACHE_DIR = str(folder or cache_folder())
    try:
        dispatcher: Callable[..., object] = numba.njit(nogil=True, **ARITHMETIC)(function)
        if folder is not None:
            vars(dispatcher)["_cache"] = CheckedCache(function)
        return dispatcher
    finally:
        numba.config.CACHE_DIR = previous


def find_folder(name: str) -> Path | None:
    """Return a folder in the cache that this user alone may write; None where there is none, and nothing is kept."""
    folder = cache_folder() / name
    try:
        _make_private(folder)
        if (foreign := find_foreign(folder)) is not None:
            _warn_of(foreign)
            return None
    except OSError:
        return None
    return folder if os.access(folder, os.W_OK | os.X_OK) else None


def _make_private(folder: Path) -> None:
    """Make a folder with those above it; nobody else may enter those that were missing."""
    for level in reversed([folder, *folder.parents]):
        if not level.is_dir():
            level.mkdir(mode=0o700, exist_ok=True)


@cache
def _warn_of(foreign: Path) -> None:
    warnings.warn(
        f"{foreign} may be written by other users, whose code could be run in place of what is kept: compiled code is"
        f" not kept. Take the right to write from them (chmod go-w {foreign}), or state a folder of your own in"
        " SEATSIM_CACHE_DIR",
        stacklevel=2,
    )


def cache_folder() -> Path:
    """Return the folder of compiled runs: `SEATSIM_CACHE_DIR`, or the user's cache folder."""
    return Path(os.environ.get("SEATSIM_CACHE_DIR") or Path(platformdirs.user_cache_dir("seatsim")) / "compiled")


def digest(modules: Iterable[ModuleType]) -> str:
    """Return a hash over the given modules and what these reach outside libraries: the files and what is loaded.

    Raises:
        OSError: a source cannot be read any more.
    """
    state = hashlib.sha256(f"checked {numba.__version__} {sys.version}".encode())
    for module in sorted(_reachable(modules), key=lambda module: module.__name__):
        state.update(f"{module.__file__}".encode() + Path(str(module.__file__)).read_bytes())
        for part in _loaded(module):
            state.update(part)
    return state.hexdigest()[:_DIGITS]


def _reachable(modules: Iterable[ModuleType]) -> set[ModuleType]:
    """Return the modules and those whose parts they name, directly or not, without libraries that do not change."""
    found, waiting = set[ModuleType](), list(modules)
    while waiting:
        module = waiting.pop()
        if module not in found and _changes(module):
            found.add(module)
            waiting += _list_named(module)
    return found


def _list_named(module: ModuleType) -> Iterator[ModuleType]:
    """Yield the modules that a module names, and those that made the functions and classes that it names.

    A number that it names belongs to none: `_loaded` states its value.
    """
    is_library = "site-packages" in Path(str(module.__file__)).parts
    for own, value in vars(module).items():
        # The module's loader, and what pytest writes into a module for its asserts, differ in tests.
        if not own.isidentifier() or own.startswith("__"):
            continue
        name = getattr(value, "__module__", None)
        if isinstance(value, ModuleType):
            # A library has those of its parts that anybody imported, such as its plugin for pytest.
            name = None if is_library and value.__name__ == f"{module.__name__}.{own}" else value.__name__
        if isinstance(name, str) and name in sys.modules:
            yield sys.modules[name]


def _loaded(module: ModuleType) -> Iterator[bytes]:
    """Yield the code of the module's functions and methods and its constants, as they are in this process."""
    for name, value in sorted(vars(module).items()):
        own = getattr(value, "__module__", None) == module.__name__
        # Only what numba compiled is asked for its function: some objects answer every name, such as pytest's marks.
        functions = [value.py_func if isinstance(value, Dispatcher) else value]
        for function in vars(value).values() if own and isinstance(value, type) else functions:
            if isinstance(function, FunctionType):
                yield from _code(function.__code__)
        if own and isinstance(value, type):
            yield f"{name} {current_order(value)}".encode()
        if isinstance(value, int | float | complex | np.ndarray | tuple) and not name.startswith("__"):
            yield f"{name} {_constant(value)}".encode()


def _constant(value: object) -> str:
    """Return a number, or a tuple or array of numbers, in full; nothing of other values."""
    if isinstance(value, np.ndarray):
        return f"{value.dtype.str} {value.shape} {value.tobytes().hex()}"
    if isinstance(value, tuple):
        return "(" + ", ".join(map(_constant, value)) + ")"
    return repr(value) if isinstance(value, int | float | complex) else ""


def _code(code: CodeType) -> Iterator[bytes]:
    """Yield what a function does: its instructions, the names it uses and its constants, those of inner ones too."""
    yield code.co_code + repr(code.co_names).encode()
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _code(constant)
        else:
            # The order of a set differs between processes, and with it the key would.
            yield repr(sorted(constant, key=repr) if isinstance(constant, frozenset) else constant).encode()


def _source(module: ModuleType) -> Path | None:
    """Return the file of a module that was written in Python, None of any other (built in, typed into a notebook)."""
    file = getattr(module, "__file__", None)
    return Path(file) if file and file.endswith(".py") else None


def _changes(module: ModuleType) -> bool:
    """Whether a module may be edited: it is neither of the standard library nor of one that is named outside."""
    file = _source(module)
    if file is None or module.__name__.partition(".")[0] in _OUTSIDE:
        return False
    return _STANDARD not in file.parents or "site-packages" in file.parts
