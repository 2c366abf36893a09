"""The command that opens a local page: explore."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from seatsim.cli.options import Json, OwnCode
from seatsim.cli.terminal import announce
from seatsim.schema.errors import InputError

EXTRA = 'the page needs an extra; install it with: pip install "seatsim[page]"'


def explore(
    target: Annotated[
        str, typer.Argument(metavar="[SCENARIO|RECORDING]", help="A scenario, an example, or a recording's folder.")
    ] = "quickstart",
    port: Annotated[
        int, typer.Option("--port", min=0, max=65535, help="Port of loopback.", show_default="a free one")
    ] = 0,
    no_browser: Annotated[bool, typer.Option("--no-browser", help="Print the address and open no browser.")] = False,
    own_code: OwnCode = None,
    as_json: Json = False,
) -> None:
    """Open a page on this machine: move driver, temperature, road and controller, or effects, and see what follows."""
    try:
        from seatsim.page.serve import find_target, serve
    except ModuleNotFoundError as error:
        if error.name is None or error.name.partition(".")[0] not in ("starlette", "uvicorn"):
            raise
        raise InputError(EXTRA) from error
    path = Path(target)
    folder = path if path.is_dir() else path.parent if path.exists() else Path()
    serve(find_target(path), folder, port, not no_browser, announce)
