"""What every command says: sentences, files written, notes, failures and progress, or one JSON object."""

from __future__ import annotations

import io
import json
import os
import shlex
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from rich.console import Console

from seatsim.compilation.messages import watch_compilation
from seatsim.schema.errors import SeatsimError, list_sentences
from seatsim.schema.modules import MissingModuleError
from seatsim.schema.text import cut_words, make_printable


class _Terminal(Console):
    """A console whose reader may go away, as that of `| head` does, without the command coming to its end."""

    answered = False
    """Whether the one object of `--json` is printed: what fails after that is said on standard error alone."""

    def on_broken_pipe(self) -> None:
        """Go on without printing."""
        _drop_output(sys.stdout if not self.stderr else sys.stderr)


def _drop_output(stream: TextIO) -> None:
    """Let what is still printed to a stream whose reader has gone away go nowhere."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, stream.fileno())
    os.close(nowhere)


def print_any_letter() -> None:
    """Let a terminal that knows ASCII alone show a question mark for other letters, where Python would fail."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


out = _Terminal(emoji=False)
_err = _Terminal(emoji=False, stderr=True)

_COMPILING = "compiling (first time only)"
Report = Callable[[str], None]
"""Is called with what is being done."""
_Count = Callable[[int, int], None]
"""Is called with how many are done, and of how many."""


def answer_as_json(wanted: bool) -> bool:
    """Leave standard output to the one object of `answer`, or not; returns what was wanted."""
    out.quiet = wanted
    out.answered = False
    return wanted


def answer(record: object, paths: Iterable[Path] = ()) -> None:
    """Print what a command found as one JSON object, with the files it wrote, where `--json` asks for it."""
    if out.quiet:
        from seatsim.schema.content import to_content

        content = {**to_content(record), "files": [str(path) for path in paths]}
        _write_line(json.dumps(content, allow_nan=False))


def announce(address: str) -> None:
    """Print the address of a page at once, since the command goes on until it is interrupted."""
    say(address)
    answer({"address": address})
    sys.stdout.flush()


def say(text: str) -> None:
    """Print a sentence as it is."""
    out.print(make_printable(text), markup=False, highlight=False, soft_wrap=True)


def wrote(folder: Path, paths: Sequence[Path]) -> None:
    """Print which files were written."""
    say(f"written to {folder}: {', '.join(path.name for path in paths)}")


def wrote_one(path: Path) -> None:
    """Print which file was written."""
    say(f"written: {path}")


def conclude(found: object, folder: Path, paths: Sequence[Path]) -> None:
    """Print which files were written, or with `--json` what was found as the one object."""
    wrote(folder, paths)
    answer(found, paths)


def warn(texts: Iterable[str], kind: str = "note") -> None:
    """Print what the user has to know about the result."""
    for text in texts:
        _err.print(make_printable(f"{kind}: {text}"), style="yellow", markup=False, highlight=False, soft_wrap=True)


def complain(text: str) -> None:
    """Print what failed."""
    _err.print(make_printable(text), style="red", markup=False, highlight=False, soft_wrap=True)


def fail(*texts: str) -> None:
    """Print why a command came to its end: on standard error, and as the one object where `--json` asks for it."""
    short = [cut_words(text) for text in texts]
    for text in short:
        complain(f"error: {text}")
    answer_error(*short)


def refuse(error: SeatsimError, everything: bool = False) -> None:
    """Print what is wrong first, or `everything` that is, and this command with `--with FILE` where it lacks a file."""
    sentences = list_sentences(error)
    fail(*sentences[: None if everything else 1])
    cause: BaseException | None = error
    while cause is not None and not isinstance(cause, MissingModuleError):
        cause = cause.__cause__
    if cause is not None and cause.file is not None:
        words = ["seatsim", *sys.argv[1:], "--with", str(cause.file)]
        complain(f"if you trust that file: {shlex.join(words)}")


def answer_error(first: str, *others: str) -> None:
    """Print why a command came to its end as the one object, where `--json` asks for it."""
    if out.quiet:
        _write_line(json.dumps({"error": first, **({"errors": [first, *others]} if others else {})}))


def _write_line(text: str) -> None:
    if out.answered:
        return
    out.answered = True
    try:
        sys.stdout.write(f"{text}\n")
        sys.stdout.flush()
    except BrokenPipeError:
        _drop_output(sys.stdout)


@contextmanager
def count_progress(title: str, total: int | None = None) -> Iterator[_Count]:
    """Show a bar on the terminal; what is compiled before the first is done has one of its own."""
    from rich.progress import Progress

    with Progress(console=_err, transient=True, disable=not _err.is_terminal) as progress:
        compiling = progress.add_task(_COMPILING, total=None, visible=False)
        task = progress.add_task(title, total=total)

        def tell(parts: int) -> None:
            progress.update(compiling, description=_describe_parts(parts), visible=parts > 0)
            progress.update(task, visible=parts == 0 or progress.tasks[task].completed > 0)

        with watch_compilation(tell):
            yield lambda done, total: progress.update(task, completed=done, total=total)


@contextmanager
def show_progress() -> Iterator[Report]:
    """Show on the terminal what is being done."""
    doing = ["reading"]
    with _err.status(doing[0]) as status:

        def show(text: str) -> None:
            doing[0] = text
            status.update(text)

        with watch_compilation(lambda parts: status.update(_describe_parts(parts) if parts else doing[0])):
            yield show


def _describe_parts(parts: int) -> str:
    return f"{_COMPILING}: {parts} functions"
