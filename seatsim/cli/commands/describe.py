"""The command that lists what can stand in a scenario: describe."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from seatsim.cli.options import Json, OwnCode
from seatsim.cli.terminal import answer, say, wrote_one
from seatsim.schema.errors import InputError

ENDINGS = (".png", ".svg", ".pdf")


def describe(
    name: Annotated[str, typer.Argument(help="A name, such as bouc_wen or road.")] = "",
    picture: Annotated[
        Path | None,
        typer.Option("--picture", metavar="FILE", help="Draw the loops of a damper, as .png, .svg or .pdf."),
    ] = None,
    own_code: OwnCode = None,
    as_json: Json = False,
) -> None:
    """List dampers, laws, excitations and effects, or the keys of one of them with units and bounds."""
    from seatsim.scenario.describe import describe as describe_name
    from seatsim.scenario.describe import find_page, list_pages

    pages = [find_page(name)] if name else list_pages()
    if picture is not None and (not name or pages[0].kind != "damper" or picture.suffix not in ENDINGS):
        raise InputError(
            f"--picture {picture}: one damper, as {', '.join(ENDINGS)}: seatsim describe bouc_wen --picture loops.svg"
        )
    say(describe_name(name))
    paths = _draw_loops(name, picture) if picture else []
    for path in paths:
        wrote_one(path)
    answer({"names": pages}, paths)


def _draw_loops(model: str, picture: Path) -> list[Path]:
    """Draw the loops of a damper as `seatsim characterise --model` does, and return the path of the picture."""
    from seatsim.characterisation.model_tests import characterise_model, choose_settings, load_specimen
    from seatsim.plots.bench.loops import plot_loops
    from seatsim.plots.saving import save_figure
    from seatsim.schema.files import write_whole

    tested = load_specimen(model, None)
    found = characterise_model(tested, choose_settings(tested))
    return [write_whole(picture, partial(save_figure, plot_loops(found)))]
