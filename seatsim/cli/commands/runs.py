"""The commands on scenarios, alone or in sweeps: run, compare, sweep, sweep-report, synthesise, export, explore."""

from __future__ import annotations

import itertools
import os
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from seatsim.cli.options import OneScenario, Out, OwnCode, Scenarios, Settings, check_out, complete, scenario_settings
from seatsim.cli.terminal import (
    announce,
    answer,
    complain,
    conclude,
    count_progress,
    say,
    show_progress,
    warn,
    wrote,
    wrote_one,
)
from seatsim.schema.errors import InputError, SeatsimError, nearest
from seatsim.schema.guarded import uncut

if TYPE_CHECKING:
    from controllers.synthesis import Design
    from seatsim.cli.terminal import Report
    from seatsim.scenario.scenario import Scenario
    from seatsim.simulation.result import Result, Run


def run(scenarios: Scenarios, out_folder: Out = None, settings: Settings = None) -> None:
    """Simulate scenarios and print a table for each."""
    several = out_folder is not None and len(scenarios) > 1
    folders = [out_folder / Path(path).stem if several and out_folder else out_folder for path in scenarios]
    _execute([[path] for path in scenarios], folders, scenario_settings(settings))


def compare(scenarios: Scenarios, out_folder: Out = None, settings: Settings = None) -> None:
    """Simulate scenarios and print one table over all of them."""
    _execute([scenarios], [out_folder], scenario_settings(settings))


def _execute(files: Sequence[Sequence[str]], folders: Sequence[Path | None], settings: dict[str, object]) -> None:
    """Run every group of files as one result, then print its table and write its files; exit 1 where a run failed."""
    from seatsim.cli.outputs.simulated import RunAnswer
    from seatsim.simulation.result import Result

    groups = _load_groups(files, folders, settings)
    found, interrupted = _simulate([scenario for scenarios, _ in groups for scenario in scenarios])
    in_order, tables, paths, failures = iter(found), list[Result](), list[Path](), list[str]()
    for scenarios, folder in groups:
        of_group = list(itertools.islice(in_order, len(scenarios)))
        failed = [str(each) for each in of_group if isinstance(each, SeatsimError)]
        failures += failed
        if runs := [each for each in of_group if not isinstance(each, SeatsimError)]:
            # What an interrupt left done is kept before the process ends.
            with uncut if interrupted else nullcontext():
                table, written = _present(runs, failed, folder, interrupted)
            tables.append(table)
            paths += written
    if interrupted:
        raise KeyboardInterrupt
    answer(RunAnswer(tables, failures), paths)
    if failures:
        raise typer.Exit(1)


def _load_groups(
    files: Sequence[Sequence[str]], folders: Sequence[Path | None], settings: dict[str, object]
) -> list[tuple[list[Scenario], Path]]:
    """Load the scenarios that share a table, with the folder of each group: the one chosen, or one of its title."""
    from seatsim.scenario.loading import load

    groups = []
    for paths, chosen in zip(files, folders, strict=True):
        scenarios = [scenario for path in paths for scenario in load(path, settings)]
        groups.append((scenarios, chosen or Path("out") / _title(scenarios)))
    for _, folder in groups:
        if sum(other == folder for _, other in groups) > 1:
            raise InputError(f"two of the files would write to {folder}; give them other names, or run them one by one")
    return groups


def _simulate(scenarios: list[Scenario]) -> tuple[list[Run | SeatsimError], bool]:
    """Run scenarios side by side; return runs and failures in order, up to an interrupt, and whether there was one."""
    from seatsim.simulation.runs import run_many

    found: list[Run | SeatsimError] = []
    finished = itertools.count(1)
    # No daemon: Python aborts where it ends while such a thread loads compiled code.
    loading = Thread(target=_load_writers)
    loading.start()
    with count_progress("simulating", len(scenarios)) as count:
        try:
            for _, one in run_many(scenarios, lambda _: count(next(finished), len(scenarios))):
                if isinstance(one, SeatsimError):
                    complain(f"failed: {one}")
                found.append(one)
        except KeyboardInterrupt:
            return found, True
    loading.join()
    return found, False


def _load_writers() -> None:
    """Load what writes tables and draws pictures: it takes as long as many runs, and can be done beside them."""
    import pyarrow.parquet  # noqa: F401

    import seatsim.plots.runs.draw  # noqa: F401


def _title(scenarios: Sequence[Scenario]) -> str:
    names = list(dict.fromkeys(scenario.name for scenario in scenarios))
    return names[0] if len(names) == 1 else "comparison"


