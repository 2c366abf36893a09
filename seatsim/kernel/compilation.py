"""Compiled functions on disk, keyed by the sources of everything that is compiled into them.

numba keys its cache by the file of the outermost function alone; a changed callee (an edited damper model) would be
served from a stale entry. Here every combination of sources has a cache folder of its own.
"""

from __future__ import annotations

import ast
import hashlib
import os
import sys
import sysconfig
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from importlib.util import resolve_name
from pathlib import Path
from types import ModuleType
from typing import Any

import numba
import platformdirs

from seatsim.kernel.options import ARITHMETIC

_OUTSIDE = ("numba", "numpy", "scipy", "llvmlite", "pydantic", "control", "cvxpy")


def compiled(function: Callable[..., Any], plugged: Iterable[type]) -> Callable[..., Any]:
    """Return the compiled `function`, cached on disk under its sources and those of the `plugged` classes."""
    modules = frozenset(sys.modules[part.__module__] for part in (function, *plugged))
    return _compiled(function, modules)


@cache
def _compiled(function: Callable[..., Any], modules: frozenset[ModuleType]) -> Callable[..., Any]:
    previous = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(cache_folder() / digest(modules))
    try:
        dispatcher: Callable[..., Any] = numba.njit(cache=True, nogil=True, **ARITHMETIC)(function)
    finally:
        numba.config.CACHE_DIR = previous
    return dispatcher


def cache_folder() -> Path:
    """Return the folder of compiled runs: `SEATSIM_CACHE_DIR`, or the user's cache folder."""
    chosen = os.environ.get("SEATSIM_CACHE_DIR")
    return Path(chosen) if chosen else Path(platformdirs.user_cache_dir("seatsim")) / "compiled"


def digest(modules: Iterable[ModuleType]) -> str:
    """Return a hash over the sources of the given modules and of what these reach outside libraries."""
    files = {Path(str(module.__file__)) for module in _reachable(modules)}
    state = hashlib.sha256(f"{numba.__version__} {sys.version}".encode())
    for file in sorted(files):
        state.update(str(file).encode() + file.read_bytes())
    return state.hexdigest()[:20]


def _reachable(modules: Iterable[ModuleType]) -> set[ModuleType]:
    """Return the modules and all that they import, directly or not, without libraries that do not change."""
    found: set[ModuleType] = set()
    waiting = list(modules)
    while waiting:
        module = waiting.pop()
        if module not in found and _changes(module):
            found.add(module)
            waiting += [sys.modules[name] for name in _imported(module) if name in sys.modules]
    return found


def _imported(module: ModuleType) -> Iterator[str]:
    """Yield the full names of what the module's source imports."""
    for node in ast.walk(ast.parse(Path(str(module.__file__)).read_bytes())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            origin = resolve_name("." * node.level + (node.module or ""), module.__package__)
            yield origin
            yield from (f"{origin}.{alias.name}" for alias in node.names)


def _changes(module: ModuleType) -> bool:
    file = getattr(module, "__file__", None)
    if not file or not file.endswith(".py") or module.__name__.partition(".")[0] in _OUTSIDE:
        return False
    standard = Path(sysconfig.get_path("stdlib"))
    return standard not in Path(file).parents or "site-packages" in file
