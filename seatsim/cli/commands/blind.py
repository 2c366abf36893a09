"""The commands that check diagnoses on recordings whose effects are sealed: blind make, blind score."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

from seatsim.cli.options import NewFolder, check_out, with_options
from seatsim.cli.terminal import answer, count_progress, out, say, wrote_one
from seatsim.schema.errors import InputError, SeatsimError

_PROCESSES = 2
"""Recordings of a set that are diagnosed at once."""
blind = typer.Typer(help="Check diagnoses on recordings whose effects are sealed.", no_args_is_help=True)


@blind.command("make")
@with_options("own_code")
def blind_make(
    out_folder: NewFolder,
    sealed: Annotated[Path, typer.Option("--sealed")],
    cases: Annotated[int | None, typer.Option("--cases", min=1)] = None,
    public: Annotated[str | None, typer.Option("--set", metavar="NAME")] = None,
    seed: Annotated[int | None, typer.Option("--seed")] = None,
    kinds: Annotated[str, typer.Option("--kinds")] = "mixed",
    carrier: Annotated[Path | None, typer.Option("--carrier")] = None,
) -> None:
    """Draw rigs with hidden effects, write recordings of them and seal the labels; the key is printed once.

    Options:
        sealed: File for the encrypted labels.
        cases: How many recordings; of a public set the first ones.
        public: The public set of this name, the same everywhere: 60 varied rigs.
        seed: Seed of the draw; drawn and sealed where absent.
        kinds: mixed, varied, none, one, two or outside.
        carrier: A measured recording into which the effects are put instead.
    """
    from seatsim.blind.carrier.make import make_on_carrier
    from seatsim.blind.make.make import PUBLIC_CASES, make
    from seatsim.cli.outputs.answers import BlindMakeAnswer

    if carrier is not None and kinds != "mixed":
        raise InputError(f"--kinds {kinds}: a measured recording carries one effect a case; leave out --kinds")
    if public is not None and (seed is not None or kinds != "mixed" or carrier is not None):
        raise InputError(f"--set {public}: the name fixes seed and rigs; leave out --seed, --kinds and --carrier")
    if public is None and cases is None:
        raise InputError("state how many recordings by --cases, such as --cases 20, or a public set by --set NAME")
    cases = cases or PUBLIC_CASES
    with count_progress("making recordings") as count:
        if carrier is not None:
            key = make_on_carrier(carrier, cases, seed, out_folder, sealed, count)
        else:
            key = make(cases, seed, out_folder, sealed, count, kinds, name=public)
    out.print(f"written: {cases} recordings in {out_folder}, labels sealed in {sealed}", markup=False, highlight=False)
    say(f"key (shown once): {key}")
    answer(BlindMakeAnswer(cases, out_folder, sealed, key))


@blind.command("score")
@with_options("own_code")
def blind_score(
    folder: Annotated[Path, typer.Argument()],
    sealed: Annotated[Path, typer.Option("--sealed")],
    key: Annotated[str, typer.Option("--key")],
    out_folder: Annotated[Path | None, typer.Option("--out", callback=check_out)] = None,
) -> None:
    """Diagnose every recording of a sealed set and score the verdicts against the labels.

    Options:
        folder: Folder of `blind make`; undiagnosed cases are diagnosed first.
        sealed: File of the encrypted labels.
        key: The key that `blind make` printed.
        out_folder: Folder for score.json, FOLDER by default.
    """
    from seatsim.blind.score.score import score
    from seatsim.blind.sealed import unseal
    from seatsim.cli.outputs.diagnosis_results import tabulate_score
    from seatsim.cli.show_table import show_report_tables
    from seatsim.schema.files import write_json

    # A wrong key is an error at once, not after hours of diagnoses.
    unseal(sealed, key, folder)
    with count_progress("diagnosing") as count:
        _diagnose_all(folder, count)
    with count_progress("scoring") as count:
        found = score(folder, sealed, key, progress=count)
    show_report_tables(tabulate_score(found))
    path = write_json((out_folder or folder) / "score.json", found)
    wrote_one(path)
    answer(found, [path])


def _diagnose_all(folder: Path, count: Callable[[int, int], None]) -> None:
    """Diagnose every case of a folder that has no diagnosis yet, into `CASE/diagnosis`; may be taken up again."""
    from seatsim.schema.processes import run_jobs

    cases = sorted(path.parent for path in folder.glob("case-*/recording.yaml"))
    open_cases = [case for case in cases if not (case / "diagnosis" / "diagnosis.json").exists()]
    count(len(cases) - len(open_cases), len(cases))
    jobs, kept = [(case,) for case in open_cases], len(cases) - len(open_cases)
    run_jobs(_diagnose_one, jobs, _PROCESSES, lambda done, _: count(kept + done, len(cases)))


def _diagnose_one(case: Path) -> None:
    """Diagnose one case; one that cannot be diagnosed is left without, and counts as wrong."""
    from seatsim.cli.outputs.diagnosis_results import write_diagnosis
    from seatsim.diagnosis.diagnose import diagnose
    from seatsim.schema.files import write_json

    try:
        # Without a limit of time, since what is found until then differs between machines.
        write_diagnosis(diagnose(case, budget=math.inf), case / "diagnosis")
    except SeatsimError as error:
        write_json(case / "diagnosis" / "error.json", {"error": str(error)})
