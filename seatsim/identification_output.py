"""Identifications on disk and on the terminal: `parameters.yaml`, `fit.json`, `league.csv`, pictures, tables."""

from __future__ import annotations

import io
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from rich import box
from rich.markup import escape
from rich.table import Table
from ruamel.yaml import YAML

from seatsim.files import write_json, write_text, write_whole
from seatsim.identification.figures import Figures
from seatsim.identification.identify import Identification
from seatsim.identification.league import Place
from seatsim.output import PICTURE

PARTS = ("train", "test", "predicted")
LISTED = 40
"""Most records of the table on the terminal."""


def write_identification(found: Identification, folder: Path) -> list[Path]:
    """Write `parameters.yaml`, `fit.json` and the picture of an identification; return their paths."""
    from seatsim.plots.identification import loops

    text = io.StringIO()
    YAML(typ="safe", pure=True).dump(parameters(found), text)
    paths = [
        write_text(folder / "parameters.yaml", text.getvalue()),
        write_json(folder / "fit.json", contents(found)),
    ]
    figure = loops(found)
    return [*paths, write_whole(folder / "loops.png", partial(figure.savefig, **PICTURE))]


def parameters(found: Identification) -> dict[str, Any]:
    """Return the damper and its coil as a scenario has them, with what else the bench needs under `bench`."""
    bench = found.bench
    values = {
        name: list(map(float, value)) if isinstance(value, tuple) else value if isinstance(value, int) else float(value)
        for name, value in bench.damper._asdict().items()
    }
    result: dict[str, Any] = {"damper": {"model": found.model, "parameters": values}}
    if found.warm:
        result["damper"]["temperature_factors"] = {k: float(v) for k, v in bench.factors._asdict().items()}
    end = max(float(judged.record.current.max()) for judged in found.judged)
    result["actuator"] = {"rate": float(bench.rise), "rate_fall": float(bench.fall), "max_current": end or 1.0}
    result["bench"] = {"displacement_origin": found.origin, "offset_per_kelvin": float(bench.warming)}
    return result


def contents(found: Identification) -> dict[str, Any]:
    """Return what `fit.json` holds."""
    means = {part: found.mean(part) for part in PARTS}
    known = found.information
    records = {
        f"{judged.record.name} ({judged.part})" if _twice(found, judged.record.name) else judged.record.name: {
            "part": judged.part, "current": judged.record.mean_current, **judged.figures._asdict()
        }
        for judged in found.judged
    }  # fmt: skip
    return {
        "model": found.model,
        **{part: figures._asdict() for part, figures in means.items() if figures},
        "records": records,
        "parameters": [estimate._asdict() for estimate in known.estimates],
        "not_identified": [estimate.name for estimate in known.estimates if not estimate.identified],
        "correlated": known.correlated,
        "coverage": found.coverage,
        "effective_samples": known.samples,
        "bic": found.bic,
        "seconds": found.seconds,
        "ns_per_step": found.ns_per_step,
        "notes": found.notes,
    }


def tables(found: Identification) -> list[Table]:
    """Return the tables of figures and of parameters."""
    figures = _table(f"{found.model}: agreement with the measured force", ("", "R²", "MD", "RMSE [N]", "fit [%]"))
    for judged in found.judged if len(found.judged) <= LISTED else ():
        figures.add_row(f"{escape(judged.record.name)} ({judged.part})", *_figures(judged.figures))
    figures.add_section()
    for part in PARTS:
        mean = found.mean(part)
        if mean:
            figures.add_row(f"mean, {part}", *_figures(mean))
    values = _table(f"{found.model}: parameters, ±1.96 standard deviations", ("", "value", "±", "unit", ""))
    for estimate in found.information.estimates:
        note = "" if estimate.identified else "not identified"
        row = (f"{estimate.value:.5g}", f"{1.96 * estimate.std:.2g}", escape(estimate.unit), note)
        values.add_row(escape(estimate.name), *row)
    return [figures, values]


def write_league(places: Sequence[Place], folder: Path) -> Path:
    """Write `league.csv`, the best model first."""
    import pandas as pd

    frame = pd.DataFrame([place._asdict() for place in places])
    return write_whole(folder / "league.csv", partial(frame.to_csv, index=False))


def league_table(places: Sequence[Place]) -> Table:
    """Return the league as a table."""
    table = _table("league", ("model", "train [%]", "test [%]", "parameters", "ns a step", "BIC", "s"))
    for place in places:
        if place.failed:
            table.add_row(place.model, *["-"] * 5, escape(place.failed))
            continue
        row = (place.train_fit_percent, place.test_fit_percent, place.parameters, place.ns_per_step, place.bic)
        forms = (".1f", ".1f", ".0f", ".0f", ".0f")
        cells = ["-" if value is None else format(value, form) for value, form in zip(row, forms, strict=True)]
        table.add_row(place.model, *cells, f"{place.seconds:.0f}")
    return table


def _table(title: str, headings: Sequence[str]) -> Table:
    table = Table(title=escape(title), title_justify="left", box=box.SIMPLE_HEAD)
    for k, heading in enumerate(headings):
        table.add_column(escape(heading), justify="right" if k and heading not in ("unit", "") else "left")
    return table


def _figures(figures: Figures) -> tuple[str, ...]:
    return f"{figures.r2:.4f}", f"{figures.md:.3f}", f"{figures.rmse:.1f}", f"{figures.fit_percent:.1f}"


def _twice(found: Identification, name: str) -> bool:
    return sum(judged.record.name == name for judged in found.judged) > 1
