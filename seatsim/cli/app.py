"""The command line: which commands there are, and what becomes of an error."""

from __future__ import annotations

import shlex
import sys

import typer

from seatsim.cli.commands.blind import blind
from seatsim.cli.commands.dampers import characterise, identify
from seatsim.cli.commands.describe import describe
from seatsim.cli.commands.recordings import diagnose, gap
from seatsim.cli.commands.runs import compare, run
from seatsim.cli.commands.synthesis import synthesise
from seatsim.cli.terminal import complain, err
from seatsim.schema.errors import SeatsimError
from seatsim.schema.modules import MissingModuleError

app = typer.Typer(
    help="Simulate semi-active MR-damper seats and compare what is done to them.",
    no_args_is_help=True, add_completion=False, pretty_exceptions_enable=False,
)  # fmt: skip
for command in (run, compare, synthesise, gap, diagnose, characterise, identify, describe):
    app.command()(command)
app.add_typer(blind, name="blind")


def main() -> None:
    """Run the command line: exit 0 done, 1 a run failed, 2 bad input (nothing written)."""
    try:
        app()
    except SeatsimError as error:
        complain(f"error: {error}")
        _show_command_with_file(error)
        sys.exit(error.exit_status)
    except KeyboardInterrupt:
        err.print("interrupted")
        sys.exit(130)


def _show_command_with_file(error: BaseException) -> None:
    """Print this command with `--with FILE`, where a module is missing whose file lies where it is named."""
    cause: BaseException | None = error
    while cause is not None and not isinstance(cause, MissingModuleError):
        cause = cause.__cause__
    if cause is not None and cause.file is not None:
        words = ["seatsim", *sys.argv[1:], "--with", str(cause.file)]
        complain(f"if you trust that file: {shlex.join(words)}")
