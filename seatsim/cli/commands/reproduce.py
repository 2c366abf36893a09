"""The command that runs again what made a folder: reproduce."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from seatsim.cli.options import Json, check_out
from seatsim.cli.terminal import answer, complain, say, show_progress, warn, wrote_one


def reproduce(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder with a manifest.json.", show_default=False)],
    out_folder: Annotated[
        Path | None, typer.Option("--out", help="Folder for reproduce.json, DIR by default.", callback=check_out)
    ] = None,
    own_code: Annotated[
        list[Path] | None,
        typer.Option("--with", metavar="FILE.py", help="Own code that took part and may run again; repeatable."),
    ] = None,
    as_json: Json = False,
) -> None:
    """Run again what made a folder, and compare the bytes: exit 0 identical, 1 different."""
    from seatsim.provenance.reproduce import ANSWER
    from seatsim.provenance.reproduce import reproduce as run_again
    from seatsim.schema.files import write_json
    from seatsim.schema.text import join_names

    with show_progress() as progress:
        found = run_again(folder, own_code or [], progress)
    warn(found.versions, "version")
    for name, problem in found.differences:
        complain(f"{name}: {problem}")
    if found.unnamed:
        warn([f"no manifest names {join_names(found.unnamed)}: nothing is known of what made them"])
    if found.identical:
        say(f"{folder}: identical to what seatsim {found.command} writes now: {', '.join(found.compared)}")
    path = write_json((out_folder or folder) / ANSWER, found)
    wrote_one(path)
    answer(found, [path])
    if not found.identical:
        raise typer.Exit(1)
