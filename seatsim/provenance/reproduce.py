"""Run again what made a folder, and compare the bytes.

A folder may be a stranger's. Nothing of its manifest reaches a shell; only commands of seatsim that write nowhere but
into the folder they are given are run, with their options checked by name, on inputs whose hashes are those that the
manifest states, into a temporary folder. Code that it names is run only where the user names it, too.
"""

import csv
import io
import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from seatsim.provenance import statement
from seatsim.provenance.statement import EXAMPLE, MANIFEST, REPEATABLE, Manifest, read_manifest, state_file
from seatsim.scenario.loading import EXAMPLES
from seatsim.schema.errors import InputError, RunError, permit
from seatsim.schema.guarded import expect, is_there, read_bytes, temporary_folder

_LARGEST = 2**32
"""Bytes of an input or an output."""


class Difference(NamedTuple):
    """What is not as it was: an input, an output or a piece of the user's own code, and how it differs."""

    path: str
    problem: str


def _refuse(folder: Path, problem: str) -> InputError:
    """Return the error of what a manifest states and may not."""
    return InputError(f"{folder / MANIFEST}: {problem}")


def compare_outputs(manifest: Manifest, folder: Path, found: Manifest, again: Path) -> Iterator[Difference]:
    """Yield files that are not as the manifest states, or not what the command writes now."""
    # Files that a sweep varies may be read by other processes; their hashes stand in its configuration.
    if found.configuration != manifest.configuration:
        yield Difference(MANIFEST, "the configuration of the sweep, or a file that it names, is another one")
    stated, made = {each.path: each for each in manifest.outputs}, {each.path for each in found.outputs}
    for name, each in stated.items():
        if Path(name).is_absolute() or ".." in Path(name).parts:
            raise _refuse(folder, f"output {name!r} lies outside its folder")
        if not (folder / name).is_file():
            yield Difference(name, "is not there any more")
            continue
        content = read_bytes(folder / name, _LARGEST, "a file that seatsim wrote")
        if state_file(name, content).sha256 != each.sha256:
            yield Difference(name, "was changed after it was written")
        if name not in made:
            yield Difference(name, "is not written any more")
        elif not _is_same(content, (again / name).read_bytes(), name, manifest.measured.get(name, ())):
            yield Difference(name, "differs")
    for name in made - stated.keys():
        yield Difference(name, "was not written before")


def _is_same(old: bytes, new: bytes, name: str, measured: Sequence[str]) -> bool:
    """Tell whether two files are the same, bytes alike but for what was measured in them."""
    if old == new or not measured:
        return old == new
    with expect(name, "file with measured times"):
        parts = []
        for text in (old.decode("utf-8"), new.decode("utf-8")):
            rows = [json.loads(text)] if name.endswith(".json") else csv.DictReader(io.StringIO(text))
            parts.append([{key: value for key, value in row.items() if key not in measured} for row in rows])
        return parts[0] == parts[1]


ANSWER = "reproduce.json"
"""File in which the command `reproduce` keeps what came of it."""


class Reproduction(NamedTuple):
    """What came of running a command again; `versions` says what differs of versions and platform."""

    command: str
    identical: bool
    compared: list[str]
    differences: list[Difference]
    versions: list[str]


def reproduce(
    folder: Path, own_code: Sequence[Path] = (), tell: Callable[[str], None] = lambda text: None
) -> Reproduction:
    """Run again what made a folder, where its inputs are as they were, and compare the files.

    Args:
        folder: holds `manifest.json`.
        own_code: files of the user's own that may be run.
        tell: is called with what is being done.

    Raises:
        InputError: there is no manifest, it states what is not permitted, or an input or own code is missing.
        RunError: the command failed.
    """
    manifest = read_manifest(folder)
    versions = list(_compare_versions(manifest))
    for text in versions:
        tell(text)
    arguments, directory = _check_arguments(manifest, folder), _find_directory(manifest, folder)
    _check_files(manifest, folder, directory)
    changed = [*_compare_inputs(manifest, folder), *_compare_code(manifest, own_code)]
    if changed:
        return Reproduction(manifest.command, False, [], changed, versions)
    with temporary_folder() as place:
        runs = f": {manifest.counts['runs']} runs" if manifest.counts else ""
        tell(f"running {manifest.command} again{runs}")
        again = _run(manifest.command, arguments, own_code, directory, place / manifest.folder)
        differences = list(compare_outputs(manifest, folder, read_manifest(again), again))
    compared = [each.path for each in manifest.outputs]
    return Reproduction(manifest.command, not differences, compared, differences, versions)


