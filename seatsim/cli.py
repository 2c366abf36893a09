"""The command line."""

from __future__ import annotations

import itertools
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.progress import Progress
from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError

from seatsim.errors import InputError, SeatsimError

if TYPE_CHECKING:
    from seatsim.result import Run
    from seatsim.scenario import Scenario

app = typer.Typer(
    help="Simulate semi-active MR-damper seats and compare what is done to them.",
    no_args_is_help=True, add_completion=False, pretty_exceptions_enable=False,
)  # fmt: skip
out = Console()
err = Console(stderr=True)

Scenarios = Annotated[list[str], typer.Argument(help="Scenario files, or names of examples.", show_default=False)]
OneScenario = Annotated[str, typer.Argument(help="A scenario file, or the name of an example.", show_default=False)]
Out = Annotated[Path | None, typer.Option("--out", help="Folder for the files.", show_default="out/NAME")]
Settings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Replace a value by dotted key, such as plant.driver_mass=55."),
]


def main() -> None:
    """Run the command line: exit 0 done, 1 a run failed, 2 bad input (nothing written)."""
    try:
        app()
    except SeatsimError as error:
        err.print(f"error: {error}", style="red", markup=False, highlight=False, soft_wrap=True)
        sys.exit(error.exit_status)
    except KeyboardInterrupt:
        err.print("interrupted")
        sys.exit(130)


@app.command()
def run(scenarios: Scenarios, out_folder: Out = None, settings: Settings = None) -> None:
    """Simulate scenarios and print a table for each."""
    several = out_folder is not None and len(scenarios) > 1
    folders = [out_folder / Path(path).stem if several and out_folder else out_folder for path in scenarios]
    _execute([[path] for path in scenarios], folders, _settings(settings))


@app.command()
def compare(scenarios: Scenarios, out_folder: Out = None, settings: Settings = None) -> None:
    """Simulate scenarios and print one table over all of them."""
    _execute([scenarios], [out_folder], _settings(settings))


@app.command()
def synthesise(scenario: OneScenario, out_folder: Out = None, settings: Settings = None) -> None:
    """Synthesise the H-infinity static output feedback of a scenario's plant and weights."""
    from seatsim.replay import single
    from seatsim.synthesis import design_for, report

    chosen = single(scenario, _settings(settings))
    design = design_for(chosen)
    out.print(report(design))
    folder = out_folder or Path("out") / chosen.name
    design.save(folder / "design.yaml")
    out.print(f"written: {folder / 'design.yaml'}", markup=False, highlight=False)


@app.command()
def gap(scenario: OneScenario, recording: Path, out_folder: Out = None) -> None:
    """Replay a scenario against a recording and print the gap beside the noise floor."""
    from seatsim.files import write_json
    from seatsim.replay import gap as find_gap
    from seatsim.replay import report

    found = find_gap(scenario, recording)
    out.print(report(found))
    path = write_json((out_folder or Path("out") / f"gap-{Path(recording).name}") / "gap.json", found.as_dict())
    out.print(f"written: {path}", markup=False, highlight=False)


@app.command()
def diagnose(
    recording: Path,
    out_folder: Out = None,
    without: Annotated[
        list[str] | None, typer.Option("--without", metavar="EFFECT", help="Withhold an effect from the library.")
    ] = None,
) -> None:
    """Say where the gap between a recording and its nominal scenario lies, what causes it and how far it shrinks."""
    from seatsim.diagnosis.diagnose import diagnose as find_cause
    from seatsim.diagnosis_output import tables, write_diagnosis
    from seatsim.registry import find

    withheld = without or []
    for name in withheld:
        find("effect", name)
    with _told() as tell:
        diagnosis = find_cause(recording, withheld, tell)
    for table in tables(diagnosis):
        out.print(table)
    for note in diagnosis.notes:
        err.print(f"note: {note}", style="yellow", markup=False, highlight=False, soft_wrap=True)
    out.print(diagnosis.sentence, markup=False, highlight=False, soft_wrap=True)
    folder = out_folder or Path("out") / f"diagnosis-{Path(recording).resolve().name}"
    paths = write_diagnosis(diagnosis, folder)
    out.print(f"written to {folder}: {', '.join(path.name for path in paths)}", markup=False, highlight=False)


