"""The commands on measured dampers: characterise, identify."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, cast

import typer

from seatsim.cli.options import Out, complete_kind, pairs
from seatsim.cli.terminal import show_progress


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
