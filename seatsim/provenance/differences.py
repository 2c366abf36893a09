"""What differs between the files of a folder and those that the same command writes now."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from seatsim.provenance.statement import MANIFEST, Manifest, state_file
from seatsim.schema.errors import InputError
from seatsim.schema.guarded import expect, read_bytes

LARGEST = 2**32
"""Bytes of an input or an output."""


class Difference(NamedTuple):
    """What is not as it was: an input, an output or a piece of the user's own code, and how it differs."""

    path: str
    problem: str


def compare_outputs(manifest: Manifest, folder: Path, found: Manifest, again: Path) -> Iterator[Difference]:
    """Yield files that are not as the manifest states, or not what the command writes now."""
    # Files that a sweep varies may be read by other processes; their hashes stand in its configuration.
    if found.configuration != manifest.configuration:
        yield Difference(MANIFEST, "the configuration of the sweep, or a file that it names, is another one")
    stated, made = {each.path: each for each in manifest.outputs}, {each.path for each in found.outputs}
    for name, each in stated.items():
        if Path(name).is_absolute() or ".." in Path(name).parts:
            raise InputError(f"{folder / MANIFEST}: output {name!r} lies outside its folder")
        if not (folder / name).is_file():
            yield Difference(name, "is not there any more")
            continue
        content = read_bytes(folder / name, LARGEST, "a file that seatsim wrote")
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
        return _without(old, name, measured) == _without(new, name, measured)


def _without(content: bytes, name: str, fields: Sequence[str]) -> object:
    """Return the content of a JSON or CSV file without some keys or columns."""
    text = content.decode("utf-8")
    rows = [json.loads(text)] if name.endswith(".json") else csv.DictReader(io.StringIO(text))
    return [{key: value for key, value in row.items() if key not in fields} for row in rows]
