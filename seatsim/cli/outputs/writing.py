"""How commands write what they found: the files of a folder together, each in the way of its ending."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from seatsim.cli.outputs.printing import print_reports
from seatsim.cli.outputs.workbook import write_workbook
from seatsim.provenance.statement import Measured, write_documented
from seatsim.report.rendering import write_html
from seatsim.schema.content import to_content
from seatsim.schema.files import write_json, write_text, write_together, write_whole
from seatsim.schema.guarded import temporary_folder
from seatsim.schema.text import disarm
from seatsim.schema.yaml_text import dump

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from seatsim.characterisation.summary import Characterisation
    from seatsim.diagnosis.result import Diagnosis
    from seatsim.identification.identify import Identification
    from seatsim.identification.model_benchmark import BenchmarkEntry
    from seatsim.identification.specimens import Specimens
    from seatsim.recordings.gap import Gap
    from seatsim.standards.comfort import Comfort
    from seatsim.standards.seat_rows import SeatTest


_Row = Mapping[str, object]


def write_outputs(
    folder: Path, contents: Mapping[str, object], seed: int | None = None, measured: Measured | None = None
) -> list[Path]:
    """Write files with a manifest, all or none, and return their paths.

    Args:
        folder: where they go.
        contents: by name of the file a record (.json), rows or a frame (.csv), tables (.xlsx), a report (.html), a
            figure (.png) or text (.yaml).
        seed: as for `write_documented`.
        measured: the same.
    """
    return print_reports(write_documented(folder, partial(write_each, contents), seed, measured))


def write_each(contents: Mapping[str, object], folder: Path) -> list[Path]:
    """Write the files of `write_outputs` to a folder, one after the other; return their paths."""
    return [_WRITERS[Path(name).suffix](folder / name, content) for name, content in contents.items()]


def name_pictures(figures: Mapping[str, object]) -> dict[str, object]:
    """Return figures by the names of their files."""
    return {f"{name}.png": figure for name, figure in figures.items()}


def _write_rows(path: Path, content: Sequence[_Row] | pd.DataFrame) -> Path:
    """Write rows below each other, with a column for every name; what is absent or NaN stays empty."""

    def write(part: Path) -> None:
        rows: Iterable[Sequence[object]]
        if isinstance(content, Sequence):
            names = list(dict.fromkeys(name for row in content for name in row))
            rows = ([row.get(name, "") for name in names] for row in content)
        else:
            names, rows = list(content.columns), content.itertuples(index=False)
        with part.open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(map(disarm, names))
            writer.writerows(map(_cell, row) for row in rows)

    return write_whole(path, write)


def _cell(value: object) -> object:
    return "" if isinstance(value, float) and math.isnan(value) else disarm(value)


def _write_picture(path: Path, figure: Figure) -> Path:
    from seatsim.plots.saving import save_figure

    return write_whole(path, partial(save_figure, figure))


_WRITERS: Mapping[str, Callable[[Path, Any], Path]] = {
    ".json": write_json,
    ".csv": _write_rows,
    ".html": lambda path, report: write_html(report, path),
    ".png": _write_picture,
    ".xlsx": write_workbook,
    ".yaml": write_text,
}
"""Writers by the ending of a file."""


_TIMES = ("seconds", "ns_per_step")
"""What a fit and a step took, which differs each time."""
_HEAD = """\
# Found by `seatsim identify`. `damper` and `actuator` are as a scenario has them; under `bench`: the displacement [m]
# that counts as zero, and the growth of the offset with temperature [N/K].
"""
_MEAN = """\
# Mean of the specimens that `seatsim identify` found, as a scenario has it; those of `specimens.yaml` vary about it.
"""
_NO_COIL = "# No command that changes was recorded: the rates of the actuator are defaults.\n"


def write_gap(found: Gap, scenario: str, recording: Path, folder: Path) -> list[Path]:
    """Write `gap.json`, and `report.html` where outputs were measured; return their paths.

    Args:
        found: the gap.
        scenario: file or name of the scenario that was replayed.
        recording: folder of the recording.
        folder: where the files go.
    """
    from seatsim.report.gap import judge_gap, report_gap

    contents: dict[str, object] = {"gap.json": found}
    if found.channels:
        name = f"{Path(scenario).stem} against {recording.resolve().name}"
        command = f"seatsim gap {Path(scenario).name} {recording.name}"
        factors = judge_gap(scenario, recording, found)
        contents["report.html"] = report_gap(name, found, found.replayed, factors, command)
    return write_outputs(folder, contents)


def write_diagnosis(diagnosis: Diagnosis, folder: Path) -> list[Path]:
    """Write `diagnosis.json`, `augmented.yaml`, `report.html`, and `experiment.yaml` where one is proposed.

    Raises:
        InputError: a scenario that was found could not be loaded again, or the folder cannot be written.
    """
    from seatsim.report.diagnosis import report_diagnosis
    from seatsim.scenario.loading import single

    scenarios = {"augmented.yaml": dump(diagnosis.augmented, line_each=True)}
    if diagnosis.experiment is not None and diagnosis.experiment.scenario is not None:
        scenarios["experiment.yaml"] = dump(diagnosis.experiment.scenario, line_each=True)
    with temporary_folder() as drafts:
        for name, text in scenarios.items():
            single(write_text(Path(drafts) / name, text))
    report = report_diagnosis(diagnosis)
    return write_outputs(folder, {**scenarios, "report.html": report, "diagnosis.json": diagnosis})


def write_characterisation(found: Characterisation, folder: Path) -> list[Path]:
    """Write `cycles.csv`, `characterisation.json` and `.xlsx`, `report.html` and the pictures; return their paths."""
    from seatsim.characterisation.rows import row_columns
    from seatsim.characterisation.sheet import list_tables
    from seatsim.plots.bench.characterisation import plot_characterisation
    from seatsim.report.characterisation import report_characterisation

    command = f"seatsim characterise {found.source}" if found.measured else f"seatsim characterise --model {found.name}"
    figures = plot_characterisation(found)
    contents = {
        "cycles.csv": [row_columns(row) for row in found.rows],
        "characterisation.json": found,
        "characterisation.xlsx": list_tables(found.sheet),
        "report.html": report_characterisation(found, figures, found.remarks, command),
        **name_pictures(figures),
    }
    return write_outputs(folder, contents)


def write_identification(found: Identification, folder: str | Path, seed: int = 0) -> list[Path]:
    """Write `parameters.yaml`, `fit.json`, `report.html` and the picture of an identification; return their paths."""
    return write_outputs(Path(folder), _contents_of_fit(found), seed, {"fit.json": _TIMES})


def write_member(found: Identification, folder: Path) -> list[Path]:
    """Write the same files of one model of a league, whose folder has no manifest of its own."""
    return write_together(folder, partial(write_each, _contents_of_fit(found)))


def _contents_of_fit(found: Identification) -> dict[str, object]:
    from seatsim.plots.bench.identification import plot_predictions
    from seatsim.report.identification import report_identification

    figures = {"loops": plot_predictions(found)}
    return {
        "parameters.yaml": _HEAD + ("" if found.commanded else _NO_COIL) + dump(found.to_scenario(), line_each=True),
        "fit.json": found,
        "report.html": report_identification(found, figures, f"seatsim identify DATA --model {found.model}"),
        **name_pictures(figures),
    }


def write_specimens(found: Specimens, folder: Path, seed: int) -> list[Path]:
    """Write `damper.yaml`, the mean damper, and `specimens.yaml`, the values of each specimen."""
    contents = {"damper.yaml": _MEAN + dump(found.damper, line_each=True), "specimens.yaml": dump(to_content(found))}
    return write_outputs(folder, contents, seed)


def write_league(places: Sequence[BenchmarkEntry], folder: Path, seed: int) -> list[Path]:
    """Write `league.csv`, the best model first."""
    return write_outputs(folder, {"league.csv": [place._asdict() for place in places]}, seed, {"league.csv": _TIMES})


def write_comfort(found: Comfort, source: Path, folder: Path) -> list[Path]:
    """Write `comfort.json`, `report.html` and the pictures; return their paths."""
    from seatsim.plots.bench.vibration import plot_vibration
    from seatsim.report.comfort import report_comfort

    figures = plot_vibration(found)
    report = report_comfort(found, figures, f"seatsim comfort {source.name}")
    return write_outputs(folder, {"comfort.json": found, "report.html": report, **name_pictures(figures)})


def write_seat_test(found: SeatTest, source: Path, folder: Path) -> list[Path]:
    """Write `seat_test.json` and `report.html`; return their paths."""
    from seatsim.recordings.recording import HEADER
    from seatsim.report.seat_test import report_seat_test

    is_measured = (source / HEADER).exists()
    report = report_seat_test(found, source.resolve().stem, is_measured, f"seatsim seat-test {source.name}")
    return write_outputs(folder, {"seat_test.json": found, "report.html": report})
