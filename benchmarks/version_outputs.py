"""What an installed version of seatsim writes for recordings and scenarios, kept so that nothing is computed twice."""

from __future__ import annotations

import os
import subprocess
import time
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

FAILURE = "failure.txt"
"""Written in place of outputs by a command that failed: its exit status and what it printed on standard error."""
FAILURES = (1, 2)
"""Exit statuses of a command that failed: a run failed, bad input. Others mean that it was ended from outside."""


class Version(NamedTuple):
    """An installed version: `seatsim`, its command; `folder`, where its outputs and its compiled code are kept."""

    seatsim: Path
    folder: Path


class Task(NamedTuple):
    """A command on one input: `name` of its output folder, arguments before `--out`, the file that marks it as done."""

    name: str
    arguments: tuple[str, ...]
    marker: str

    def is_done(self, version: Version) -> bool:
        """Whether the version's outputs, or its failure, are there already."""
        folder = version.folder / self.name
        return (folder / self.marker).exists() or (folder / FAILURE).exists()


def installed(python: Path, folder: Path) -> Version:
    """Return the version that an interpreter has, with its command beside the interpreter.

    The command, and not `python -m seatsim`, since that would import a `seatsim` folder of the working directory.

    Raises:
        SystemExit: there is no such command.
    """
    # Not resolved: the interpreter of a virtual environment is a link, and the command lies beside the link.
    command = python.absolute().parent / "seatsim"
    if not command.exists():
        raise SystemExit(f"there is no command 'seatsim' beside {python}: name the interpreter it is installed for")
    return Version(command, folder)


def diagnosis_tasks(folders: Iterable[Path]) -> list[Task]:
    """Return the diagnosis of every recording below the folders, each named `diagnoses/RECORDING`.

    Raises:
        SystemExit: two recordings have the same name.
    """
    recordings = sorted({path.parent.absolute() for folder in folders for path in folder.rglob("recording.yaml")})
    names = [recording.name for recording in recordings]
    if repeated := sorted({name for name in names if names.count(name) > 1}):
        raise SystemExit(f"recordings need different names: {', '.join(repeated)} is there more than once")
    return [Task(f"diagnoses/{r.name}", ("diagnose", str(r)), "diagnosis.json") for r in recordings]


def run_tasks(folder: Path) -> list[Task]:
    """Return the run of every scenario below a folder, each named `runs/` and its path with `-` for `/`.

    Files below a folder called `data` belong to scenarios and are none themselves.
    """
    home = folder.absolute().parent
    paths = sorted(path.relative_to(home) for path in folder.absolute().rglob("*.yaml"))
    scenarios = [path for path in paths if "data" not in path.parts]
    return [Task(f"runs/{'-'.join(s.parts)}", ("run", str(home / s)), "summary.json") for s in scenarios]


def compute(version: Version, task: Task) -> str:
    """Write the outputs of a task below the version's folder and return a line that says so.

    Raises:
        RuntimeError: the command was ended from outside, so that nothing can be kept.
    """
    out = version.folder / task.name
    finished = call(version, (*task.arguments, "--out", str(out)))
    if finished.returncode not in (0, *FAILURES):
        raise RuntimeError(f"{version.folder.name} {task.name}: ended with {finished.returncode}\n{finished.stderr}")
    if finished.returncode:
        out.mkdir(parents=True, exist_ok=True)
        # Paths of the two sides differ where nothing else does.
        said = finished.stderr.replace(str(version.folder), "").replace(str(version.seatsim.parent), "")
        (out / FAILURE).write_text(f"exit status {finished.returncode}\n{said}")
    return f"{version.folder.name} {task.name}: {'failed' if finished.returncode else 'done'}"


def seconds(version: Version, arguments: Sequence[str], out: Path) -> float:
    """Return the wall-clock time of a command in s; one that fails is an error.

    Raises:
        SystemExit: the command failed.
    """
    start = time.perf_counter()
    finished = call(version, (*arguments, "--out", str(out)))
    if finished.returncode:
        raise SystemExit(f"{' '.join(arguments)} failed in {version.folder.name}:\n{finished.stderr}")
    return time.perf_counter() - start


def call(version: Version, arguments: Sequence[str]) -> subprocess.CompletedProcess[str]:
    """Call a version's command and return what it printed."""
    # A PYTHONPATH would put the same source tree before both installed versions, and compiled code that two versions
    # share would let one wait for the other.
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    environment |= {"COLUMNS": "300", "SEATSIM_CACHE_DIR": str(version.folder / "cache")}
    return subprocess.run(
        [str(version.seatsim), *arguments], env=environment, capture_output=True, text=True, check=False
    )
