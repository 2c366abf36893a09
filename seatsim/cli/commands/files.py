"""The commands on files: new, check, schema, describe, reproduce."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from seatsim.cli.options import check_out, complete, complete_kind
from seatsim.cli.terminal import answer, complain, refuse, say, show_progress, warn, wrote_one
from seatsim.schema.errors import InputError, permit

_NEW = ("scenario", "recording", "damper", "controller", "effect", "excitation")


def new(
    kind: Annotated[str, typer.Argument(autocompletion=complete(*_NEW))], name: Annotated[str, typer.Argument()]
) -> None:
    """Write a commented file that works as it stands, to be changed.

    Options:
        kind: scenario, recording, damper, controller, effect or excitation.
        name: Its name; a folder may stand before it.
    """
    from seatsim.cli.new_files import write_new
    from seatsim.cli.outputs.answers import NewAnswer
    from seatsim.schema.fields import read_packaged

    paths = write_new(kind, Path(name))
    say(f"written: {', '.join(map(str, paths))}")
    file = name if kind == "recording" else paths[0]
    following = read_packaged(Path(__file__).parents[1] / "templates" / "next.yaml", dict[str, str])
    say(f"next: {following[kind].format(name=Path(name).stem, file=file)}")
    answer(NewAnswer(kind), paths)


def check(file: Annotated[Path, typer.Argument()], run: Annotated[bool, typer.Option("--run")] = False) -> None:
    """Read a file as the other commands would, and say what is wrong or doubtful; it is run by --run alone.

    Options:
        file: A scenario, recording, sweep, damper, map of import, or Python file.
        run: Run the scenario, and see whether it meets what it states under 'checks'.
    """
    from seatsim.cli.check_files import CheckedFile, check_file, run_checks

    try:
        found = check_file(file)
    except InputError as error:
        refuse(error, everything=True)
        raise typer.Exit(error.exit_status) from error
    say(f"{file}: {found.kind}, no errors; {', '.join(found.holds)}")
    warn(found.warnings, "warning")
    with show_progress() as progress:
        progress("running the scenario" if run else "reading")
        checked = run_checks(file) if run else ()
    for one in checked:
        (say if one.figure.is_within else complain)(f"{'met' if one.figure.is_within else 'FAILED'}: {one}")
    answer(CheckedFile(file, found, checked))
    if not all(one.figure.is_within for one in checked):
        raise typer.Exit(1)


def _list_schemas() -> dict[str, Callable[[], Mapping[str, object]]]:
    """Return what makes each schema, by kind of file or command; `sweep` is both, and the command's bears `--json`."""
    from seatsim.cli.outputs.answers import FILES, describe_answer, list_answers

    answers = {f"{name} --json" if name in FILES else name: partial(describe_answer, name) for name in list_answers()}
    return {**FILES, **answers}


def _complete_schema(incomplete: str) -> list[str]:
    return complete(*_list_schemas())(incomplete)


def schema(kind: Annotated[str, typer.Argument(autocompletion=_complete_schema)] = "scenario") -> None:
    """Print a JSON Schema, with which an editor completes and checks a file.

    Options:
        kind: scenario, recording, sweep or parameters; or a command, for what its --json prints.
    """
    known = _list_schemas()
    if kind not in known:
        raise InputError(f"schema {kind}: no such kind{permit(kind, known)}")
    # A schema is JSON with or without --json.
    sys.stdout.write(json.dumps(known[kind]()) + "\n")


_ENDINGS = (".png", ".svg", ".pdf")


def describe(
    name: Annotated[str, typer.Argument(autocompletion=complete_kind("damper", "law", "excitation", "effect"))] = "",
    picture: Annotated[Path | None, typer.Option("--picture", metavar="FILE")] = None,
) -> None:
    """List dampers, laws, excitations and effects, or the keys of one of them with units and bounds.

    Options:
        name: A name, such as bouc_wen or road.
        picture: Draw the loops of a damper, as .png, .svg or .pdf.
    """
    from seatsim.scenario.describe import Pages, find_page, list_pages
    from seatsim.scenario.describe import describe as describe_name

    pages = [find_page(name)] if name else list_pages()
    if picture is not None and (not name or pages[0].kind != "damper" or picture.suffix not in _ENDINGS):
        raise InputError(
            f"--picture {picture}: one damper, as {', '.join(_ENDINGS)}: seatsim describe bouc_wen --picture loops.svg"
        )
    say(describe_name(name))
    if picture is not None:
        from seatsim.plots.loops import plot_model
        from seatsim.plots.saving import save_figure
        from seatsim.schema.files import write_whole

        wrote_one(write_whole(picture, partial(save_figure, plot_model(name))))
    answer(Pages(pages), [picture] if picture else [])


def reproduce(
    folder: Annotated[Path, typer.Argument(metavar="DIR", show_default=False)],
    out_folder: Annotated[Path | None, typer.Option("--out", callback=check_out)] = None,
    own_code: Annotated[list[Path] | None, typer.Option("--with", metavar="FILE.py")] = None,
) -> None:
    """Run again what made a folder, and compare the bytes: exit 0 identical, 1 different.

    Options:
        folder: Folder with a manifest.json.
        out_folder: Folder for reproduce.json, DIR by default.
        own_code: Own code that took part and may run again; repeatable.
    """
    from seatsim.provenance.reproduce import ANSWER
    from seatsim.provenance.reproduce import reproduce as run_again
    from seatsim.schema.files import write_json

    with show_progress() as progress:
        found = run_again(folder, own_code or [], progress)
    warn(found.versions, "version")
    for name, problem in found.differences:
        complain(f"{name}: {problem}")
    if found.identical:
        say(f"{folder}: identical to what seatsim {found.command} writes now: {', '.join(found.compared)}")
    path = write_json((out_folder or folder) / ANSWER, found)
    wrote_one(path)
    answer(found, [path])
    if not found.identical:
        raise typer.Exit(1)
