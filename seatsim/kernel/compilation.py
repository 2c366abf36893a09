"""Compiled functions on disk, keyed by the sources of everything that is compiled into them.

numba keys its cache by the file of the outermost function alone; a changed callee (an edited damper model) would be
served from a stale entry. Here every combination of sources has a cache folder of its own.
"""

from __future__ import annotations

import hashlib
import os
import sys
import sysconfig
from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numba
import platformdirs

_OUTSIDE = ("numba", "numpy", "scipy", "llvmlite", "pydantic", "control", "cvxpy")


def compiled(function: Callable[..., Any], plugged: Iterable[type]) -> Callable[..., Any]:
    """Return the compiled `function`, cached on disk under the sources of seatsim and of the `plugged` classes."""
    modules = frozenset(sys.modules[cls.__module__] for cls in plugged)
    return _compiled(function, modules)


@cache
def _compiled(function: Callable[..., Any], modules: frozenset[ModuleType]) -> Callable[..., Any]:
    previous = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(cache_folder() / digest(modules))
    try:
        dispatcher: Callable[..., Any] = numba.njit(cache=True, nogil=True)(function)
    finally:
        numba.config.CACHE_DIR = previous
    return dispatcher


def cache_folder() -> Path:
    """Return the folder of compiled runs: `SEATSIM_CACHE_DIR`, or the user's cache folder."""
    chosen = os.environ.get("SEATSIM_CACHE_DIR")
    return Path(chosen) if chosen else Path(platformdirs.user_cache_dir("seatsim")) / "compiled"


def digest(modules: Iterable[ModuleType]) -> str:
    """Return a hash over the sources of seatsim, of the given modules, and of what these reach outside libraries."""
    files = set(Path(__file__).parents[1].rglob("*.py"))
    for module in _reachable(modules):
        files.add(Path(str(module.__file__)))
    state = hashlib.sha256(f"{numba.__version__} {sys.version}".encode())
    for file in sorted(files):
        state.update(str(file).encode() + file.read_bytes())
    return state.hexdigest()[:20]


def _reachable(modules: Iterable[ModuleType]) -> set[ModuleType]:
    """Return the modules and those whose objects stand in their globals, without libraries that do not change."""
    found: set[ModuleType] = set()
    waiting = list(modules)
    while waiting:
        module = waiting.pop()
        if module in found or not _changes(module):
            continue
        found.add(module)
        for value in vars(module).values():
            name = value.__name__ if isinstance(value, ModuleType) else getattr(value, "__module__", None)
            if isinstance(name, str) and name in sys.modules:
                waiting.append(sys.modules[name])
    return found


def _changes(module: ModuleType) -> bool:
    file = getattr(module, "__file__", None)
    if not file or not file.endswith(".py") or module.__name__.partition(".")[0] in _OUTSIDE:
        return False
    standard = Path(sysconfig.get_path("stdlib"))
    return standard not in Path(file).parents or "site-packages" in file
