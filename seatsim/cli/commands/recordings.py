"""The commands on recordings: import, inspect, gap, diagnose."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from seatsim.cli.options import Json, NewFolder, OneScenario, Out, OwnCode, Pdf, RecordingFolder
from seatsim.cli.terminal import answer, conclude, say, show_progress, warn, wrote
from seatsim.schema.text import make_printable

if TYPE_CHECKING:
    from seatsim.importing.inspection import Inspection
    from seatsim.recordings.quality.issue import Issue


def gap(
    scenario: OneScenario,
    recording: RecordingFolder,
    out_folder: Out = None,
    predict: Annotated[Path | None, typer.Option("--predict", metavar="DIAGNOSIS.json")] = None,
    own_code: OwnCode = None,
    pdf: Pdf = False,
    as_json: Json = False,
) -> None:
    """Replay a scenario against a recording and print the gap with the noise floor.

    Options:
        predict: Predict the gap from the recording's inputs alone.
    """
    from seatsim.cli.outputs.diagnosis_tables import make_gap_table
    from seatsim.cli.outputs.writing import write_gap
    from seatsim.cli.show_table import show_table
    from seatsim.recordings.gap import forecast_gap
    from seatsim.recordings.gap import gap as find_gap

    found = find_gap(scenario, recording) if predict is None else forecast_gap(scenario, recording, predict)
    show_table(make_gap_table(found))
    warn(found.notes)
    folder = out_folder or Path("out") / f"gap-{Path(recording).name}"
    paths = write_gap(found, scenario, recording, folder)
    conclude(found, folder, paths)


def diagnose(
    recording: RecordingFolder,
    out_folder: Out = None,
    without: Annotated[list[str] | None, typer.Option("--without", metavar="EFFECT")] = None,
    budget: Annotated[float, typer.Option(metavar="SECONDS")] = 120.0,
    damper_forms: Annotated[bool, typer.Option("--damper-forms")] = False,
    after: Annotated[Path | None, typer.Option("--after", metavar="RECORDING")] = None,
    own_code: OwnCode = None,
    pdf: Pdf = False,
    as_json: Json = False,
) -> None:
    """Say where the gap between a recording and its nominal scenario lies, what causes it and how far it shrinks.

    Options:
        without: Withhold an effect from the library.
        budget: Time that it may take; then the best answer so far is given.
        damper_forms: Try other forms of the damper whatever the verdict.
        after: Diagnose this further recording of the rig together with it.
    """
    from seatsim.cli.outputs.diagnosis_tables import make_tables
    from seatsim.cli.outputs.writing import write_diagnosis
    from seatsim.cli.show_table import show_table
    from seatsim.diagnosis.diagnose import diagnose as find_cause
    from seatsim.effects.base import EFFECTS

    withheld = without or []
    for name in withheld:
        # A misspelt name is an error at once, not after minutes of a diagnosis that withheld nothing.
        EFFECTS.find(name)
    with show_progress() as progress:
        diagnosis = find_cause(recording, withheld, progress, budget=budget, damper_forms=damper_forms, after=after)
    show_table(*make_tables(diagnosis))
    warn(diagnosis.notes)
    say(diagnosis.sentence)
    folder = out_folder or Path("out") / f"diagnosis-{Path(recording).resolve().name}"
    paths = write_diagnosis(diagnosis, folder)
    conclude(diagnosis, folder, paths)


def import_data(
    files: Annotated[list[Path], typer.Argument(show_default=False)],
    folder: NewFolder,
    map_file: Annotated[Path | None, typer.Option("--map", metavar="MAP.yaml")] = None,
    nominal: Annotated[str | None, typer.Option("--nominal", metavar="SCENARIO")] = None,
    own_code: OwnCode = None,
    as_json: Json = False,
) -> None:
    """Make a recording of CSV, Parquet, Feather, XLSX, HDF5, MAT, MDF, TDMS, UFF58, RPC III or WAV files.

    Options:
        files: Data files of one rig, or a folder of them.
        map_file: Which column is which channel; proposed where absent.
        nominal: Scenario with the rig's plant, damper and coil.
    """
    from seatsim.importing.import_map import FILE, render_map
    from seatsim.importing.importing import import_files

    with show_progress():
        found = import_files(files, folder, map_file, nominal)
    if found.is_proposed:
        say(f"proposed map ({folder / FILE}, to be edited and given by --map):")
        say(render_map(found.map).rstrip())
    for note in found.notes:
        say(note)
    _doubt(found.doubts)
    wrote(folder, found.paths)
    if nominal is None:
        say(f"before gap or diagnose: state the rig in {folder / 'nominal.yaml'}, or import with --nominal SCENARIO")
    answer(found, found.paths)


def inspect_data(
    data: Annotated[Path, typer.Argument(show_default=False)],
    map_file: Annotated[Path | None, typer.Option("--map", metavar="MAP.yaml")] = None,
    own_code: OwnCode = None,
    as_json: Json = False,
) -> None:
    """Show the channels of a file or a recording, with unit, rate, range, RMS, noise and every doubt.

    Options:
        data: A data file, or the folder of a recording.
        map_file: Show the channels that this map makes of a file.
    """
    found = _inspected(data, map_file)
    _show(found)
    _doubt(found.doubts)
    answer(found)


def _inspected(data: Path, map_file: Path | None) -> Inspection:
    """Return what a file or a recording holds; what a recording needs is not loaded for a file."""
    if map_file is not None:
        from seatsim.importing.inspection import inspect_mapped

        return inspect_mapped(data, map_file)
    if data.is_dir():
        from seatsim.importing.inspection import inspect_recording

        return inspect_recording(data)
    from seatsim.importing.inspection import inspect_file

    return inspect_file(data)


def _show(found: Inspection) -> None:
    """Print a table of channels for each group; `is` names the channel that a column was recognised as."""
    from rich.markup import escape

    from seatsim.cli.show_table import make_table, show_table

    headings = ("channel", "unit", "Hz", "least", "greatest", "RMS", "noise", "swing", "mean", "is", "rows")
    for group, channels in found.channels.items():
        title = f"{Path(found.source).name} ({found.format})" + (f", {group}" if group else "")
        rows = []
        for each in channels:
            rate = "" if each.rate is None else f"{each.rate:.6g}"
            noise = "" if each.noise is None else f"{each.noise:.2g}"
            figures = [f"{value:.4g}" for value in (each.low, each.high, each.rms)]
            others = (each.spark, f"{each.mean:.4g}", each.channel or "", str(each.rows))
            rows.append((escape(each.name), escape(each.unit) or "?", rate, *figures, noise, *others))
        show_table(make_table(make_printable(title), headings, rows, left=(0, 1, 7, 9)))


def _doubt(doubts: list[Issue]) -> None:
    """Print the doubts, errors first; what is said alike of several channels is printed once."""
    for severity, word in (("error", "fault"), ("warning", "doubt"), ("note", "note")):
        places: dict[str, list[str]] = {}
        for issue in doubts:
            if issue.severity == severity:
                place, colon, text = issue.sentence.partition(": ")
                places.setdefault(text if colon else place, []).append(place if colon else "")
        said = (f"{'; '.join(held)}: {text}" if any(held) else text for text, held in places.items())
        warn(said, word)