def _present(runs: list[Run], failures: list[str], folder: Path, interrupted: bool) -> tuple[Result, list[Path]]:
    """Print the table of some runs and the warnings; return their result and its files."""
    from seatsim.cli.outputs.simulated import make_comparison_table, make_overall_table, write_interrupted, write_result
    from seatsim.cli.show_table import show_table
    from seatsim.simulation.checks import describe_designs
    from seatsim.simulation.result import Result

    scenarios = [run.scenario for run in runs]
    show_table(make_comparison_table(runs, _title(scenarios)), *make_overall_table(runs))
    for sentence in describe_designs(scenarios):
        say(sentence)
    warn(dict.fromkeys(sentence for run in runs for sentence in run.warnings), "warning")
    warn(f"{run.scenario.title}: {sentence}" for run in runs for sentence in run.history.notes)
    result = Result(runs, failures)
    paths = write_interrupted(result, folder) if interrupted else write_result(result, folder)
    wrote(folder, paths)
    return result, paths


_FAILURES_SHOWN = 5
"""Failed runs whose reasons are printed; the others stand in the rows."""
_DOUBTS_SHOWN = 5
_SweepFile = Annotated[Path, typer.Argument(help="A sweep file: a scenario, and what is varied.", show_default=False)]


def sweep(
    file: _SweepFile,
    out_folder: Out = None,
    engine: Annotated[Literal["local", "dask", "cuda"], typer.Option("--engine")] = "local",
    address: Annotated[str | None, typer.Option("--address", metavar="URL")] = None,
    jobs: Annotated[int | None, typer.Option("--jobs", min=1, show_default="all processors")] = None,
    resume: Annotated[bool, typer.Option("--resume")] = False,
    keep: Annotated[Literal["none", "histories"], typer.Option("--keep")] = "none",
    share: Annotated[str | None, typer.Option("--part", metavar="K/N")] = None,
    slurm: Annotated[Path | None, typer.Option("--slurm", metavar="FILE")] = None,
    own_code: OwnCode = None,
) -> None:
    """Simulate a scenario with many values of its keys, and keep the metrics of every run.

    Options:
        engine: This machine, a cluster, or a CUDA device.
        address: Running dask scheduler, such as tcp://host:8786.
        jobs: Runs at once.
        resume: Go on with the sweep in the folder.
        keep: What is kept of a run besides its metrics.
        share: Only part K of N, beside commands for the others.
        slurm: Write an array script for Slurm; nothing runs.
    """
    from seatsim.cli.outputs.answers import SlurmAnswer
    from seatsim.sweeps.cluster import write_slurm
    from seatsim.sweeps.execute import execute, open_engine, prepare, read_share
    from seatsim.sweeps.folder import say_ended

    folder = out_folder or Path("out") / file.stem
    part = read_share(share) if share else None
    prepared = prepare(file)
    warn(prepared.doubts[:_DOUBTS_SHOWN], "warning")
    if slurm is not None:
        path = write_slurm(slurm, file, folder, prepared.plan, keep == "histories", own_code or [])
        wrote_one(path)
        say(f"next: sbatch {path}, then seatsim sweep-report {folder}")
        return answer(SlurmAnswer(prepared.plan.runs), [path])
    try:
        with (
            open_engine(engine, jobs or os.cpu_count() or 1, address, keep == "histories") as carry_out,
            count_progress("simulating", prepared.plan.runs) as count,
        ):
            result = execute(prepared, folder, carry_out, resume, keep == "histories", part, count)
    except KeyboardInterrupt:
        complain(f"interrupted: {folder} keeps {say_ended(folder)}; go on with --resume")
        raise
    counts = ", ".join(f"{number} {state}" for state, number in result.counts.items() if number or state == "done")
    say(f"{folder}: {counts}")
    if not result.counts["pending"]:
        say(f"next: seatsim sweep-report {folder}")
    for text in result.failures[:_FAILURES_SHOWN]:
        complain(f"failed: {text}")
    if len(result.failures) > _FAILURES_SHOWN:
        complain(f"and {len(result.failures) - _FAILURES_SHOWN} more; their reasons stand in the rows")
    answer(result, [folder / "manifest.json"])
    if result.failures:
        raise typer.Exit(1)


def sweep_report(
    folder: Annotated[Path, typer.Argument(show_default=False)],
    out_folder: Annotated[
        Path | None, typer.Option("--out", show_default="that of the sweep", callback=check_out)
    ] = None,
) -> None:
    """Say what the runs of a sweep have in common: quantiles, sensitivities, probabilities, pictures.

    Options:
        folder: Folder of a sweep.
        out_folder: Folder for the files.
    """
    from seatsim.cli.outputs.simulated import write_sweep_report
    from seatsim.cli.show_table import show_report_tables

    with show_progress():
        report = write_sweep_report(folder, out_folder)
    say(report.sentence)
    show_report_tables(report.limits)
    conclude(report, out_folder or folder, report.paths)


_PAGE_EXTRA = 'the page needs an extra; install it with: pip install "seatsim[page]"'


