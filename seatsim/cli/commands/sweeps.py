"""The commands on sweeps: sweep, sweep-report."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated, Literal

import typer

from seatsim.cli.options import Json, Out, OwnCode, Pdf, check_out
from seatsim.cli.terminal import answer, complain, conclude, count_progress, say, show_progress, warn, wrote_one

_FAILURES_SHOWN = 5
"""Failed runs whose reasons are printed; the others stand in the rows."""
_EXCEEDED_SHOWN = 12
"""Limits by group that are printed; the page has more."""
_DOUBTS_SHOWN = 5
_MANY_RUNS = 100_000
"""Runs from which on their number is said at once, since checking them takes seconds."""
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
    as_json: Json = False,
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
    prepared = prepare(file, _foresee)
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


def _foresee(runs: int) -> None:
    if runs >= _MANY_RUNS:
        say(f"{runs} runs; all of their values are checked before the first run begins")


def sweep_report(
    folder: Annotated[Path, typer.Argument(show_default=False)],
    out_folder: Annotated[
        Path | None, typer.Option("--out", show_default="that of the sweep", callback=check_out)
    ] = None,
    pdf: Pdf = False,
    as_json: Json = False,
) -> None:
    """Say what the runs of a sweep have in common: quantiles, sensitivities, probabilities, pictures.

    Options:
        folder: Folder of a sweep.
        out_folder: Folder for the files.
    """
    from seatsim.cli.outputs.simulated import write_sweep_report
    from seatsim.metrics.table import SHORT

    with show_progress():
        report = write_sweep_report(folder, out_folder)
    say(report.sentence)
    for row in report.exceeded[:_EXCEEDED_SHOWN]:
        who = "".join(f"{value}: " for value in row.group.values())
        unit = f" {row.unit}".removesuffix(" -")
        say(
            f"{who}{SHORT.get(row.metric, row.metric)} above {row.limit:g}{unit}: {row.exceeding} of {row.runs} runs,"
            f" {100 * row.share:.3g} % ({100 * row.low:.3g} to {100 * row.high:.3g} %)"
        )
    conclude(report, out_folder or folder, report.paths)
