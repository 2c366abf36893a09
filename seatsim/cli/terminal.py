"""What every command says on the terminal: sentences, the files written, notes, failures, progress."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console
from rich.progress import Progress

out = Console()
err = Console(stderr=True)

Report = Callable[[str], None]
"""Is called with what is being done."""
Count = Callable[[int, int], None]
"""Is called with how many are done, and of how many."""


def wide(letters: int) -> Console:
    """Return the console; where it is a file, or another program, one of at least so many letters."""
    return out if out.is_terminal else Console(width=max(out.width, letters))


def say(text: str) -> None:
    """Print a sentence as it is."""
    out.print(text, markup=False, highlight=False, soft_wrap=True)


def wrote(folder: Path, paths: Sequence[Path]) -> None:
    """Print which files were written."""
    out.print(f"written to {folder}: {', '.join(path.name for path in paths)}", markup=False, highlight=False)


def wrote_one(path: Path) -> None:
    """Print which file was written."""
    out.print(f"written: {path}", markup=False, highlight=False)


def warn(texts: Iterable[str], kind: str = "note") -> None:
    """Print what the user has to know about the result."""
    for text in texts:
        err.print(f"{kind}: {text}", style="yellow", markup=False, highlight=False, soft_wrap=True)


def complain(text: str) -> None:
    """Print what failed."""
    err.print(text, style="red", markup=False, highlight=False, soft_wrap=True)


@contextmanager
def count_progress(title: str, total: int | None = None) -> Iterator[Count]:
    """Show a bar on the terminal."""
    with Progress(console=err, transient=True, disable=not err.is_terminal) as progress:
        task = progress.add_task(title, total=total)
        yield lambda done, total: progress.update(task, completed=done, total=total)


@contextmanager
def show_progress() -> Iterator[Report]:
    """Show on the terminal what is being done."""
    with err.status("reading") as status:
        yield status.update
