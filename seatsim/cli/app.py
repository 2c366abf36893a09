"""The command line."""

from __future__ import annotations

import itertools
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from seatsim.cli.bench import characterise, identify
from seatsim.cli.terminal import Out, complain, count_progress, err, out, pairs, say, show_progress, warn, wrote
from seatsim.schema.errors import InputError, SeatsimError

if TYPE_CHECKING:
    from seatsim.scenario.scenario import Scenario
    from seatsim.simulation.result import Run

app = typer.Typer(
    help="Simulate semi-active MR-damper seats and compare what is done to them.",
    no_args_is_help=True, add_completion=False, pretty_exceptions_enable=False,
)  # fmt: skip

Scenarios = Annotated[list[str], typer.Argument(help="Scenario files, or names of examples.", show_default=False)]
OneScenario = Annotated[str, typer.Argument(help="A scenario file, or the name of an example.", show_default=False)]
Settings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Replace a value by dotted key, such as plant.driver_mass=55."),
]
SET = ("--set", "plant.driver_mass=55")


def main() -> None:
    """Run the command line: exit 0 done, 1 a run failed, 2 bad input (nothing written)."""
    try:
        app()
    except SeatsimError as error:
        complain(f"error: {error}")
        sys.exit(error.exit_status)
    except KeyboardInterrupt:
        err.print("interrupted")
        sys.exit(130)


@app.command()
def run(scenarios: Scenarios, out_folder: Out = None, settings: Settings = None) -> None:
    """Simulate scenarios and print a table for each."""
    several = out_folder is not None and len(scenarios) > 1
    folders = [out_folder / Path(path).stem if several and out_folder else out_folder for path in scenarios]
    _execute([[path] for path in scenarios], folders, pairs(settings, *SET))


@app.command()
def compare(
    scenarios: Scenarios,
    out_folder: Out = None,
    settings: Settings = None,
    bracket: Annotated[
        bool, typer.Option("--bracket", help="Add what the best damper could have done; takes minutes for each floor.")
    ] = False,
) -> None:
    """Simulate scenarios and print one table over all of them."""
    _execute([scenarios], [out_folder], pairs(settings, *SET), bracket)


@app.command()
def synthesise(scenario: OneScenario, out_folder: Out = None, settings: Settings = None) -> None:
    """Synthesise the H-infinity static output feedback of a scenario's plant and weights."""
    from seatsim.cli.design_table import design_table
    from seatsim.scenario.loading import single
    from seatsim.scenario.synthesis import synthesise_design

    chosen = single(scenario, pairs(settings, *SET))
    with show_progress() as progress:
        design = synthesise_design(chosen, progress)
    out.print(design_table(design, chosen))
    folder = out_folder or Path("out") / chosen.name
    design.save(folder / "design.yaml")
    out.print(f"written: {folder / 'design.yaml'}", markup=False, highlight=False)


@app.command()
def gap(scenario: OneScenario, recording: Path, out_folder: Out = None) -> None:
    """Replay a scenario against a recording and print the gap beside the noise floor."""
    from seatsim.cli.gap_table import gap_table
    from seatsim.recordings.gap import gap as find_gap
    from seatsim.schema.files import write_json

    found = find_gap(scenario, recording)
    out.print(gap_table(found))
    warn(found.notes)
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
    from seatsim.cli.outputs.diagnosis import make_tables, write_diagnosis
    from seatsim.diagnosis.diagnose import diagnose as find_cause
    from seatsim.schema.registry import find

    withheld = without or []
    for name in withheld:
        find("effect", name)
    with show_progress() as progress:
        diagnosis = find_cause(recording, withheld, progress)
    for table in make_tables(diagnosis):
        out.print(table)
    warn(diagnosis.notes)
    say(diagnosis.sentence)
    folder = out_folder or Path("out") / f"diagnosis-{Path(recording).resolve().name}"
    wrote(folder, write_diagnosis(diagnosis, folder))


app.command()(characterise)
app.command()(identify)


@app.command()
def describe(name: Annotated[str, typer.Argument(help="A name, such as bouc_wen or road.")] = "") -> None:
    """List dampers, laws, excitations and effects, or the keys of one of them with units and bounds."""
    from seatsim.scenario.describe import describe as progress

    say(progress(name))


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
    from seatsim.blind.make.make import make

    with count_progress("making recordings") as count:
        key = make(cases, seed, out_folder, sealed, count, kinds)
    out.print(f"written: {cases} recordings in {out_folder}, labels sealed in {sealed}", markup=False, highlight=False)
    say(f"key (shown once): {key}")


