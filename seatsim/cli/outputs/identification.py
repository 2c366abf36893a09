"""Identifications on disk and on the terminal: `parameters.yaml`, `fit.json`, `league.csv`, pictures, tables."""

from __future__ import annotations

import io
import math
from collections import Counter
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from rich import box
from rich.markup import escape
from rich.table import Table
from ruamel.yaml import YAML

from seatsim.cli.outputs.runs import write_pictures
from seatsim.dampers.base import OWN, find_confidence
from seatsim.identification.assessment import Agreement
from seatsim.identification.identify import Identification
from seatsim.identification.model_benchmark import BenchmarkEntry
from seatsim.provenance.manifest import write_documented
from seatsim.report.identification import report_identification
from seatsim.report.rendering import write_html
from seatsim.schema.files import write_json, write_text, write_together, write_whole
from seatsim.schema.text import disarm

MEASURED = ("seconds", "ns_per_step")
"""What a fit and a step took, which differs each time."""
LISTED = 40
"""Most records of the table on the terminal."""
HEAD = """\
# Found by `seatsim identify`. `damper` and `actuator` are as a scenario has them; under `bench`: the displacement [m]
# that counts as zero, and the growth of the offset with temperature [N/K].
"""
NO_COIL = "# No command that changes was recorded: the rates of the actuator are defaults.\n"


def write_identification(found: Identification, folder: str | Path, seed: int = 0) -> list[Path]:
    """Write `parameters.yaml`, `fit.json`, `report.html` and the picture of an identification; return their paths."""
    return write_documented(Path(folder), partial(_fill, found), seed, {"fit.json": MEASURED})


def write_member(found: Identification, folder: Path) -> list[Path]:
    """Write the same files of one model of a league, whose folder has no manifest of its own."""
    return write_together(folder, partial(_fill, found))


def _fill(found: Identification, folder: Path) -> list[Path]:
    from seatsim.plots.bench.identification import plot_predictions

    text = io.StringIO(HEAD + ("" if found.commanded else NO_COIL))
    text.seek(0, io.SEEK_END)
    yaml = YAML()
    yaml.default_flow_style = False
    yaml.dump(encode_parameters(found), text)
    report = report_identification(found, f"seatsim identify DATA --model {found.model}")
    return [
        write_text(folder / "parameters.yaml", text.getvalue()),
        write_json(folder / "fit.json", encode_identification(found)),
        write_html(report, folder / "report.html"),
        *write_pictures({"loops": plot_predictions(found)}, folder),
    ]


def encode_parameters(found: Identification) -> dict[str, object]:
    """Return the damper and its coil as a scenario has them, with what else the bench needs under `bench`."""
    bench = found.bench
    values = {
        name: list(map(float, value)) if isinstance(value, tuple) else value if isinstance(value, int) else float(value)
        for name, value in bench.damper._asdict().items()
    }
    damper: dict[str, object] = {"model": found.model, "parameters": values}
    if found.warm:
        damper["temperature_factors"] = {name: float(value) for name, value in bench.factors._asdict().items()}
    end = max(float(each.record.current.max()) for each in found.assessments if each.part != "predicted")
    return {
        "damper": damper,
        "actuator": {"rate": float(bench.rise), "rate_fall": float(bench.fall), "max_current": end or 1.0},
        "bench": {"displacement_origin": found.origin, "offset_per_kelvin": float(bench.offset_per_kelvin)},
    }


def encode_identification(found: Identification) -> dict[str, object]:
    """Return what `fit.json` holds; `test` is null where nothing was held out."""
    records = {
        name: {"part": each.part, "current": each.record.mean_current, **each.agreement._asdict()}
        for name, each in zip(_name_records(found), found.assessments, strict=True)
    }
    known = found.information
    further = {"predicted": found.mean("predicted")} if found.mean("predicted") else {}
    return {
        "model": found.model,
        "confidence": find_confidence(type(found.bench.damper)),
        "train": found.mean("train"),
        "test": found.mean("test"),
        **further,
        "records": records,
        "parameters": known.estimates,
        "not_identified": [estimate.name for estimate in known.estimates if not estimate.identified],
        "correlated": known.correlated,
        "coverage": found.coverage,
        "effective_samples": known.samples,
        "bic": found.bic,
        "seconds": found.seconds,
        "ns_per_step": found.ns_per_step,
        "notes": found.notes,
    }


def _name_records(found: Identification) -> list[str]:
    """Return the names of the assessed records, with the part they had where names alone are ambiguous."""
    names = [each.record.name for each in found.assessments]
    full = [
        f"{name} ({each.part})" if names.count(name) > 1 else name
        for name, each in zip(names, found.assessments, strict=True)
    ]
    seen: Counter[str] = Counter()
    for k, name in enumerate(full):
        seen[name] += 1
        full[k] = f"{name} {seen[name]}" if seen[name] > 1 else name
    return full


def make_tables(found: Identification) -> list[Table]:
    """Return the tables of figures and of parameters."""
    figures = _make_table(f"{found.model}: agreement with the measured force", ("", "R²", "MD", "RMSE [N]", "fit [%]"))
    for judged in found.assessments if len(found.assessments) <= LISTED else ():
        figures.add_row(f"{escape(judged.record.name)} ({judged.part})", *_format_figures(judged.agreement))
    figures.add_section()
    for part in ("train", "test", "predicted"):
        mean = found.mean(part)
        if mean:
            figures.add_row(f"mean, {part}", *_format_figures(mean))
    values = _make_table(f"{found.model}: parameters, ±1.96 standard deviations", ("", "value", "±", "unit", ""))
    for estimate in found.information.estimates:
        note = "" if estimate.identified else "not identified"
        row = (f"{estimate.value:.5g}", f"{1.96 * estimate.std:.2g}", escape(estimate.unit), note)
        values.add_row(escape(estimate.name), *row)
    return [figures, values]


def write_league(places: Sequence[BenchmarkEntry], folder: Path, seed: int) -> list[Path]:
    """Write `league.csv`, the best model first."""
    import pandas as pd

    frame = pd.DataFrame([place._asdict() for place in places])
    write = partial(frame.map(disarm).to_csv, index=False)
    return write_documented(
        folder, lambda part: [write_whole(part / "league.csv", write)], seed, {"league.csv": MEASURED}
    )


def make_league_table(places: Sequence[BenchmarkEntry]) -> Table:
    """Return the benchmark of models as a table."""
    table = _make_table("league", ("model", "train [%]", "test [%]", "parameters", "ns a step", "BIC", "s"))
    for place in places:
        name = f"{place.model} ({OWN})" if place.confidence == OWN else place.model
        if place.failed:
            table.add_row(name, *["-"] * 6)
            continue
        fits = [
            f"{fit:.1f}" if math.isfinite(fit) else "-" for fit in (place.train_fit_percent, place.test_fit_percent)
        ]
        rest = (place.ns_per_step, place.bic, place.seconds)
        table.add_row(name, *fits, str(place.parameters), *(f"{value:.0f}" for value in rest))
    return table


def _make_table(title: str, headings: Sequence[str]) -> Table:
    table = Table(title=escape(title), title_justify="left", box=box.SIMPLE_HEAD)
    for k, heading in enumerate(headings):
        table.add_column(escape(heading), justify="right" if k and heading not in ("unit", "") else "left")
    return table


def _format_figures(figures: Agreement) -> tuple[str, ...]:
    return f"{figures.r2:.4f}", f"{figures.md:.3f}", f"{figures.rmse:.1f}", f"{figures.fit_percent:.1f}"
