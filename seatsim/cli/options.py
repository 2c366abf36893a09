"""Arguments and options that several commands share, and how `KEY=VALUE` is read."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Sequence
from functools import wraps
from pathlib import Path
from typing import Annotated, Any

import typer

from seatsim.cli.outputs.printing import choose_printer
from seatsim.cli.terminal import answer_as_json
from seatsim.schema.errors import InputError
from seatsim.schema.files import check_folder
from seatsim.schema.modules import use_all


def with_options(*common: str) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Return a decorator that gives a command the help that its docstring has below `Options:`, and common options.

    `--json` is one of every command's; `common` names others of `_COMMON`. They act while options are read, and the
    function of the command does not see them.
    """

    def decorate(command: Callable[..., None]) -> Callable[..., None]:
        text, _, listed = inspect.cleandoc(command.__doc__ or "").partition("\n\nOptions:\n")
        own = inspect.signature(command, eval_str=True).parameters
        for name, words in re.findall(r"^    (\w+): (.+(?:\n        .+)*)", listed, re.MULTILINE):
            own[name].annotation.__metadata__[0].help = " ".join(words.split())

        @wraps(command)
        def run(**given: object) -> None:
            command(**{name: given[name] for name in own})

        every = [*own.values(), *(_COMMON[name] for name in (*common, "as_json"))]
        run.__doc__, run.__annotations__ = text, {each.name: each.annotation for each in every}
        vars(run)["__signature__"] = inspect.Signature(every)
        return run

    return decorate


def _use_files(files: list[Path] | None) -> list[Path]:
    """Load the files while options are read, so that no command can forget them."""
    use_all(files or [])
    return files or []


def check_out(folder: Path | None) -> Path | None:
    """Refuse a folder that could not be written, while options are read and before anything runs."""
    try:
        check_folder(folder or Path("out"))
    except InputError as error:
        raise InputError(f"--out {error}") from error
    return folder


def _complete_key(ctx: typer.Context, incomplete: str) -> list[tuple[str, str]]:
    """Return the keys of the scenario on the command line that begin so, each with its meaning and unit."""
    from seatsim.scenario.loading import load
    from seatsim.scenario.numbers import list_keys

    named = ctx.params.get("scenarios") or [ctx.params.get("scenario") or "quickstart"]
    keys = list_keys(load(named[0])[0])
    # In brackets a unit would be taken for a mark of style.
    units = {key: f" ({each.unit})" if each.unit not in ("", "-") else "" for key, each in keys.items()}
    return [(f"{key}=", each.meaning + units[key]) for key, each in keys.items() if key.startswith(incomplete)]


def complete(*words: str) -> Callable[[str], list[str]]:
    """Return what completes one of some words in a shell."""
    return lambda incomplete: [word for word in words if word.startswith(incomplete)]


def complete_kind(*kinds: str) -> Callable[[str], list[str]]:
    """Return what completes a registered name of some kinds, such as `damper`, in a shell."""

    def found(incomplete: str) -> list[str]:
        from seatsim.schema.registry import names

        return complete(*(name for kind in kinds for name in names(kind)))(incomplete)

    return found


def _complete_scenario(incomplete: str) -> list[str]:
    """Return the examples, and the folders and YAML files of the typed folder, that begin so."""
    from seatsim.scenario.loading import list_examples

    near = [path for path in Path(incomplete + "*").parent.glob("*") if path.is_dir() or path.suffix == ".yaml"]
    return complete(*list_examples(), *(f"{path}/" if path.is_dir() else str(path) for path in near))(incomplete)


Out = Annotated[
    Path | None, typer.Option("--out", help="Folder for the files.", show_default="out/NAME", callback=check_out)
]
NewFolder = Annotated[
    Path, typer.Option("--out", help="Folder of the recordings.", show_default=False, callback=check_out)
]
_COMPLETED: dict[str, Any] = {"show_default": False, "autocompletion": _complete_scenario}
Scenarios = Annotated[list[str], typer.Argument(help="Scenario files, or names of examples.", **_COMPLETED)]
OneScenario = Annotated[str, typer.Argument(help="A scenario file, or the name of an example.", **_COMPLETED)]
RecordingFolder = Annotated[
    Path, typer.Argument(help="The folder of a recording: it holds recording.yaml.", show_default=False)
]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        autocompletion=_complete_key,
        help="Replace a value by dotted key, such as plant.driver_mass=55.",
    ),
]
OwnCode = Annotated[
    list[Path] | None,
    typer.Option(
        "--with",
        metavar="FILE.py",
        callback=_use_files,
        help="Run a file of your own, whose classes are then known by the names in their decorators; may be"
        " given several times.",
    ),
]
_Pdf = Annotated[
    bool,
    typer.Option(
        "--pdf",
        callback=choose_printer,
        help="Print report.html to report.pdf, too, by a browser of this machine or WeasyPrint.",
    ),
]
_Json = Annotated[
    bool,
    # Eager, so that an error in another option is an object, too.
    typer.Option("--json", is_eager=True, callback=answer_as_json, help="Print one JSON object and nothing else."),
]
_COMMON = {
    name: inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=hint)
    for name, hint, default in (("own_code", OwnCode, None), ("pdf", _Pdf, False), ("as_json", _Json, False))
}
"""Options that act while options are read."""


def scenario_settings(texts: Sequence[str] | None) -> dict[str, object]:
    """Read the values of `--set`."""
    return pairs(texts, "--set", "plant.driver_mass=55")


def pairs(texts: Sequence[str] | None, option: str, example: str) -> dict[str, object]:
    """Read `KEY=VALUE` texts, the value as YAML.

    Raises:
        InputError: a text is no such pair.
    """
    from seatsim.schema.yaml_text import YamlError, parse_value

    values: dict[str, object] = {}
    for text in texts or []:
        key, sign, value = text.partition("=")
        if not sign or not key:
            raise InputError(f"{option} {text}: write KEY=VALUE, such as {option} {example}")
        try:
            values[key] = parse_value(value)
        except YamlError as error:
            raise InputError(f"{option} {text}: '{value}' is not a YAML value: {error}") from error
    return values