@app.command()
def characterise(
    data: Annotated[Path | None, typer.Argument(help="A bench table, or a folder of them.", show_default=False)] = None,
    out_folder: Out = None,
    model: Annotated[str | None, typer.Option("--model", help="A damper model, in place of data.")] = None,
    parameters: Annotated[
        Path | None, typer.Option("--parameters", help="A file with a damper, in place of data.")
    ] = None,
    currents: Annotated[str, typer.Option("--currents", metavar="A,A", help="Currents of a model's tests.")] = "",
    temperatures: Annotated[str, typer.Option("--temperatures", metavar="C,C", help="Temperatures in degC.")] = "",
    amplitudes: Annotated[str, typer.Option("--amplitudes", metavar="M,M", help="Amplitudes in m.")] = "",
    frequencies: Annotated[str, typer.Option("--frequencies", metavar="HZ,HZ", help="Frequencies.")] = "",
) -> None:
    """Show what a bench shows of a damper: loops, energy, asymmetry, offset and response times."""
    from seatsim.bench_tables import load_bench
    from seatsim.characterisation.of_model import characterise_model, settings_of, specimen
    from seatsim.characterisation.summary import characterise as of_records
    from seatsim.characterisation_output import remarks, tables, write_characterisation

    grid = (currents, temperatures, amplitudes, frequencies)
    if (data is None) == (model is None and parameters is None) or (data is not None and any(grid)):
        raise InputError("characterise either DATA, or a model by --model or --parameters with its tests; see --help")
    if data is not None:
        found = of_records(load_bench(data), data.resolve().name.split(".")[0], str(data))
    else:
        tested = specimen(model, parameters)
        found = characterise_model(tested, settings_of(tested, *grid))
    for table in tables(found):
        out.print(table)
    for note in remarks(found):
        err.print(f"note: {note}", style="yellow", markup=False, highlight=False, soft_wrap=True)
    folder = out_folder or Path("out") / f"characterise-{found.name}"
    paths = write_characterisation(found, folder)
    out.print(f"written to {folder}: {', '.join(path.name for path in paths)}", markup=False, highlight=False)


@app.command()
def identify(
    data: Annotated[Path, typer.Argument(help="A bench table, or a folder of them.")],
    model: Annotated[str, typer.Option("--model", help="A damper model, or all for the league.")],
    test: Annotated[
        list[str] | None, typer.Option("--test", metavar="GLOB", help="Hold out the files whose names match.")
    ] = None,
    test_fraction: Annotated[
        float, typer.Option("--test-fraction", help="Hold out the last part of each record.")
    ] = 0.0,
    fix: Annotated[
        list[str] | None, typer.Option("--fix", metavar="NAME=VALUE", help="Keep a parameter at a value.")
    ] = None,
    ignore_temperature: Annotated[bool, typer.Option("--ignore-temperature", help="Do not fit its influence.")] = False,
    further: Annotated[
        list[Path] | None, typer.Option("--predict", metavar="DATA", help="Predict further records, not fitted.")
    ] = None,
    moving_average: Annotated[
        float, typer.Option("--moving-average", metavar="S", help="Average that the predicted records went through.")
    ] = 0.0,
    centred: Annotated[bool, typer.Option("--centred", help="The predicted records' mean force was removed.")] = False,
    seed: Annotated[int, typer.Option("--seed", help="Seed of the global search.")] = 0,
    out_folder: Out = None,
) -> None:
    """Fit a damper model to bench records and judge it on records held out; or every model, as a league."""
    from seatsim.bench_tables import load_bench
    from seatsim.identification.identify import Request, identify_records, predict
    from seatsim.identification.league import league
    from seatsim.identification_output import league_table, tables, write_identification, write_league
    from seatsim.registry import find

    request = Request(tuple(test or ()), test_fraction, _settings(fix, "--fix"), ignore_temperature, seed)
    folder = out_folder or Path("out") / f"identify-{data.resolve().name.split('.')[0]}-{model}"
    records = load_bench(data)

    def keep(found: Any, where: Path) -> Any:
        for path in further or []:
            found = predict(found, path, moving_average, centred)
        return found, write_identification(found, where)

    if model == "all":
        with _told() as tell:
            places = league(records, request, folder, tell, lambda found: keep(found, folder / found.model))
        out.print(league_table(places))
        out.print(f"written: {write_league(places, folder)}", markup=False, highlight=False)
        return
    find("damper", model)
    with _told() as tell:
        found, paths = keep(identify_records(records, model, request, tell), folder)
    for table in tables(found):
        out.print(table)
    for note in found.notes:
        err.print(f"note: {note}", style="yellow", markup=False, highlight=False, soft_wrap=True)
    out.print(f"written to {folder}: {', '.join(path.name for path in paths)}", markup=False, highlight=False)


@app.command()
def describe(name: Annotated[str, typer.Argument(help="A name, such as bouc_wen or road.")] = "") -> None:
    """List dampers, laws, excitations and effects, or the keys of one of them with units and bounds."""
    from seatsim.describe import describe as tell

    out.print(tell(name), markup=False, highlight=False, soft_wrap=True)


blind = typer.Typer(help="Check diagnoses on recordings whose effects are sealed.", no_args_is_help=True)
app.add_typer(blind, name="blind")


@blind.command("make")
def blind_make(
    cases: Annotated[int, typer.Option("--cases", min=1, help="How many recordings.")],
    out_folder: Annotated[Path, typer.Option("--out", help="Folder for the recordings.")],
    sealed: Annotated[Path, typer.Option("--sealed", help="File for the encrypted labels.")],
    seed: Annotated[int | None, typer.Option("--seed", help="Seed of the draw; drawn and sealed where absent.")] = None,
    kinds: Annotated[
        str, typer.Option("--kinds", help="mixed, none, one, two, outside, null or background.")
    ] = "mixed",
) -> None:
    """Draw rigs with hidden effects, write recordings of them and seal the labels; the key is printed once."""
    from seatsim.blind.make import make

    with _counted("making recordings") as count:
        key = make(cases, seed, out_folder, sealed, count, kinds)
    out.print(f"written: {cases} recordings in {out_folder}, labels sealed in {sealed}", markup=False, highlight=False)
    out.print(f"key (shown once): {key}", markup=False, highlight=False, soft_wrap=True)


