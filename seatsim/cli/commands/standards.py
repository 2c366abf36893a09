"""The commands that judge vibration by standards: comfort, seat-test."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from seatsim.cli.options import Json, Out, OwnCode, Pdf, Settings, scenario_settings
from seatsim.cli.terminal import complain, conclude, count_progress, say, warn
from seatsim.schema.errors import InputError


def comfort(
    file: Annotated[Path, typer.Argument(show_default=False)],
    channel: Annotated[list[str] | None, typer.Option("--channel", metavar="AXIS=COLUMN")] = None,
    hours: Annotated[list[str] | None, typer.Option("--hours", metavar="H or RUN=H")] = None,
    run: Annotated[list[str] | None, typer.Option("--run")] = None,
    block: Annotated[list[str] | None, typer.Option("--block", metavar="FROM:TO")] = None,
    rate: Annotated[float | None, typer.Option("--rate")] = None,
    unit: Annotated[str | None, typer.Option("--unit")] = None,
    out_folder: Out = None,
    pdf: Pdf = False,
    as_json: Json = False,
) -> None:
    """Work out the ISO 2631-1 figures of measured accelerations, a day's exposure and SEAT factors.

    Options:
        file: A CSV table of accelerations, or a recording.
        channel: x, y, z, rx .. on the seat, back.x .. feet.z, floor.z.
        hours: Hours of such vibration in a day (8), or of each run: RUN=H.
        run: A run of a recording; all together where none is named.
        block: Only this stretch, in s; several count as one.
        rate: Sample rate in Hz of a table without times.
        unit: Of columns whose names state none, such as g.
    """
    from seatsim.cli.outputs.seat_tables import make_comfort_tables
    from seatsim.cli.outputs.writing import write_comfort
    from seatsim.cli.show_table import show_table
    from seatsim.report.comfort import list_comfort_sentences
    from seatsim.standards.comfort import comfort as assess

    channels = _split_pairs(channel or [], "--channel", "z=acc_z")
    blocks = [_stretch(text) for text in block or []]
    day = _read_hours(hours or [])
    found = assess(file, channels, hours=day, runs=run or (), blocks=blocks, rate=rate, unit=unit)
    show_table(*make_comfort_tables(found))
    for sentence in list_comfort_sentences(found):
        say(sentence)
    warn(found.notes)
    folder = out_folder or Path("out") / f"comfort-{file.resolve().name.partition('.')[0]}"
    paths = write_comfort(found, file, folder)
    conclude(found, folder, paths)


def _read_hours(texts: list[str]) -> float | dict[str, float]:
    """Return the hours of a day, or of each run by its name."""
    named = len(texts) > 1 or "=" in "".join(texts)
    by_run = _split_pairs(texts, "--hours", "loading=3") if named else {}
    try:
        return {run: float(text) for run, text in by_run.items()} or float(texts[0] if texts else 8.0)
    except ValueError as error:
        raise InputError(f"--hours {' '.join(texts)}: write hours, like --hours 6 or --hours loading=3") from error


def _split_pairs(texts: list[str], option: str, example: str) -> dict[str, str]:
    found = dict[str, str]()
    for text in texts:
        name, value = _split(text, "=", option, example)
        if name in found:
            raise InputError(f"{option} {text}: {name} has {found[name]} already; give it once")
        found[name] = value
    return found


def _split(text: str, sign: str, option: str, example: str) -> tuple[str, str]:
    left, found, right = text.partition(sign)
    if not (left and found and right):
        raise InputError(f"{option} {text}: write it like {option} {example}")
    return left.strip(), right.strip()


def _stretch(text: str) -> tuple[float, float]:
    try:
        start, end = (float(part) for part in _split(text, ":", "--block", "10:70"))
    except ValueError as error:
        raise InputError(f"--block {text}: write seconds from the record's start, like --block 10:70") from error
    return start, end


def seat_test(
    source: Annotated[str, typer.Argument(show_default=False)],
    spectral_class: Annotated[list[str] | None, typer.Option("--class", metavar="EM1")] = None,
    out_folder: Out = None,
    settings: Settings = None,
    own_code: OwnCode = None,
    pdf: Pdf = False,
    as_json: Json = False,
) -> None:
    """Put a seat to the test of ISO 7096: SEAT factors of two drivers, damping, end stops.

    Options:
        source: The scenario of a seat, or a recording of one.
        spectral_class: Only this class; may be given several times.
    """
    from seatsim.cli.outputs.seat_tables import list_seat_test_failures, make_seat_test_tables, summarise_seat_test
    from seatsim.cli.outputs.writing import write_seat_test
    from seatsim.cli.show_table import show_table
    from seatsim.standards.seat_test import seat_test as test

    with count_progress("simulating") as count:
        found = test(source, spectral_class or (), scenario_settings(settings), count)
    show_table(*make_seat_test_tables(found))
    say(summarise_seat_test(found))
    for failure in list_seat_test_failures(found):
        complain(f"failed: {failure}")
    warn(found.notes)
    folder = out_folder or Path("out") / f"seat-test-{Path(source).stem}"
    paths = write_seat_test(found, Path(source), folder)
    conclude(found, folder, paths)
    if found.failures:
        raise typer.Exit(1)
