"""What differs between the files of a folder and those that the same command writes now."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from seatsim.provenance.invocation import digest
from seatsim.provenance.manifest import MANIFEST
from seatsim.schema.errors import InputError
from seatsim.schema.guarded import expect, read_bytes

LARGEST = 2**32
"""Bytes of an input or an output."""


class Difference(NamedTuple):
    """What is not as it was: an input, an output or a piece of the user's own code, and how it differs."""

    path: str
    problem: str


def compare_outputs(
    manifest: Mapping[str, Any], folder: Path, found: Mapping[str, Any], again: Path
) -> Iterator[Difference]:
    """Yield files that are not as the manifest states, or not what the command writes now."""
    made = {each["path"]: each["sha256"] for each in found["outputs"]}
    # Files that a sweep varies may be read by other processes; their hashes stand in its configuration.
    if found.get("configuration") != manifest.get("configuration"):
        yield Difference(MANIFEST, "the configuration of the sweep, or a file that it names, is another one")
    for each in manifest["outputs"]:
        name, fields = each["path"], manifest["measured"].get(each["path"], [])
        if Path(name).is_absolute() or ".." in Path(name).parts:
            raise InputError(f"{folder / MANIFEST}: output {name!r} lies outside its folder")
        if not (folder / name).is_file():
            yield Difference(name, "is not there any more")
            continue
        content = read_bytes(folder / name, LARGEST, "a file that seatsim wrote")
        if digest(content).sha256 != each["sha256"]:
            yield Difference(name, "was changed after it was written")
        if name not in made:
            yield Difference(name, "is not written any more")
        elif not _is_same(content, (again / name).read_bytes(), name, fields):
            yield Difference(name, "differs")
    for name in made.keys() - {each["path"] for each in manifest["outputs"]}:
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
    if name.endswith(".json"):
        return {key: value for key, value in json.loads(text).items() if key not in fields}
    rows = csv.DictReader(io.StringIO(text))
    return [{key: value for key, value in row.items() if key not in fields} for row in rows]
