"""The commands that compare a simulation with a recording: gap, diagnose."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from seatsim.cli.options import Json, OneScenario, Out, OwnCode, RecordingFolder
from seatsim.cli.terminal import answer, say, show_progress, warn, wrote


def gap(
    scenario: OneScenario,
    recording: RecordingFolder,
    out_folder: Out = None,
    predict: Annotated[
        Path | None,
        typer.Option("--predict", metavar="DIAGNOSIS.json", help="Predict the gap from the recording's inputs alone."),
    ] = None,
    own_code: OwnCode = None,
    as_json: Json = False,
) -> None:
    """Replay a scenario against a recording and print the gap with the noise floor."""
    from seatsim.cli.outputs.diagnosis_tables import make_gap_table
    from seatsim.cli.outputs.measured import write_gap
    from seatsim.cli.show_table import show_table
    from seatsim.recordings.forecast import forecast_gap
    from seatsim.recordings.gap import gap as find_gap

    found = find_gap(scenario, recording) if predict is None else forecast_gap(scenario, recording, predict)
    show_table(make_gap_table(found))
    warn(found.notes)
    folder = out_folder or Path("out") / f"gap-{Path(recording).name}"
    paths = write_gap(found, scenario, recording, folder)
    wrote(folder, paths)
    answer(found, paths)


def diagnose(
    recording: RecordingFolder,
    out_folder: Out = None,
    without: Annotated[
        list[str] | None, typer.Option("--without", metavar="EFFECT", help="Withhold an effect from the library.")
    ] = None,
    budget: Annotated[
        float, typer.Option(metavar="SECONDS", help="Time that it may take; then the best answer so far is given.")
    ] = 120.0,
    damper_forms: Annotated[
        bool, typer.Option("--damper-forms", help="Try other forms of the damper whatever the verdict.")
    ] = False,
    after: Annotated[
        Path | None,
        typer.Option(
            "--after", metavar="RECORDING", help="Diagnose this further recording of the rig together with it."
        ),
    ] = None,
    own_code: OwnCode = None,
    as_json: Json = False,
) -> None:
    """Say where the gap between a recording and its nominal scenario lies, what causes it and how far it shrinks."""
    from seatsim.cli.outputs.diagnosis_tables import make_tables
    from seatsim.cli.outputs.measured import write_diagnosis
    from seatsim.cli.show_table import show_table
    from seatsim.diagnosis.diagnose import diagnose as find_cause
    from seatsim.effects.base import EFFECTS

    withheld = without or []
    for name in withheld:
        # A misspelt name is an error at once, not after minutes of a diagnosis that withheld nothing.
        EFFECTS.find(name)
    with show_progress() as progress:
        diagnosis = find_cause(recording, withheld, progress, budget=budget, damper_forms=damper_forms, after=after)
    for table in make_tables(diagnosis):
        show_table(table)
    warn(diagnosis.notes)
    say(diagnosis.sentence)
    folder = out_folder or Path("out") / f"diagnosis-{Path(recording).resolve().name}"
    paths = write_diagnosis(diagnosis, folder)
    wrote(folder, paths)
    answer(diagnosis, paths)
