"""What `seatsim characterise`, `identify`, `comfort` and `seat-test` print and write."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

import typer

from seatsim.characterisation.sheet import list_tables
from seatsim.characterisation.summary import Characterisation
from seatsim.cli.outputs.writing import name_pictures, write_each, write_outputs
from seatsim.cli.show_table import show_report_tables
from seatsim.cli.terminal import complain, conclude, say, show_progress, warn
from seatsim.identification.identify import Identification, League, benchmark_models, identify
from seatsim.identification.settings import IdentificationSettings
from seatsim.plots.bench.characterisation import plot_characterisation
from seatsim.plots.bench.identification import plot_predictions
from seatsim.plots.bench.vibration import plot_vibration
from seatsim.recordings.bench_tables import BenchRecord
from seatsim.report import dampers as report
from seatsim.report import standards
from seatsim.report.blocks import tabulate
from seatsim.schema.files import write_together
from seatsim.schema.yaml_text import dump
from seatsim.standards.comfort import Comfort
from seatsim.standards.seat_rows import SeatTest


def present_comfort(found: Comfort, source: Path, folder: Path) -> None:
    """Print the figures of a vibration; write `comfort.json`, `report.html` and the pictures."""
    show_report_tables([*standards.tabulate_axes(found), *standards.tabulate_seat(found)])
    for sentence in standards.list_comfort_sentences(found):
        say(sentence)
    warn(found.notes)
    figures = plot_vibration(found)
    report = standards.report_comfort(found, figures, f"seatsim comfort {source.name}")
    contents = {"comfort.json": found, "report.html": report, **name_pictures(figures)}
    conclude(found, folder, write_outputs(folder, contents))


def present_seat_test(found: SeatTest, source: Path, folder: Path) -> None:
    """Print the lines of a seat test and which came to no result; write `seat_test.json` and `report.html`."""
    show_report_tables([*standards.tabulate_classes(found.rows), *standards.tabulate_damping(found.damping_rows)])
    say(standards.say_seat_test(found))
    for each in found.failures:
        complain(f"failed: {', '.join(filter(None, (each.run, each.spectral_class, each.person)))}: {each.reason}")
    warn(found.notes)
    command = f"seatsim seat-test {source.name}"
    report = standards.report_seat_test(found, source.resolve().stem, command)
    conclude(found, folder, write_outputs(folder, {"seat_test.json": found, "report.html": report}))


_TIMES = ("seconds", "ns_per_step")
"""What a fit and a step took, which differs each time."""
_HEAD = """\
# Found by `seatsim identify`. `damper` and `actuator` are as a scenario has them; under `bench`: the displacement [m]
# that counts as zero, and the growth of the offset with temperature [N/K].
"""
_NO_COIL = "# No command that changes was recorded: the rates of the actuator are defaults.\n"


def present_characterisation(found: Characterisation, folder: Path) -> None:
    """Print cycles, steps and limits; write `characterisation.json`, `.xlsx`, the report and pictures."""
    show_report_tables([*report.tabulate_rows(found), *report.tabulate_responses(found.sheet)])
    for check in found.sheet.limits:
        (say if check.passes else complain)(str(check))
    warn(found.remarks)
    figures = plot_characterisation(found)
    contents = {
        "characterisation.json": found,
        "characterisation.xlsx": list_tables(found.sheet),
        "report.html": report.report_characterisation(found, figures, f"seatsim characterise {found.source}"),
        **name_pictures(figures),
    }
    conclude(found, folder, write_outputs(folder, contents))


def identify_damper(records: Sequence[BenchRecord], model: str, settings: IdentificationSettings, folder: Path) -> None:
    """Fit a model to a damper; print and write how well it agrees, and its parameters."""
    with show_progress() as progress:
        found = identify(records, model, settings, progress)
        paths = write_identification(found, folder, settings.seed)
    show_report_tables([*report.tabulate_fit(found), *report.tabulate_parameters(found)])
    warn(found.notes)
    conclude(found, folder, paths)


def write_identification(found: Identification, folder: str | Path, seed: int = 0) -> list[Path]:
    """Write `parameters.yaml`, `fit.json`, `report.html` and the picture of an identification; return their paths."""
    return write_outputs(Path(folder), _contents_of_fit(found), seed, {"fit.json": _TIMES})


def _contents_of_fit(found: Identification) -> dict[str, object]:
    figures = {"loops": plot_predictions(found)}
    return {
        "parameters.yaml": _HEAD + ("" if found.commanded else _NO_COIL) + dump(found.to_scenario(), line_each=True),
        "fit.json": found,
        "report.html": report.report_identification(found, figures, f"seatsim identify DATA --model {found.model}"),
        **name_pictures(figures),
    }


def compare_models(
    records: Sequence[BenchRecord],
    models: Sequence[str],
    settings: IdentificationSettings,
    folder: Path,
) -> None:
    """Fit several models, each in a folder of its name, print and write the league; exit 1 where one failed."""

    def keep(found: Identification) -> None:
        write_together(folder / found.model.rpartition(":")[2], partial(write_each, _contents_of_fit(found)))

    with show_progress() as progress:
        places = benchmark_models(records, models, settings, progress, keep)
    rows = []
    for each in places:
        fits, cost = (each.train_fit_percent, each.test_fit_percent), (each.ns_per_step, each.seconds)
        rows.append((each.model, each.confidence, *fits, str(each.parameters), *cost))
    head = "model, confidence, train [%], test [%], parameters, ns a step, s"
    show_report_tables(tabulate("Models, the best first", head, rows, 2))
    failed = [place for place in places if place.failed]
    for place in failed:
        complain(f"failed: {place.failed}")
    contents = {"league.csv": [place._asdict() for place in places]}
    conclude(League(places), folder, write_outputs(folder, contents, settings.seed, {"league.csv": _TIMES}))
    if failed:
        raise typer.Exit(1)
