"""The files that `seatsim new` writes, from the templates beside the commands."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from seatsim.cli.outputs.answers import FILES
from seatsim.scenario.loading import EXAMPLES
from seatsim.schema.errors import InputError, permit
from seatsim.schema.files import write_bytes, write_together
from seatsim.schema.registry import names

_TEMPLATES = Path(__file__).with_name("templates")
REGISTERED = {"damper": "damper", "controller": "law", "effect": "effect", "excitation": "excitation"}
"""Kinds that are Python files, and what their classes are registered as."""
KINDS = ("scenario", "recording", *REGISTERED)
_COPIED = ("nominal.yaml", "run-1.csv.gz", "run-2.csv.gz")
"""Files of the recording that comes with seatsim."""


def write_new(kind: str, path: Path) -> list[Path]:
    """Write the files of a new scenario, recording, damper, controller, effect or excitation; return their paths.

    The last part of the path is the name, with or without its ending. Nothing that is there is replaced.

    Raises:
        InputError: there is no such kind, the name cannot be used or is taken, or a file cannot be written.
    """
    if kind not in KINDS:
        raise InputError(f"new {kind}: no such kind{permit(kind, KINDS)}")
    contents = _code(kind, path) if kind in REGISTERED else _recording(path) if kind == "recording" else _scenario(path)
    for file in contents:
        if file.exists():
            raise InputError(f"{file}: is there already, and is not replaced; give another name")
    folder = path if kind == "recording" else path.parent
    return write_together(folder, lambda part: [write_bytes(part / file.name, contents[file]) for file in contents])


def _scenario(path: Path) -> Mapping[Path, bytes]:
    text = (_TEMPLATES / "scenario.yaml").read_text(encoding="utf-8").replace("my-seat", path.stem)
    files = {path.with_suffix(".yaml"): text.encode()}
    schema = path.with_name("scenario.schema.json")
    return files if schema.exists() else files | {schema: _schema("scenario")}


def _recording(path: Path) -> Mapping[Path, bytes]:
    example = next(folder for folder in EXAMPLES if folder.is_dir()) / "data" / "recording"
    files = {path / name: (example / name).read_bytes() for name in _COPIED}
    files[path / "recording.yaml"] = (_TEMPLATES / "recording.yaml").read_bytes()
    return files | {path / "recording.schema.json": _schema("recording")}


def _code(kind: str, path: Path) -> Mapping[Path, bytes]:
    name = path.name.removesuffix(".py")
    if not name.isidentifier():
        problem = f"'{name}' cannot be the name of a module; letters, digits and _ can, such as my_{kind}"
        raise InputError(f"{path}: {problem}")
    taken = [known.rpartition(".")[2] for known in names(REGISTERED[kind])]
    if name in taken:
        raise InputError(f"{path}: there is a {REGISTERED[kind]} called '{name}' already; give another name")
    text = (_TEMPLATES / f"{kind}.py").read_text(encoding="utf-8")
    cls = "".join(word[:1].upper() + word[1:] for word in name.split("_"))
    text = text.replace(f"my_{kind}", name).replace(f"My{kind.capitalize()}", cls)
    return {path.with_suffix(".py"): text.encode()}


def _schema(kind: str) -> bytes:
    return (json.dumps(FILES[kind]()) + "\n").encode()
