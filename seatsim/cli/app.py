"""The command line: which commands there are, and what becomes of an error."""

from __future__ import annotations

import errno
import os
import sys
import traceback
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import chain
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from seatsim.cli.commands.blind import blind
from seatsim.cli.commands.files import check, describe, new, reproduce, schema
from seatsim.cli.commands.recordings import (
    characterise,
    comfort,
    diagnose,
    gap,
    identify,
    import_data,
    inspect_data,
    seat_test,
)
from seatsim.cli.commands.runs import compare, explore, export, run, sweep, sweep_report, synthesise
from seatsim.cli.options import with_options
from seatsim.cli.terminal import answer_as_json, answer_error, fail, print_any_letter, refuse, say, warn
from seatsim.compilation.messages import explain, is_compilation
from seatsim.schema.errors import InputError, SeatsimError

_UsageError: Any = typer.BadParameter.__bases__[0]
"""What is raised for options and arguments that a command does not have, before any of them is read."""
TRACEBACK = "SEATSIM_TRACEBACK"
"""Set in the environment, it lets Python print what led to an error that was not foreseen."""


class _Command(TyperCommand):
    """A command that a manifest can state: with the options that were given, and what it reads."""

    def invoke(self, ctx: Any) -> object:
        from seatsim.provenance.statement import at_work

        options: list[tuple[str, object]] = []
        operands: list[object] = []
        for parameter in self.get_params(ctx):
            value = ctx.params.get(parameter.name)
            values = value if isinstance(value, list | tuple) else [] if value in (None, False) else [value]
            if parameter.param_type_name == "argument":
                operands += values
            elif ctx.get_parameter_source(parameter.name).name == "COMMANDLINE":
                options += [(parameter.opts[0], each) for each in values]
        with at_work(self.name or "", options, operands):
            return super().invoke(ctx)


class _Commands(TyperGroup):
    """The commands; what is wrong with their options is one object where `--json` stands among them."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        answer_as_json("--json" in args)
        return super().parse_args(ctx, args)

    def make_context(self, *arguments: Any, **options: Any) -> Any:
        with _interrupts_said():
            return super().make_context(*arguments, **options)

    def invoke(self, ctx: Any) -> object:
        try:
            with _interrupts_said():
                return super().invoke(ctx)
        except _UsageError as error:
            answer_error(error.format_message())
            raise


@contextmanager
def _interrupts_said() -> Iterator[None]:
    """Say that a command is interrupted, which typer would not."""
    try:
        yield
    except KeyboardInterrupt:
        fail("interrupted")
        raise typer.Exit(130) from None


app = typer.Typer(
    cls=_Commands,
    help="Simulate semi-active MR-damper seats and compare what is done to them.",
    invoke_without_command=True,
    pretty_exceptions_enable=False,
)
_GROUPS: tuple[tuple[Callable[..., None], ...], ...] = (
    (run, compare, sweep, sweep_report, synthesise),
    (gap, diagnose, characterise, identify, describe),
    (comfort, seat_test, export),
    (new, check, schema, explore, reproduce),
)
_REPORTED = (run, compare, sweep_report, gap, diagnose, characterise, identify, comfort, seat_test)
"""Commands that write a report."""
_WITHOUT_CODE = (sweep, sweep_report, comfort, new, reproduce)
"""Commands that run none of the user's own code, or take more than note of it."""
for command in chain.from_iterable(_GROUPS):
    common = ["own_code"] * (command not in _WITHOUT_CODE) + ["pdf"] * (command in _REPORTED)
    app.command(cls=_Command)(with_options(*common)(command))
app.command("import", cls=_Command)(with_options("own_code")(import_data))
app.command("inspect")(with_options("own_code")(inspect_data))
app.add_typer(blind, name="blind")


def _show_version(wanted: bool) -> None:
    if wanted:
        import seatsim

        typer.echo(f"seatsim {seatsim.__version__}")
        raise typer.Exit


_START = """\
Three things to try:
  seatsim run quickstart        simulate an example: a table, pictures, a report
  seatsim explore               move the sliders of a seat on a page, and see what follows
  seatsim new recording my-rig  write a small measured recording; `seatsim diagnose my-rig` says what its gap is due to
seatsim --help lists all commands, seatsim COMMAND --help the options of one."""


@app.callback()
def _seatsim(
    context: typer.Context,
    version: Annotated[
        bool, typer.Option("--version", is_eager=True, callback=_show_version, help="Print the version.")
    ] = False,
) -> None:
    """Simulate semi-active MR-damper seats and compare what is done to them."""
    if context.invoked_subcommand is None:
        say(_START)


def main() -> None:
    """Run the command line: exit 0 done, 1 a run failed, 2 bad input (nothing written)."""
    print_any_letter()
    # Python would print a line of seatsim's own code with each warning, and no color.
    warnings.showwarning = lambda message, *_, **__: warn([str(message)], "warning")
    try:
        for name in (".numba_config.yaml", "matplotlibrc"):
            # The folder may be a stranger's, and libraries obey what lies there: the one can name a folder of compiled
            # code, the other a preamble of TeX.
            if Path(name).exists():
                raise InputError(f"{name}: changes how libraries work in this folder; start seatsim in another one")
        app(prog_name="seatsim")
    except SeatsimError as error:
        refuse(error)
        sys.exit(error.exit_status)
    except KeyboardInterrupt:
        fail("interrupted")
        sys.exit(130)
    except MemoryError as error:
        fail(f"the memory is exhausted ({error}); shorten the run, raise solver.step, or split the files")
        sys.exit(1)
    except OSError as error:
        fail(f"{error.filename or 'a file'}: {error.strerror or error}")
        # A name that no file can have is bad input, wherever it was tried first.
        sys.exit(2 if error.errno == errno.ENAMETOOLONG else 1)
    except Exception as error:
        if os.environ.get(TRACEBACK):
            raise
        fail(_describe_fault(error))
        sys.exit(1)


def _describe_fault(error: Exception) -> str:
    """Say where what nobody foresaw went wrong, in place of a traceback."""
    if is_compilation(error):
        return f"own code: {explain(error)}; seatsim check tries a file of your own"
    last = traceback.extract_tb(error.__traceback__)[-1]
    said = str(error).split("\n")[0]
    return (
        f"seatsim failed at what it does not foresee: {type(error).__name__}: {said} ({Path(last.filename).name}, line"
        f" {last.lineno}); please report the command with its files; {TRACEBACK}=1 shows the whole traceback"
    )
