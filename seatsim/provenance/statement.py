"""`manifest.json` beside the files of a command: what made them, of which inputs and files by hash, and versions.

The manifest holds no time and no absolute path, so that equal commands on equal inputs give equal manifests.
"""

import hashlib
import os
import platform
import shlex
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import NamedTuple

from pydantic import ValidationError

import seatsim
from seatsim.schema.content import IfAny
from seatsim.schema.errors import InputError
from seatsim.schema.fields import read_packaged, validated
from seatsim.schema.files import write_json, write_together
from seatsim.schema.guarded import expect, is_there, read_json, watch_reads
from seatsim.schema.modules import import_named, shipped_packages, used_files
from seatsim.schema.text import explain_bad_name

_LIBRARIES = ("numpy", "scipy", "numba", "pyarrow", "pandas", "matplotlib", "cvxpy-base", "clarabel", "cma")
"""Libraries that a figure, or the bytes of a file, may hang on."""


def list_versions(libraries: Iterable[str] = _LIBRARIES, files: Iterable[Path] = ()) -> Mapping[str, str]:
    """Return the versions of Python, seatsim and some libraries, with a hash over all sources and `files`."""
    own = {"python": platform.python_version(), "seatsim": seatsim.__version__}
    return own | {name: _find_version(name) for name in libraries} | {"sources": _digest_sources(tuple(files))}


@cache
def _find_version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:  # the same modules came in another package, such as `cvxpy` in place of `cvxpy-base`
        return "unknown"


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
    # Tables beside the code are part of it; the examples are not.
    kinds = (path for folder in folders for kind in ("*.py", "*.yaml") for path in sorted(Path(folder).rglob(kind)))
    sources = [path for path in kinds if "examples" not in path.parts]
    for path in (*sources, *more):
        state.update(path.name.encode() + path.read_bytes())
    return state.hexdigest()[:16]


MANIFEST = "manifest.json"
EXAMPLE = "example:"
"""Begins the path of an input that comes with seatsim."""
Measured = Mapping[str, tuple[str, ...]]
"""Columns or keys of files that hold times which were measured, and differ each time."""
_KIND = "manifest of a command of seatsim"


class _StatedFile(NamedTuple):
    """A file by its path, relative to the manifest, with the SHA-256 of its content and its size in bytes."""

    path: str
    sha256: str
    bytes: IfAny[int | None] = None


class Manifest(NamedTuple):
    """Which command made a folder, from which inputs: the content of `manifest.json`.

    `seed` is that of every random draw, None where the inputs state several. `directory` is where the command was
    started, relative to the folder. `measured` names columns or keys of files that hold times which were measured.
    `configuration` and `counts` are those of a sweep.
    """

    command: str
    arguments: Sequence[str]
    directory: str
    folder: str
    versions: Mapping[str, str]
    platform: Mapping[str, str]
    own_code: Sequence[_StatedFile]
    inputs: Sequence[_StatedFile]
    outputs: Sequence[_StatedFile]
    measured: Mapping[str, Sequence[str]]
    seed: int | None = None
    configuration: IfAny[Mapping[str, object] | None] = None
    counts: IfAny[Mapping[str, int] | None] = None


def state_file(path: str, content: bytes) -> _StatedFile:
    """Return what a manifest states of a file."""
    return _StatedFile(path, hashlib.sha256(content).hexdigest(), len(content))


def read_manifest(folder: Path) -> Manifest:
    """Return the manifest of a folder.

    Raises:
        InputError: there is none, it is not one that `seatsim` writes, or its sweep is not complete.
    """
    path = folder / MANIFEST
    if within := sorted(each.parent.as_posix() for each in folder.glob(f"*/{MANIFEST}")) if not is_there(path) else []:
        raise InputError(f"{path}: is not there; folders in it have one each: 'seatsim reproduce {within[0]}'")
    content: Mapping[str, object] = read_json(path, _KIND)
    with expect(path, _KIND):
        if "identity" in content and "command" not in content:
            raise InputError(
                f"{folder}: holds a sweep that no command of seatsim made; run 'seatsim sweep FILE --out OTHER' and"
                f" compare the rows: seatsim.read_sweep({folder.as_posix()!r}).equals(seatsim.read_sweep('OTHER'))"
            )
        stated = {key: value for key, value in content.items() if key in Manifest._fields}
    try:
        found = validated(Manifest, stated)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        place = ".".join(map(str, first["loc"]))
        problem = "is missing" if first["type"] == "missing" else f"is {first['input']!r}: {first['msg'].lower()}"
        raise InputError(f"{path}: is no {_KIND}: {place} {problem}") from None
    if found.counts and found.counts["pending"]:
        left = found.counts["pending"]
        raise InputError(f"{folder}: {left} runs of this sweep are missing; go on with it with --resume first")
    if problem := explain_bad_name(found.folder):
        raise InputError(f"{path}: folder {found.folder!r} {problem}")
    return found


