"""Versions and platform on which the bytes of an answer may hang."""

from __future__ import annotations

import hashlib
import os
import platform
import re
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from importlib.metadata import distribution
from pathlib import Path

import seatsim
from seatsim.schema.modules import import_named, shipped_packages

LIBRARIES = ("numpy", "scipy", "numba", "pyarrow", "pandas", "matplotlib", "cvxpy", "clarabel", "cma")
"""Libraries that a figure, or the bytes of a file, may hang on."""


def list_versions(libraries: Iterable[str] = LIBRARIES, files: Iterable[Path] = ()) -> Mapping[str, str]:
    """Return the versions of Python, seatsim and some libraries, with a hash over all sources and `files`."""
    found = {"python": platform.python_version(), "seatsim": seatsim.__version__}
    found |= {name: _read_version(name) for name in libraries}
    return found | {"sources": _digest_sources(tuple(files))}


@cache
def _read_version(name: str) -> str:
    """Return the version of an installed library; `importlib.metadata.version` parses its long description, too."""
    text = distribution(name).read_text("METADATA") or ""
    found = re.search(r"^Version: (.+)$", text, re.MULTILINE)
    return found[1].strip() if found else distribution(name).version


@cache
def list_platform() -> Mapping[str, str]:
    """Return system, machine and processor, since compiled code and linear algebra are made for them."""
    from llvmlite.binding import get_host_cpu_name

    return {"system": platform.system(), "machine": platform.machine(), "processor": get_host_cpu_name()}


@cache
def _digest_sources(more: tuple[Path, ...]) -> str:
    # What is being worked on keeps its version while its figures change.
    state = hashlib.sha256()
    folders = [next(iter(import_named(name).__path__)) for name in sorted(shipped_packages())]
    sources = [Path(path) for folder in folders for path in _list_sources(folder)]
    for path in (*sources, *more):
        state.update(path.name.encode() + path.read_bytes())
    return state.hexdigest()[:16]


def _list_sources(folder: str) -> Iterator[str]:
    """Yield the sources below a folder in order; `Path.rglob` takes as long as reading them."""
    for entry in sorted(os.scandir(folder), key=lambda each: each.name):
        if entry.is_dir(follow_symlinks=False):
            yield from _list_sources(entry.path)
        elif entry.name.endswith(".py"):
            yield entry.path
