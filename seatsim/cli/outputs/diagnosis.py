"""Diagnoses on disk and on the terminal: `diagnosis.json`, `augmented.yaml`, `report.html`, and tables."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

from rich.table import Table
from ruamel.yaml import YAML

from seatsim.cli.gap_table import show_floor
from seatsim.diagnosis.diagnose import diagnose
from seatsim.diagnosis.result import Diagnosis, GapFigures, RunGaps
from seatsim.effects.base import EFFECTS
from seatsim.provenance.manifest import write_documented
from seatsim.report.diagnosis import write_report
from seatsim.scenario.loading import single
from seatsim.schema.errors import SeatsimError
from seatsim.schema.files import plain, write_json, write_whole
from seatsim.schema.leftovers import temporary_folder
from seatsim.schema.processes import run_jobs
from seatsim.schema.registry import is_own

PROCESSES = 2
"""Recordings of a set that are diagnosed at once."""
LISTED = 6
"""Causes in the table."""


def write_diagnosis(diagnosis: Diagnosis, folder: Path) -> list[Path]:
    """Write `diagnosis.json`, `augmented.yaml`, `report.html`, and `experiment.yaml` where one is proposed.

    Raises:
        InputError: a scenario that was found could not be loaded again, or the folder cannot be written.
    """
    scenarios = {"augmented.yaml": dict(diagnosis.augmented)}
    if diagnosis.experiment is not None and diagnosis.experiment.scenario is not None:
        scenarios["experiment.yaml"] = dict(diagnosis.experiment.scenario)
    dump = YAML(typ="safe").dump
    with temporary_folder() as drafts:
        for name, content in scenarios.items():
            dump(content, Path(drafts) / name)
            single(Path(drafts) / name)
    return write_documented(
        folder,
        lambda part: [
            *(write_whole(part / name, partial(dump, content)) for name, content in scenarios.items()),
            write_report(diagnosis, part / "report.html"),
            write_json(part / "diagnosis.json", encode_diagnosis(diagnosis)),
        ],
    )


def encode_diagnosis(diagnosis: Diagnosis) -> dict[str, object]:
    """Return a diagnosis as it stands in `diagnosis.json`, whose keys the public contract fixes."""
    gap = diagnosis.gap
    experiment = None if diagnosis.experiment is None else diagnosis.experiment.as_dict()
    fields = {
        "verdict": diagnosis.verdict, "sentence": diagnosis.sentence, "where": diagnosis.where,
        "causes": diagnosis.causes, "probability_none": diagnosis.probability_none,
        "probability_unknown": diagnosis.probability_unknown, "selected": diagnosis.selected,
        "indistinguishable": diagnosis.indistinguishable, "experiment": experiment,
        "held_out": diagnosis.held_out, "isolable": diagnosis.isolable,
        "gap": {
            "before": gap.before.as_dict(), "calibrated": gap.calibrated.as_dict(), "after": gap.after.as_dict(),
            "floor": gap.floor.as_dict(),
            "shrink": gap.shrink, "shrink_interval": list(gap.shrink_interval),
            "by_run": [_encode_run(each) for each in diagnosis.by_run],
        },
        "alternatives": diagnosis.alternatives, "calibrated_parameters": diagnosis.parameters,
        "model_error": None if diagnosis.model_error is None else diagnosis.model_error.as_dict(),
        "error_budget": diagnosis.error_budget, "notes": diagnosis.notes, "augmented": "augmented.yaml",
    }  # fmt: skip
    return {name: plain(value) for name, value in fields.items()}


def _encode_run(gaps: RunGaps) -> dict[str, object]:
    """Return the gaps of a run, figures by name as they stand for the held-out run."""
    return {name: value.as_dict() if isinstance(value, GapFigures) else value for name, value in gaps._asdict().items()}


def make_tables(diagnosis: Diagnosis) -> list[Table]:
    """Return the gaps, the likeliest causes and, where they were tried, other forms of the damper as tables."""
    gap = diagnosis.gap
    gaps = Table(title=f"gap on {', '.join(diagnosis.held_out)}, in standard deviations", title_justify="left")
    for heading in ("channel", "nominal", "refitted", "with effects", "noise floor"):
        gaps.add_column(heading, justify="left" if heading == "channel" else "right")
    columns = (gap.before, gap.calibrated, gap.after)
    for name in gap.before.channels:
        gaps.add_row(
            name, *(f"{column.channels[name]:.4f}" for column in columns), show_floor(gap.floor.channels[name])
        )
    gaps.add_section()
    gaps.add_row("overall", *(f"{column.overall:.4f}" for column in columns), show_floor(gap.floor.overall))
    ranked = Table(title=f"verdict: {diagnosis.verdict}", title_justify="left")
    listed = diagnosis.causes[:LISTED]
    for heading in ("effect", "probability", "own shrink"):
        ranked.add_column(heading, justify="left" if heading == "effect" else "right")
    if any(cause.ends for cause in listed):
        ranked.add_column("at end of range")
    for cause in listed:
        figures = f"{cause.probability:.2f}", f"{cause.shrink:.2f}"
        ranked.add_row(_label(cause.effect), *figures, *([", ".join(cause.ends)] if cause.ends else []))
    ranked.add_row("none", f"{diagnosis.probability_none:.2f}", "")
    ranked.add_row("unknown", f"{diagnosis.probability_unknown:.2f}", "")
    return [gaps, ranked, *([_make_forms_table(diagnosis)] if diagnosis.alternatives else [])]


def _label(effect: str) -> str:
    """Return the name of an effect, marked where it is the user's own."""
    return f"{effect} (own)" if effect in EFFECTS.names() and is_own(EFFECTS.find(effect)) else effect


def _make_forms_table(diagnosis: Diagnosis) -> Table:
    replaced = diagnosis.alternatives[0].replaces
    table = Table(title=f"other forms of the damper than {replaced}", title_justify="left")
    for heading in ("form", "beside", "shrink", f"{replaced} as free"):
        table.add_column(heading, justify="right" if heading not in ("form", "beside") else "left")
    for form in diagnosis.alternatives[:LISTED]:
        table.add_row(form.model, ", ".join(form.beside), f"{form.shrink:.2f}", f"{form.refitted:.2f}")
    return table


def diagnose_all(folder: Path, count: Callable[[int, int], None]) -> None:
    """Diagnose every case of a folder that has no diagnosis yet, into `CASE/diagnosis`; may be taken up again."""
    cases = sorted(path.parent for path in folder.glob("case-*/recording.yaml"))
    open_cases = [case for case in cases if not (case / "diagnosis" / "diagnosis.json").exists()]
    count(len(cases) - len(open_cases), len(cases))
    jobs, kept = [(case,) for case in open_cases], len(cases) - len(open_cases)
    run_jobs(diagnose_one, jobs, PROCESSES, lambda done, _: count(kept + done, len(cases)))


def diagnose_one(case: Path) -> None:
    """Diagnose one case; one that cannot be diagnosed is left without, and counts as wrong."""
    try:
        write_diagnosis(diagnose(case), case / "diagnosis")
    except SeatsimError as error:
        write_json(case / "diagnosis" / "error.json", {"error": str(error)})
