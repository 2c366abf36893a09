"""The commands on measured data: import, inspect, gap, diagnose, comfort, seat-test, characterise, identify."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from seatsim.cli.options import (
    NewFolder,
    OneScenario,
    Out,
    RecordingFolder,
    Settings,
    complete_kind,
    pairs,
    scenario_settings,
)
from seatsim.cli.terminal import answer, count_progress, say, show_progress, warn, wrote
from seatsim.schema.errors import InputError
from seatsim.schema.text import make_printable

if TYPE_CHECKING:
    from seatsim.importing.inspection import Inspection
    from seatsim.recordings.quality.issue import Issue


def characterise(
    data: Annotated[Path, typer.Argument(show_default=False)],
    out_folder: Out = None,
    limits: Annotated[Path | None, typer.Option("--limits", metavar="LIMITS.yaml")] = None,
    beside: Annotated[Path | None, typer.Option("--beside", metavar="DAMPER.yaml")] = None,
    pattern: Annotated[str, typer.Option("--pattern", metavar="REGEX")] = "",
    window: Annotated[float, typer.Option("--window", min=0.001, max=1.0)] = 0.1,
) -> None:
    """Show what a bench shows of a damper: loops, energy, asymmetry, offset and response times.

    Options:
        data: A bench table, or a folder of them.
        limits: Limits of figures, which pass or fail.
        beside: A damper whose forces stand beside.
        pattern: Groups current and temperature of file names.
        window: Part of the stroke over which forces are averaged.
    """
    from seatsim.characterisation.sheet import check_limits
    from seatsim.characterisation.summary import characterise as characterise_records
    from seatsim.characterisation.summary import load_damper, model_peaks
    from seatsim.cli.outputs.damper_results import present_characterisation
    from seatsim.recordings.bench_tables import NAMED

    damper = load_damper(beside) if beside else None
    with show_progress() as progress:
        names = (_title(data), data.resolve().name)
        found = characterise_records(data, *names, window, pattern or NAMED, progress)
    sheet = found.sheet
    if damper is not None:
        sheet = sheet._replace(beside=model_peaks(damper, found.rows, window))
    if limits:
        sheet = sheet._replace(limits=check_limits(sheet, limits))
    present_characterisation(found._replace(sheet=sheet), out_folder or Path("out") / f"characterise-{found.name}")


def identify(
    data: Annotated[Path, typer.Argument(show_default=False)],
    models: Annotated[list[str], typer.Option("--model", show_default=False, autocompletion=complete_kind("damper"))],
    test: Annotated[list[str] | None, typer.Option("--test", metavar="GLOB")] = None,
    test_fraction: Annotated[float, typer.Option("--test-fraction")] = 0.0,
    fix: Annotated[list[str] | None, typer.Option("--fix", metavar="NAME=VALUE")] = None,
    ignore_temperature: Annotated[bool, typer.Option("--ignore-temperature")] = False,
    seed: Annotated[int, typer.Option("--seed", min=0)] = 0,
    out_folder: Out = None,
) -> None:
    """Fit a damper model, or every model, to bench records and assess it on records held out.

    Options:
        data: A bench table, or a folder of them.
        models: A damper model, several, or all, to compare them.
        test: Hold out the files whose names match.
        test_fraction: Hold out this share of each record, its last part.
        fix: Keep a parameter at a value.
        ignore_temperature: Do not fit its influence.
        seed: Seed of the global search.
    """
    from seatsim.cli.outputs.damper_results import compare_models, identify_damper
    from seatsim.identification.settings import IdentificationSettings
    from seatsim.recordings.bench_tables import load_bench

    # That each value is a number is checked with the bounds of its field, once the model is known.
    fixed = cast("Mapping[str, float]", pairs(fix, "--fix", "v_ref=0.005"))
    request = IdentificationSettings(tuple(test or ()), test_fraction, fixed, ignore_temperature, seed)
    name = "league" if len(models) > 1 else models[0].rpartition(":")[2]
    folder = out_folder or Path("out") / f"identify-{_title(data)}-{name}"
    records = load_bench(data)
    if len(models) > 1 or models == ["all"]:
        compare_models(records, models, request, folder)
    else:
        identify_damper(records, models[0], request, folder)


def _title(data: Path) -> str:
    return data.resolve().name.split(".")[0]


def gap(
    scenario: OneScenario,
    recording: RecordingFolder,
    out_folder: Out = None,
    predict: Annotated[Path | None, typer.Option("--predict", metavar="DIAGNOSIS.json")] = None,
) -> None:
    """Replay a scenario against a recording and print the gap with the noise floor.

    Options:
        predict: Predict the gap from the recording's inputs alone.
    """
    from seatsim.cli.outputs.diagnosis_results import present_gap
    from seatsim.recordings.gap import forecast_gap
    from seatsim.recordings.gap import gap as find_gap

    found = find_gap(scenario, recording) if predict is None else forecast_gap(scenario, recording, predict)
    present_gap(found, scenario, recording, out_folder or Path("out") / f"gap-{recording.name}")


def diagnose(
    recording: RecordingFolder,
    out_folder: Out = None,
    without: Annotated[list[str] | None, typer.Option("--without", metavar="EFFECT")] = None,
    budget: Annotated[float, typer.Option(metavar="SECONDS")] = 120.0,
    damper_forms: Annotated[bool, typer.Option("--damper-forms")] = False,
    after: Annotated[Path | None, typer.Option("--after", metavar="RECORDING")] = None,
) -> None:
    """Say where the gap between a recording and its nominal scenario lies, what causes it and how far it shrinks.

    Options:
        without: Withhold an effect from the library.
        budget: Time that it may take; then the best answer so far is given.
        damper_forms: Try other forms of the damper whatever the verdict.
        after: Diagnose this further recording of the rig together with it.
    """
    from seatsim.cli.outputs.diagnosis_results import present_diagnosis
    from seatsim.diagnosis.diagnose import diagnose as find_cause
    from seatsim.effects.base import EFFECTS

    withheld = without or []
    for name in withheld:
        # A misspelt name is an error at once, not after minutes of a diagnosis that withheld nothing.
        EFFECTS.find(name)
    with show_progress() as progress:
        diagnosis = find_cause(recording, withheld, progress, budget=budget, damper_forms=damper_forms, after=after)
    present_diagnosis(diagnosis, out_folder or Path("out") / f"diagnosis-{recording.resolve().name}")


def import_data(
    files: Annotated[list[Path], typer.Argument(show_default=False)],
    folder: NewFolder,
    map_file: Annotated[Path | None, typer.Option("--map", metavar="MAP.yaml")] = None,
    nominal: Annotated[str | None, typer.Option("--nominal", metavar="SCENARIO")] = None,
) -> None:
    """Make a recording of CSV, Parquet, Feather, XLSX, HDF5, MAT, MDF, TDMS, UFF58 or RPC III files.

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
) -> None:
    """Show the channels of a file or a recording, with unit, rate, range, RMS, noise and every doubt.

    Options:
        data: A data file, or the folder of a recording.
    """
    from seatsim.importing.inspection import inspect_file, inspect_recording

    found = inspect_recording(data) if data.is_dir() else inspect_file(data)
    _show(found)
    _doubt(found.doubts)
    answer(found)


