"""What `seatsim characterise` and `seatsim identify` print and write."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

import typer

from seatsim.characterisation.sheet import list_tables
from seatsim.characterisation.summary import Characterisation
from seatsim.cli.outputs.writing import name_pictures, write_each, write_outputs
from seatsim.cli.show_table import format_number, make_table, show_report_tables, show_table
from seatsim.cli.terminal import complain, conclude, say, show_progress, warn
from seatsim.dampers.base import OWN
from seatsim.identification.identify import Identification, League, benchmark_models, identify
from seatsim.identification.settings import IdentificationSettings
from seatsim.plots.bench.characterisation import plot_characterisation
from seatsim.plots.bench.identification import plot_predictions
from seatsim.recordings.bench_tables import BenchRecord
from seatsim.report import dampers as report
from seatsim.schema.files import write_together
from seatsim.schema.yaml_text import dump

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
    for place in places:
        fits = [format_number(fit, ".1f") for fit in (place.train_fit_percent, place.test_fit_percent)]
        rest = [format_number(value, ".0f") for value in (place.ns_per_step, place.seconds)]
        count = "-" if place.failed else str(place.parameters)
        rows.append((f"{place.model} ({OWN})" if place.confidence == OWN else place.model, *fits, count, *rest))
    headings = ("model", "train [%]", "test [%]", "parameters", "ns a step", "s")
    show_table(make_table("league", headings, rows))
    failed = [place for place in places if place.failed]
    for place in failed:
        complain(f"failed: {place.failed}")
    contents = {"league.csv": [place._asdict() for place in places]}
    conclude(League(places), folder, write_outputs(folder, contents, settings.seed, {"league.csv": _TIMES}))
    if failed:
        raise typer.Exit(1)