def export(
    scenario: OneScenario,
    form: Annotated[str, typer.Option("--to", autocompletion=complete("fmu2", "fmu3", "c", "mat"))],
    what: Annotated[str, typer.Option("--what", autocompletion=complete("rig", "damper", "controller"))],
    out: Annotated[Path, typer.Option("--out", metavar="FILE")],
    variant: Annotated[str | None, typer.Option("--variant", metavar="NAME", show_default="the first")] = None,
    settings: Settings = None,
) -> None:
    """Write a scenario's rig, damper or controller for other programs: as an FMU, as C, or as a MAT file.

    Options:
        form: fmu2, fmu3, c or mat.
        what: rig, damper or controller.
        out: The file to be written.
        variant: The variant of the scenario.
    """
    from seatsim.exchange.block import ExportedBlock, list_variables
    from seatsim.exchange.export import export as write
    from seatsim.scenario.loading import load

    run = _choose(scenario, load(scenario, scenario_settings(settings)), variant)
    with show_progress() as progress:
        progress(f"exporting {what}")
        block = write(run, form, what, out)
    warn(block.notes)
    wrote_one(out)
    answer(ExportedBlock(block.name, block.step, list_variables(block), block.notes), [out])


def _choose(name: str, runs: Sequence[Scenario], variant: str | None) -> Scenario:
    """Return the first run of a variant, or of all, and say so where there are others."""
    known = list(dict.fromkeys(run.label["variant"] for run in runs if "variant" in run.label))
    if variant is not None and variant not in known:
        names = f"its variants: {'; '.join(known)}" if known else "it has no variants"
        raise InputError(f"--variant {variant}: {name} has no such variant{nearest(variant, known)}; {names}")
    chosen = [run for run in runs if variant is None or run.label["variant"] == variant]
    if len(chosen) > 1:
        others = f"; --variant takes another one: {'; '.join(known)}" if variant is None and known else ""
        warn([f"{name} holds {len(chosen)} runs; the first is exported: {chosen[0].title}{others}"])
    return chosen[0]


def synthesise(
    scenario: OneScenario,
    out_folder: Out = None,
    prove_best: Annotated[bool, typer.Option("--global")] = False,
    settings: Settings = None,
) -> None:
    """Synthesise the H-infinity static output feedback of a scenario's plant and weights.

    Options:
        prove_best: Prove that no permitted gain is better by 0.1 % (up to four gains).
    """
    from seatsim.cli.outputs.simulated import tabulate_design
    from seatsim.cli.show_table import show_report_tables
    from seatsim.provenance.statement import write_documented
    from seatsim.scenario.loading import single
    from seatsim.schema.yaml_source import Source
    from seatsim.simulation.checks import measure_clipping

    chosen = single(scenario, scenario_settings(settings))
    with show_progress() as progress:
        design = _synthesise(chosen, progress)
        design = design.prove(progress) if prove_best else design
        design = design.with_clipping(measure_clipping(chosen, design.gain))
    show_report_tables(tabulate_design(design, chosen))
    folder = out_folder or Path("out") / chosen.name

    def write(part: Path) -> list[Path]:
        design.save(part / "design.yaml")
        if design.proof is not None:
            design.proof.save(part / "global.json")
        return sorted(part.iterdir())

    paths = write_documented(folder, write, chosen.seed)
    wrote(folder, paths)
    answer(Source(folder / "design.yaml").data, paths)


def _synthesise(scenario: Scenario, progress: Report) -> Design:
    """Return the design of a law that has a synthesis, for the plant of a scenario."""
    from seatsim.rig.designs import SynthesisedLaw
    from seatsim.schema.registry import name_of
    from seatsim.simulation.simulate import record_floors, settle_travel

    with scenario.placed("controller"):
        if scenario.plant is None or scenario.control is None:
            raise InputError("a damper bench has no controller to synthesise")
        law = settle_travel(scenario, scenario.control)
        if not isinstance(law, SynthesisedLaw):
            name = name_of("law", type(law))
            raise InputError(f"law '{name}' is not synthesised; use 'law: static_output_feedback' with 'weights'")
        control = scenario.control
        return law.synthesis(scenario.plant, lambda: record_floors(scenario, control), progress)


def explore(
    target: Annotated[str, typer.Argument(metavar="[SCENARIO|RECORDING]")] = "quickstart",
    port: Annotated[int, typer.Option("--port", min=0, max=65535, show_default="a free one")] = 0,
    no_browser: Annotated[bool, typer.Option("--no-browser")] = False,
) -> None:
    """Open a page on this machine: move driver, temperature, road and controller, or effects, and see what follows.

    Options:
        target: A scenario, an example, or a recording's folder.
        port: Port of loopback.
        no_browser: Print the address and open no browser.
    """
    try:
        from seatsim.page.app import open_target, serve
    except ModuleNotFoundError as error:
        if error.name is None or error.name.partition(".")[0] not in ("starlette", "uvicorn"):
            raise
        raise InputError(_PAGE_EXTRA) from error
    path = Path(target)
    folder = path if path.is_dir() else path.parent if path.exists() else Path()
    with show_progress() as progress:
        progress("loading the models")
        opened = open_target(path)
    serve(opened, folder, port, not no_browser, announce)