@blind.command("score")
def blind_score(
    folder: Annotated[Path, typer.Argument(help="Folder of `blind make`; undiagnosed cases are diagnosed first.")],
    sealed: Annotated[Path, typer.Option("--sealed", help="File of the encrypted labels.")],
    key: Annotated[str, typer.Option("--key", help="The key that `blind make` printed.")],
    out_folder: Out = None,
) -> None:
    """Diagnose every recording of a sealed set and score the verdicts against the labels."""
    from seatsim.blind.score import score
    from seatsim.blind.score_tables import tables
    from seatsim.blind.sealed import unseal
    from seatsim.diagnosis_output import diagnose_all
    from seatsim.files import write_json

    unseal(sealed, key, folder)
    with _counted("diagnosing") as count:
        diagnose_all(folder, count)
    with _counted("scoring") as count:
        found = score(folder, sealed, key, progress=count)
    for table in tables(found):
        out.print(table)
    path = write_json((out_folder or folder) / "score.json", found.as_dict())
    out.print(f"written: {path}", markup=False, highlight=False)


def _execute(groups: list[list[str]], chosen: list[Path | None], values: dict[str, Any]) -> None:
    """Run every group of files as one result, then print its table and write its files; exit 1 where a run failed."""
    from seatsim.loading import load
    from seatsim.runs import run_many

    loaded = [[scenario for path in group for scenario in load(path, values)] for group in groups]
    scenarios = [scenario for group in loaded for scenario in group]
    folders = [folder or Path("out") / _title(group) for group, folder in zip(loaded, chosen, strict=True)]
    for folder in folders:
        if folders.count(folder) > 1:
            raise InputError(f"two of the files would write to {folder}; give them other names, or run them one by one")
    done: dict[int, Run] = {}
    interrupted = False
    finished = itertools.count(1)
    with _counted("simulating", len(scenarios)) as count:
        try:
            for scenario, answer in run_many(scenarios, lambda _: count(next(finished), len(scenarios))):
                if isinstance(answer, SeatsimError):
                    err.print(f"failed: {answer}", style="red", markup=False, highlight=False, soft_wrap=True)
                else:
                    done[id(scenario)] = answer
        except KeyboardInterrupt:
            interrupted = True
    for group, folder in zip(loaded, folders, strict=True):
        _present([done[id(scenario)] for scenario in group if id(scenario) in done], folder)
    if interrupted:
        raise KeyboardInterrupt
    if len(done) < len(scenarios):
        raise typer.Exit(1)


def _title(scenarios: list[Scenario]) -> str:
    names = list(dict.fromkeys(scenario.name for scenario in scenarios))
    return names[0] if len(names) == 1 else "comparison"


def _present(runs: list[Run], folder: Path) -> None:
    """Print the table of some runs, what their user is warned of, and the paths of the files written."""
    from seatsim.output import write_result
    from seatsim.published import published_tables
    from seatsim.result import Result
    from seatsim.tables import comparison

    if not runs:
        return
    for table in [comparison(runs, _title([run.scenario for run in runs])), *published_tables(runs)]:
        out.print(table)
    for sentence in dict.fromkeys(sentence for run in runs for sentence in run.warnings):
        err.print(f"warning: {sentence}", style="yellow", markup=False, highlight=False, soft_wrap=True)
    paths = write_result(Result(runs), folder)
    out.print(f"written to {folder}: {', '.join(path.name for path in paths)}", markup=False, highlight=False)


@contextmanager
def _counted(title: str, total: int | None = None) -> Iterator[Any]:
    """Show a bar on the terminal that is told `(done, total)`."""
    with Progress(console=err, transient=True, disable=not err.is_terminal) as progress:
        task = progress.add_task(title, total=total)
        yield lambda done, total: progress.update(task, completed=done, total=total)


@contextmanager
def _told() -> Iterator[Any]:
    """Show on the terminal what is being done."""
    with err.status("reading") as status:
        yield status.update


def _settings(pairs: list[str] | None, option: str = "--set") -> dict[str, Any]:
    """Read `KEY=VALUE` pairs, the value as YAML."""
    values = {}
    for pair in pairs or []:
        key, sign, text = pair.partition("=")
        if not sign or not key:
            raise InputError(f"{option} {pair}: write KEY=VALUE, such as --set plant.driver_mass=55 or --fix k0=0")
        try:
            values[key] = YAML(typ="safe").load(text)
        except YAMLError as error:
            raise InputError(f"{option} {pair}: '{text}' is not a YAML value") from error
    return values
