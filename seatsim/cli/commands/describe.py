"""The command that lists what can stand in a scenario: describe."""

from __future__ import annotations

from typing import Annotated

import typer

from seatsim.cli.options import OwnCode
from seatsim.cli.terminal import say


def describe(
    name: Annotated[str, typer.Argument(help="A name, such as bouc_wen or road.")] = "", own_code: OwnCode = None
) -> None:
    """List dampers, laws, excitations and effects, or the keys of one of them with units and bounds."""
    from seatsim.scenario.describe import describe as describe_name

    say(describe_name(name))
