"""The commands on recordings: import, inspect, gap, diagnose."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from seatsim.cli.options import Json, NewFolder, OneScenario, Out, OwnCode, RecordingFolder
from seatsim.cli.terminal import answer, say, show_progress, warn, wrote
from seatsim.schema.text import make_printable

if TYPE_CHECKING:
    from rich.table import Table

    from seatsim.importing.inspection import ChannelSummary, Inspection
    from seatsim.recordings.quality.issue import Issue


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
    from seatsim.recordings.gap import forecast_gap
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


COLUMNS = ("unit", "Hz", "least", "greatest", "RMS", "noise", "swing", "mean", "is", "rows")
"""Columns of the table of channels: `is` names the channel that a column was recognised as."""


def import_data(
    files: Annotated[
        list[Path], typer.Argument(help="Data files of one rig, or a folder of them.", show_default=False)
    ],
    folder: NewFolder,
    map_file: Annotated[
        Path | None,
        typer.Option("--map", metavar="MAP.yaml", help="Which column is which channel; proposed where absent."),
    ] = None,
    nominal: Annotated[
        str | None,
        typer.Option("--nominal", metavar="SCENARIO", help="Scenario with the rig's plant, damper and coil."),
    ] = None,
    own_code: OwnCode = None,
    as_json: Json = False,
) -> None:
    """Make a recording of CSV, Parquet, Feather, XLSX, HDF5, MAT, MDF, TDMS, UFF58, RPC III or OpenCRG files."""
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
    if nominal is None and found.map.rig != "road":
        say(f"before gap or diagnose: state the rig in {folder / 'nominal.yaml'}, or import with --nominal SCENARIO")
    answer(found, found.paths)


def inspect_data(
    data: Annotated[Path, typer.Argument(help="A data file, or the folder of a recording.", show_default=False)],
    map_file: Annotated[
        Path | None, typer.Option("--map", metavar="MAP.yaml", help="Show the channels that this map makes of a file.")
    ] = None,
    own_code: OwnCode = None,
    as_json: Json = False,
) -> None:
    """Show the channels of a file or a recording, with unit, rate, range, RMS, noise and every doubt."""
    found = _inspected(data, map_file)
    _show(found)
    _doubt(found.doubts)
    answer(found)


def _inspected(data: Path, map_file: Path | None) -> Inspection:
    """Return what a file or a recording holds; what a recording needs is not loaded for a file."""
    if map_file is not None:
        from seatsim.importing.inspected_recording import inspect_mapped

        return inspect_mapped(data, map_file)
    if data.is_dir():
        from seatsim.importing.inspected_recording import inspect_recording

        return inspect_recording(data)
    from seatsim.importing.inspection import inspect_file

    return inspect_file(data)


def _show(found: Inspection) -> None:
    """Print a table of channels for each group."""
    from seatsim.cli.show_table import show_table

    for group, channels in found.channels.items():
        title = f"{Path(found.source).name} ({found.format})" + (f", {group}" if group else "")
        show_table(_table(title, channels))


def _table(title: str, channels: list[ChannelSummary]) -> Table:
    from rich.markup import escape
    from rich.table import Table

    table = Table(title=escape(make_printable(title)), title_justify="left", box=None, header_style="bold")
    table.add_column("channel", no_wrap=True)
    for name in COLUMNS:
        table.add_column(name, justify="left" if name in ("unit", "swing", "is") else "right", no_wrap=True)
    for each in channels:
        cells = {
            "unit": escape(each.unit) or "?",
            "Hz": "" if each.rate is None else f"{each.rate:.6g}",
            "RMS": f"{each.rms:.4g}",
            "least": f"{each.low:.4g}",
            "greatest": f"{each.high:.4g}",
            "noise": "" if each.noise is None else f"{each.noise:.2g}",
            "swing": each.spark,
            "mean": f"{each.mean:.4g}",
            "is": each.channel or "",
            "rows": str(each.rows),
        }
        table.add_row(escape(each.name), *(cells[name] for name in COLUMNS))
    return table


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
