"""The commands that check diagnoses on recordings whose effects are sealed: blind make, blind score."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from seatsim.cli.options import Out, OwnCode
from seatsim.cli.terminal import count_progress, out, say, wrote_one

blind = typer.Typer(help="Check diagnoses on recordings whose effects are sealed.", no_args_is_help=True)


@blind.command("make")
def blind_make(
    cases: Annotated[int, typer.Option("--cases", min=1, help="How many recordings.")],
    out_folder: Annotated[Path, typer.Option("--out", help="Folder for the recordings.")],
    sealed: Annotated[Path, typer.Option("--sealed", help="File for the encrypted labels.")],
    seed: Annotated[int | None, typer.Option("--seed", help="Seed of the draw; drawn and sealed where absent.")] = None,
    kinds: Annotated[
        str, typer.Option("--kinds", help="mixed, varied, none, one, two, outside, null or background.")
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
    own_code: OwnCode = None,
) -> None:
    """Diagnose every recording of a sealed set and score the verdicts against the labels."""
    from seatsim.blind.score.score import score
    from seatsim.blind.score.tables import tables
    from seatsim.blind.sealed import unseal
    from seatsim.cli.outputs.diagnosis import diagnose_all
    from seatsim.schema.files import write_json

    # A wrong key is an error at once, not after hours of diagnoses.
    unseal(sealed, key, folder)
    with count_progress("diagnosing") as count:
        diagnose_all(folder, count)
    with count_progress("scoring") as count:
        found = score(folder, sealed, key, progress=count)
    for table in tables(found):
        out.print(table)
    wrote_one(write_json((out_folder or folder) / "score.json", found.as_dict()))