def _check_arguments(manifest: Manifest, folder: Path) -> list[str]:
    """Return the arguments, refused where one could do more than say what is computed."""
    command, arguments = manifest.command, manifest.arguments
    if command not in REPEATABLE:
        raise _refuse(folder, f"command {command!r} is not run again{permit(command, REPEATABLE)}")
    if "--" not in arguments:
        raise _refuse(folder, "its arguments have no '--' before the files")
    for text in arguments[: arguments.index("--")]:
        name = text.partition("=")[0]
        if name not in REPEATABLE[command]:
            permitted = ", ".join(sorted(REPEATABLE[command])) or "none"
            raise _refuse(folder, f"option {text!r} is not run again; permitted: {permitted}")
    return list(arguments)


def _check_files(manifest: Manifest, folder: Path, directory: Path) -> None:
    """Refuse a file or folder among the arguments that holds none of the inputs, whose hashes are known."""
    inputs = [_resolve(each.path, folder).resolve() for each in manifest.inputs]
    for text in manifest.arguments:
        for word in (text, text.partition("=")[2]):
            path = (directory / word).resolve()
            if word and is_there(path) and not any(each.is_relative_to(path) for each in inputs):
                raise _refuse(folder, f"{word!r} is there, but none of the inputs that it states")


def _find_directory(manifest: Manifest, folder: Path) -> Path:
    """Return the folder in which the command was started; that of the manifest where examples alone are read."""
    directory = _resolve(manifest.directory, folder)
    if directory.is_dir():
        return directory
    if all(each.path.startswith(EXAMPLE) for each in manifest.inputs):
        return folder
    raise InputError(f"{directory}: the folder in which the command was started is not there; move {folder} with it")


def _resolve(name: str, folder: Path) -> Path:
    """Return the path of an input that a manifest names; absolute paths, and those of other machines, are refused."""
    if name.startswith(EXAMPLE):
        inside = Path(name.removeprefix(EXAMPLE))
        found = [each / inside for each in EXAMPLES if ".." not in inside.parts and (each / inside).is_file()]
        return found[0] if found else EXAMPLES[0] / inside.name
    if Path(name).is_absolute() or name.startswith(("/", "\\")) or "\0" in name:
        raise _refuse(folder, f"{name!r} is an absolute path; permitted: one relative to the manifest")
    return folder.absolute() / name


def _compare_inputs(manifest: Manifest, folder: Path) -> Iterator[Difference]:
    for each in manifest.inputs:
        path = _resolve(each.path, folder)
        content = read_bytes(path, _LARGEST, f"the input {each.path}")
        if state_file(each.path, content).sha256 != each.sha256:
            yield Difference(each.path, "this input has changed")


def _compare_code(manifest: Manifest, own_code: Sequence[Path]) -> Iterator[Difference]:
    """Yield the own code that has changed; what the user does not name himself is never run."""
    given = {path.name: path for path in own_code}
    for each in manifest.own_code:
        name = Path(each.path).name
        if name not in given:
            raise InputError(
                f"{name}: this code of somebody's own took part, and is not run unless you name it; if you trust it:"
                f" --with {name}"
            )
        if state_file(name, read_bytes(given[name], _LARGEST, "own code")).sha256 != each.sha256:
            yield Difference(each.path, "this code has changed")


def _compare_versions(manifest: Manifest) -> Iterator[str]:
    now = {**statement.list_versions(), **statement.list_platform()}
    for name, was in {**manifest.versions, **manifest.platform}.items():
        # The own code of a sweep is among its sources.
        if name in now and was != now[name] and not (name == "sources" and manifest.own_code):
            yield f"{name} was {was} and is {now[name]}"


def _run(command: str, arguments: Sequence[str], own_code: Sequence[Path], directory: Path, out: Path) -> Path:
    """Run a command of seatsim, and return the folder of its files.

    That is `out`, or one of the same name in it where `run` has several scenarios, each with a folder. The command has
    a process of its own, which does not search the folder it starts in for modules.
    """
    code = [word for path in own_code for word in ("--with", str(path.absolute()))]
    words = [sys.executable, "-P", "-m", "seatsim", command, "--json", "--out", str(out), *code, *arguments]
    # What the process would leave behind in the middle goes with the folder.
    place = os.environ | {"TMPDIR": str(out.parent)}
    done = subprocess.run(words, cwd=directory, capture_output=True, stdin=subprocess.DEVNULL, check=False, env=place)
    for folder in (out, out / out.name):
        if (folder / MANIFEST).is_file():
            return folder
    said = done.stderr.decode(errors="replace").strip().splitlines()
    raise RunError(f"{command} cannot be run again: {said[-1].removeprefix('error: ') if said else 'no reason'}")