def _show(found: Inspection) -> None:
    """Print a table of channels for each group; `is` names the channel that a column was recognised as."""
    from rich.markup import escape

    from seatsim.cli.show_table import make_table, show_table

    headings = ("channel", "unit", "Hz", "least", "greatest", "RMS", "noise", "mean", "is", "rows")
    for group, channels in groupby(found.channels, key=lambda each: each.group):
        title = f"{Path(found.source).name} ({found.format})" + (f", {group}" if group else "")
        rows = []
        for each in channels:
            rate = "" if each.rate is None else f"{each.rate:.6g}"
            noise = "" if each.noise is None else f"{each.noise:.2g}"
            low, high, rms, mean = (f"{value:.4g}" for value in (each.low, each.high, each.rms, each.mean))
            names = (escape(each.name), escape(each.unit) or "?")
            rows.append((*names, rate, low, high, rms, noise, mean, each.channel or "", str(each.rows)))
        show_table(make_table(make_printable(title), headings, rows, left=(0, 1, 8)))


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


def comfort(
    file: Annotated[Path, typer.Argument(show_default=False)],
    channel: Annotated[list[str] | None, typer.Option("--channel", metavar="AXIS=COLUMN")] = None,
    hours: Annotated[float, typer.Option("--hours", metavar="H")] = 8.0,
    run: Annotated[list[str] | None, typer.Option("--run")] = None,
    rate: Annotated[float | None, typer.Option("--rate")] = None,
    unit: Annotated[str | None, typer.Option("--unit")] = None,
    out_folder: Out = None,
) -> None:
    """Work out the ISO 2631-1 figures of measured accelerations, a day's exposure and SEAT factors.

    Options:
        file: A CSV table of accelerations, or a recording.
        channel: x, y, z, rx .. on the seat, back.x .. feet.z, floor.z.
        hours: Hours of such vibration in a day.
        run: A run of a recording; all together where none is named.
        rate: Sample rate in Hz of a table without times.
        unit: Of columns whose names state none, such as g.
    """
    from seatsim.cli.outputs.damper_results import present_comfort
    from seatsim.standards.comfort import comfort as assess

    channels = _read_channels(channel or [])
    found = assess(file, channels, hours=hours, runs=run or (), rate=rate, unit=unit)
    name = file.resolve().name.partition(".")[0]
    present_comfort(found, file, out_folder or Path("out") / f"comfort-{name}")


def _read_channels(texts: list[str]) -> dict[str, str]:
    """Return columns by axis."""
    found = dict[str, str]()
    for text in texts:
        axis, _, column = (part.strip() for part in text.partition("="))
        if not (axis and column):
            raise InputError(f"--channel {text}: write it like --channel z=acc_z")
        if axis in found:
            raise InputError(f"--channel {text}: {axis} has {found[axis]} already; give it once")
        found[axis] = column
    return found


def seat_test(
    source: Annotated[str, typer.Argument(show_default=False)],
    spectral_class: Annotated[list[str] | None, typer.Option("--class", metavar="EM1")] = None,
    out_folder: Out = None,
    settings: Settings = None,
) -> None:
    """Put a seat to the test of ISO 7096: SEAT factors of two drivers, damping, end stops.

    Options:
        source: The scenario of a seat, or a recording of one.
        spectral_class: Only this class; may be given several times.
    """
    from seatsim.cli.outputs.damper_results import present_seat_test
    from seatsim.standards.seat_test import seat_test as test

    with count_progress("simulating") as count:
        found = test(source, spectral_class or (), scenario_settings(settings), count)
    present_seat_test(found, Path(source), out_folder or Path("out") / f"seat-test-{Path(source).stem}")
    if found.failures:
        raise typer.Exit(1)