REPEATABLE = read_packaged(Path(__file__).with_name("repeatable.yaml"), dict[str, frozenset[str]])
"""Commands that can be run again, with the options on which their answer hangs: none writes, loads code or connects."""


class Invocation(NamedTuple):
    """A command at work; `reads` grows with every file that it reads, by absolute path."""

    command: str
    arguments: tuple[str, ...]
    directory: Path
    reads: dict[Path, _StatedFile]

    def keep(self, path: Path, content: bytes) -> None:
        """Keep what the manifest will state of a file that was read."""
        whole = os.path.abspath(self.directory / path)
        self.reads[Path(whole)] = state_file(whole, content)


_current: ContextVar[Invocation | None] = ContextVar("invocation", default=None)


@contextmanager
def at_work(command: str, options: Sequence[tuple[str, object]], operands: Sequence[object]) -> Iterator[None]:
    """Keep, while a command is at work, what its manifest will state.

    Args:
        command: its name.
        options: each that was given, with its value; True for one that takes none.
        operands: what it was given besides, in order.
    """
    told = [(name, value) for name, value in options if name in REPEATABLE.get(command, ())]
    kept = [name if value is True else f"{name}={_shorten(value)}" for name, value in told]
    arguments = (*kept, "--", *map(_shorten, operands))
    invocation = Invocation(command, arguments, Path.cwd(), {})
    token = _current.set(invocation)
    try:
        with watch_reads(invocation.keep):
            yield
    finally:
        _current.reset(token)


def current_invocation() -> Invocation | None:
    """Return the command at work, None where seatsim is used from Python."""
    return _current.get()


def state_command(otherwise: str) -> str:
    """Return the command at work as it can be typed again in the folder where it was started.

    Own code is named by its files alone. `otherwise` is returned where seatsim is used from Python.
    """
    invocation = _current.get()
    if invocation is None:
        return otherwise
    split = invocation.arguments.index("--")
    options, operands = invocation.arguments[:split], invocation.arguments[split + 1 :]
    code = [word for path in used_files() for word in ("--with", path.name)]
    return shlex.join(["seatsim", invocation.command, *operands, *options, *code])


def _shorten(value: object) -> str:
    """Return an argument as text, an absolute path relative to the current folder: the tree may be moved."""
    text = str(value)
    return _relate(Path(text), Path.cwd()) if os.path.isabs(text) and os.path.exists(text) else text


def _relate(path: Path, folder: Path) -> str:
    """Return a path relative to a folder, with slashes; an absolute one where it lies on another drive."""
    try:
        return Path(os.path.relpath(path, folder)).as_posix()
    except ValueError:
        return path.as_posix()


def write_documented(
    folder: Path, write: Callable[[Path], Iterable[Path]], seed: int | None = None, measured: Measured | None = None
) -> list[Path]:
    """Write files as `write_together` does, with a manifest where a command is at work.

    Args:
        folder: where they go.
        write: fills a folder and returns its files there.
        seed: from which every random draw derives, None where there is none or the inputs state several.
        measured: see `Measured`.
    """

    def write_all(part: Path) -> list[Path]:
        paths = list(write(part))
        invocation = current_invocation()
        if invocation is None:
            return paths
        outputs = {path.relative_to(part).as_posix(): path for path in paths}
        manifest = describe(invocation, folder, outputs, list_versions(), seed, measured or {})
        return [*paths, write_json(part / MANIFEST, manifest)]

    return write_together(folder, write_all)


def describe(
    invocation: Invocation,
    folder: Path,
    outputs: Mapping[str, Path],
    versions: Mapping[str, str],
    seed: int | None = None,
    measured: Measured | None = None,
) -> Manifest:
    """Return the manifest that a folder gets of the command at work, which wrote `outputs`, paths by name."""
    place = Path(os.path.abspath(folder))
    return Manifest(
        command=invocation.command,
        arguments=invocation.arguments,
        directory=_relate(invocation.directory, place),
        folder=place.name,
        versions=versions,
        platform=list_platform(),
        own_code=[state_file(_relate(path, place), path.read_bytes()) for path in used_files()],
        inputs=[
            stated._replace(path=_name_input(path, place))
            for path, stated in sorted(invocation.reads.items())
            # Drafts that were read back are gone; a sweep that is gone on with reads the manifest that this one
            # replaces.
            if path.is_file() and path != place / MANIFEST
        ],
        outputs=[state_file(name, path.read_bytes()) for name, path in outputs.items()],
        measured={name: fields for name, fields in (measured or {}).items() if name in outputs},
        seed=seed,
    )


def _name_input(path: Path, folder: Path) -> str:
    """Return the path of an input relative to the folder of the manifest, or as an example of seatsim."""
    from seatsim.scenario.loading import EXAMPLES  # takes longer to load than a command that checks its options

    for examples in filter(path.is_relative_to, EXAMPLES):
        return f"{EXAMPLE}{path.relative_to(examples).as_posix()}"
    return _relate(path, folder)