@blind.command("score")
def blind_score(
    folder: Annotated[Path, typer.Argument(help="Folder of `blind make`; undiagnosed cases are diagnosed first.")],
    sealed: Annotated[Path, typer.Option("--sealed", help="File of the encrypted labels.")],
    key: Annotated[str, typer.Option("--key", help="The key that `blind make` printed.")],
    out_folder: Out = None,
) -> None:
    """Diagnose every recording of a sealed set and score the verdicts against the labels."""
    from seatsim.blind.score.score import score
    from seatsim.blind.score.tables import tables
    from seatsim.blind.sealed import unseal
    from seatsim.cli.outputs.diagnosis import diagnose_all
    from seatsim.schema.files import write_json

    unseal(sealed, key, folder)
    with count_progress("diagnosing") as count:
        diagnose_all(folder, count)
    with count_progress("scoring") as count:
        found = score(folder, sealed, key, progress=count)
    for table in tables(found):
        out.print(table)
    path = write_json((out_folder or folder) / "score.json", found.as_dict())
    out.print(f"written: {path}", markup=False, highlight=False)


def _execute(groups: list[list[str]], chosen: list[Path | None], values: dict[str, Any], bracket: bool = False) -> None:
    """Run every group of files as one result, then print its table and write its files; exit 1 where a run failed."""
    from seatsim.scenario.loading import load
    from seatsim.simulation.runs import run_many

    loaded = [[scenario for path in group for scenario in load(path, values)] for group in groups]
    scenarios = [scenario for group in loaded for scenario in group]
    folders = [folder or Path("out") / _title(group) for group, folder in zip(loaded, chosen, strict=True)]
    for folder in folders:
        if folders.count(folder) > 1:
            raise InputError(f"two of the files would write to {folder}; give them other names, or run them one by one")
    done: dict[int, Run] = {}
    interrupted = False
    finished = itertools.count(1)
    with count_progress("simulating", len(scenarios)) as count:
        try:
            for scenario, answer in run_many(scenarios, lambda _: count(next(finished), len(scenarios))):
                if isinstance(answer, SeatsimError):
                    complain(f"failed: {answer}")
                else:
                    done[id(scenario)] = answer
        except KeyboardInterrupt:
            interrupted = True
    for group, folder in zip(loaded, folders, strict=True):
        _present(
            [done[id(scenario)] for scenario in group if id(scenario) in done], folder, bracket and not interrupted
        )
    if interrupted:
        raise KeyboardInterrupt
    if len(done) < len(scenarios):
        raise typer.Exit(1)


def _title(scenarios: list[Scenario]) -> str:
    names = list(dict.fromkeys(scenario.name for scenario in scenarios))
    return names[0] if len(names) == 1 else "comparison"


def _present(runs: list[Run], folder: Path, bracket: bool) -> None:
    """Print the table of some runs, their brackets where wanted, the warnings, and the paths of the files written."""
    from seatsim.cli.outputs.runs import write_result
    from seatsim.cli.published_tables import published_tables
    from seatsim.cli.tables import comparison
    from seatsim.simulation.result import Result

    if not runs:
        return
    for table in [comparison(runs, _title([run.scenario for run in runs])), *published_tables(runs)]:
        out.print(table)
    warn(dict.fromkeys(sentence for run in runs for sentence in run.warnings), "warning")
    warn(f"{run.scenario.title}: {sentence}" for run in runs for sentence in run.history.notes)
    result = Result(runs, _brackets(runs) if bracket else {})
    wrote(folder, write_result(result, folder))


def _brackets(runs: list[Run]) -> dict[str, Any]:
    """Work out the brackets and print how far from them each run is; an interrupt keeps what there is."""
    from seatsim.cli.tables import distances
    from seatsim.simulation.performance_bounds import compute_performance_bounds, explain_runs_below_bound

    found: dict[str, Any] = {}
    with show_progress() as progress:
        try:
            for rig, answer in compute_performance_bounds(runs, progress):
                if isinstance(answer, InputError):
                    complain(f"no bracket: {answer}")
                else:
                    found[rig] = answer
        except KeyboardInterrupt:
            warn(["interrupted: the brackets that were not finished are left out"])
    if found:
        out.print(distances(runs, found))
    warn(explain_runs_below_bound(runs, found))
    return found
