"""The commands for those who write files: new, check, schema."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated

import typer

from seatsim.cli.options import Json, OwnCode
from seatsim.cli.terminal import answer, refuse, say, warn
from seatsim.schema.errors import InputError, nearest

NEXT = {
    "scenario": "seatsim run {file}",
    "recording": "seatsim check {file}, then seatsim diagnose {file}",
    "damper": "seatsim describe {name} --with {file} --picture loops.png, then model: {name} in a scenario",
    "controller": "law: {name} in a scenario, then seatsim run SCENARIO --with {file}",
    "effect": "effect: suspension.{name} in a scenario, then seatsim run SCENARIO --with {file}",
    "excitation": "kind: {name} in a scenario, then seatsim run SCENARIO --with {file}",
}
"""What can be done with a new file."""


def new(
    kind: Annotated[str, typer.Argument(help="scenario, recording, damper, controller, effect or excitation.")],
    name: Annotated[str, typer.Argument(help="Its name; a folder may stand before it.")],
    as_json: Json = False,
) -> None:
    """Write a commented file that works as it stands, to be changed."""
    from seatsim.cli.outputs.new_files import write_new

    paths = write_new(kind, Path(name))
    say(f"written: {', '.join(map(str, paths))}")
    file = name if kind == "recording" else paths[0]
    say(f"next: {NEXT[kind].format(name=Path(name).stem, file=file)}")
    answer({"kind": kind}, paths)


def check(
    file: Annotated[Path, typer.Argument(help="A scenario, recording, sweep, damper, map of import, or Python file.")],
    own_code: OwnCode = None,
    as_json: Json = False,
) -> None:
    """Read a file as the other commands would, without running it, and say what is wrong or doubtful."""
    from seatsim.cli.check_files import check_file

    try:
        found = check_file(file)
    except InputError as error:
        refuse(error, everything=True)
        raise typer.Exit(error.exit_status) from error
    say(f"{file}: {found.kind}, no errors; {', '.join(found.holds)}")
    warn(found.warnings, "warning")
    answer({"file": str(file), **found._asdict()})


def schema(
    kind: Annotated[
        str, typer.Argument(help="scenario, recording, sweep or parameters; or a command, for what its --json prints.")
    ] = "scenario",
    own_code: OwnCode = None,
    as_json: Json = False,
) -> None:
    """Print a JSON Schema, with which an editor completes and checks a file."""
    from seatsim.cli.outputs.answers import ANSWERS, answer_schema
    from seatsim.cli.outputs.schemas import FILES

    if kind not in {**FILES, **ANSWERS}:
        known = ", ".join([*FILES, *ANSWERS])
        raise InputError(f"schema {kind}: no such kind{nearest(kind, [*FILES, *ANSWERS])}; permitted: {known}")
    found = FILES[kind]() if kind in FILES else answer_schema(kind)
    # A schema is JSON with or without --json.
    sys.stdout.write(json.dumps(found) + "\n")
