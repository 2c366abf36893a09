"""What every command says on the terminal, and how it reads options."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import Progress
from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError

from seatsim.schema.errors import InputError

out = Console()
err = Console(stderr=True)

Out = Annotated[Path | None, typer.Option("--out", help="Folder for the files.", show_default="out/NAME")]


def wide(letters: int) -> Console:
    """Return the console; where it is a file, or another program, one of at least so many letters."""
    return out if out.is_terminal else Console(width=max(out.width, letters))


def say(text: str) -> None:
    """Print a sentence as it is."""
    out.print(text, markup=False, highlight=False, soft_wrap=True)


def wrote(folder: Path, paths: Sequence[Path]) -> None:
    """Print which files were written."""
    out.print(f"written to {folder}: {', '.join(path.name for path in paths)}", markup=False, highlight=False)


def warn(texts: Iterable[str], kind: str = "note") -> None:
    """Print what the user has to know beside the result."""
    for text in texts:
        err.print(f"{kind}: {text}", style="yellow", markup=False, highlight=False, soft_wrap=True)


def complain(text: str) -> None:
    """Print what failed."""
    err.print(text, style="red", markup=False, highlight=False, soft_wrap=True)


@contextmanager
def count_progress(title: str, total: int | None = None) -> Iterator[Any]:
    """Show a bar on the terminal that is told `(done, total)`."""
    with Progress(console=err, transient=True, disable=not err.is_terminal) as progress:
        task = progress.add_task(title, total=total)
        yield lambda done, total: progress.update(task, completed=done, total=total)


@contextmanager
def show_progress() -> Iterator[Any]:
    """Show on the terminal what is being done."""
    with err.status("reading") as status:
        yield status.update


def pairs(texts: list[str] | None, option: str, example: str) -> dict[str, Any]:
    """Read `KEY=VALUE` texts, the value as YAML.

    Raises:
        InputError: a text is no such pair.
    """
    values = {}
    for text in texts or []:
        key, sign, value = text.partition("=")
        if not sign or not key:
            raise InputError(f"{option} {text}: write KEY=VALUE, such as {option} {example}")
        try:
            values[key] = YAML(typ="safe").load(value)
        except YAMLError as error:
            raise InputError(f"{option} {text}: '{value}' is not a YAML value") from error
    return values
