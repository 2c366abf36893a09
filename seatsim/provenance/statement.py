"""What a manifest states: the command that made a folder, its inputs and files by hash, versions and platform."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple, cast

from pydantic import ValidationError

from seatsim.schema.content import IfAny
from seatsim.schema.errors import InputError
from seatsim.schema.fields import validated
from seatsim.schema.guarded import expect, is_there, read_json
from seatsim.schema.text import explain_bad_name

MANIFEST = "manifest.json"
KIND = "manifest of a command of seatsim"


class StatedFile(NamedTuple):
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
    own_code: Sequence[StatedFile]
    inputs: Sequence[StatedFile]
    outputs: Sequence[StatedFile]
    measured: Mapping[str, Sequence[str]]
    seed: int | None = None
    configuration: IfAny[Mapping[str, object] | None] = None
    counts: IfAny[Mapping[str, int] | None] = None


def state_file(path: str, content: bytes) -> StatedFile:
    """Return what a manifest states of a file."""
    return StatedFile(path, hashlib.sha256(content).hexdigest(), len(content))


def read_manifest(folder: Path) -> Manifest:
    """Return the manifest of a folder.

    Raises:
        InputError: there is none, it is not one that `seatsim` writes, or its sweep is not complete.
    """
    path = folder / MANIFEST
    if within := sorted(each.parent.as_posix() for each in folder.glob(f"*/{MANIFEST}")) if not is_there(path) else []:
        raise InputError(f"{path}: is not there; folders in it have one each: 'seatsim reproduce {within[0]}'")
    content = cast("Mapping[str, object]", read_json(path, KIND))
    with expect(path, KIND):
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
        raise InputError(f"{path}: is no {KIND}: {place} {problem}") from None
    if found.counts and found.counts["pending"]:
        left = found.counts["pending"]
        raise InputError(f"{folder}: {left} runs of this sweep are missing; go on with it with --resume first")
    if problem := explain_bad_name(found.folder):
        raise InputError(f"{path}: folder {found.folder!r} {problem}")
    return found
