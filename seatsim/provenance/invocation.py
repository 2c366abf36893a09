"""The command that is at work: its name, its arguments, where it was started, and what it has read so far."""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import NamedTuple

from seatsim.provenance.statement import StatedFile, state_file
from seatsim.schema.guarded import watch_reads
from seatsim.schema.modules import used_files

REPEATABLE: Mapping[str, frozenset[str]] = {
    name: frozenset(options.split())
    for name, options in {
        "run": "--set", "compare": "--set --bracket", "synthesise": "--set", "gap": "--predict",
        "diagnose": "--without --budget --damper-forms --after",
        "characterise": "--model --parameters --currents --temperatures --amplitudes --frequencies",
        "identify": "--model --test --test-fraction --fix --ignore-temperature --predict --moving-average --centred"
                    " --seed",
        "import": "--map --nominal", "comfort": "--channel --hours --run --block --rate --unit",
        "seat-test": "--class --set", "sweep": "", "sweep-report": "",
    }.items()
}  # fmt: skip
"""Commands that can be run again, with the options on which their answer hangs: none writes, loads code or connects."""


class Invocation(NamedTuple):
    """A command at work; `reads` grows with every file that it reads, by absolute path."""

    command: str
    arguments: tuple[str, ...]
    directory: Path
    reads: dict[Path, StatedFile]


_current: ContextVar[Invocation | None] = ContextVar("invocation", default=None)


@contextmanager
def at_work(command: str, options: Sequence[tuple[str, object]], operands: Sequence[object]) -> Iterator[None]:
    """Keep, while a command is at work, what its manifest will state.

    Args:
        command: its name.
        options: each that was given, with its value; True for one that takes none.
        operands: what it was given besides, in order.
    """
    kept = [_join(name, value) for name, value in options if name in REPEATABLE.get(command, ())]
    arguments = (*kept, "--", *map(_shorten, operands))
    invocation = Invocation(command, arguments, Path.cwd(), {})
    token = _current.set(invocation)
    try:
        with watch_reads(lambda path, content: _keep(invocation, path, content)):
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


def _keep(invocation: Invocation, path: Path, content: bytes) -> None:
    whole = os.path.abspath(invocation.directory / path)
    invocation.reads[Path(whole)] = state_file(whole, content)


def _join(name: str, value: object) -> str:
    return name if value is True else f"{name}={_shorten(value)}"


def _shorten(value: object) -> str:
    """Return an argument as text, an absolute path relative to the current folder: the tree may be moved."""
    text = str(value)
    return relate(Path(text), Path.cwd()) if os.path.isabs(text) and os.path.exists(text) else text


def relate(path: Path, folder: Path) -> str:
    """Return a path relative to a folder, with slashes; an absolute one where it lies on another drive."""
    try:
        return Path(os.path.relpath(path, folder)).as_posix()
    except ValueError:
        return path.as_posix()
