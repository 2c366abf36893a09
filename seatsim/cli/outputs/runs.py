"""Files of a result: table, histories, pictures."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from seatsim.schema.files import write_json, write_whole
from seatsim.simulation.performance_bounds import distance
from seatsim.simulation.result import UNITS, Result, Run

if TYPE_CHECKING:
    from matplotlib.figure import Figure

RESOLUTION = 110
"""Points per inch of a picture."""


def write_result(result: Result, folder: Path) -> list[Path]:
    """Write `summary.csv`, `summary.json`, `history.parquet` and the pictures of a result; return their paths."""
    with ThreadPoolExecutor(max_workers=1) as pool:
        # Compressing the histories leaves the processor to the pictures.
        history = pool.submit(write_whole, folder / "history.parquet", partial(_write_history, result))
        from seatsim.plots.runs.draw import draw

        paths = [
            write_whole(folder / "summary.csv", partial(result.table.to_csv, index=False)),
            write_json(folder / "summary.json", {"runs": [_summary(run) for run in result.runs]}),
        ]
        pictures = write_pictures(draw(result), folder)
        if result.brackets:
            paths.append(write_json(folder / "brackets.json", {"rigs": _bounds(result)}))
        return [*paths, history.result(), *pictures]


def write_pictures(figures: Mapping[str, Figure], folder: Path) -> list[Path]:
    """Write figures as `NAME.png` and return their paths."""
    return [write_whole(folder / f"{name}.png", partial(_save, figure)) for name, figure in figures.items()]


def _save(figure: Figure, path: Path) -> None:
    """Save a picture with neither date nor version, so that the same result gives the same bytes."""
    figure.savefig(path, dpi=RESOLUTION, metadata={"Software": "seatsim"}, pil_kwargs={"compress_level": 3})


def _bounds(result: Result) -> list[dict[str, object]]:
    """Return for each rig its bracket, and for each of its runs where that stands."""
    found = []
    for rig, bracket in result.brackets.items():
        runs = [run for run in result.runs if run.scenario.rig == rig]
        found.append(
            {
                **bracket.as_dict(),
                "runs": [
                    {
                        "scenario": run.scenario.name,
                        "label": dict(run.scenario.label),
                        **distance(run, bracket)._asdict(),
                    }
                    for run in runs
                ],
            }
        )
    return found


def _summary(run: Run) -> dict[str, object]:
    metrics = {name: {"value": m.value, "unit": m.unit, "meaning": m.meaning} for name, m in run.metrics.items()}
    return {
        "scenario": run.scenario.name,
        "label": dict(run.scenario.label),
        "metrics": metrics,
        "warnings": list(run.warnings),
        "notes": list(run.history.notes),
    }


def _write_history(result: Result, path: Path) -> None:
    """Write all runs below each other, a column a channel in single precision, units in the columns' metadata."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    fields = [pa.field("run", pa.dictionary(pa.int32(), pa.string()))]
    fields += [
        pa.field(name, pa.float64() if name == "time" else pa.float32(), metadata={"unit": unit})
        for name, unit in UNITS.items()
    ]
    schema = pa.schema(fields)
    with pq.ParquetWriter(path, schema, compression="zstd", compression_level=1) as writer:
        for run in result.runs:
            length = len(run.history["time"])
            titles = pa.DictionaryArray.from_arrays(np.zeros(length, dtype=np.int32), [run.scenario.title])
            columns = [pa.array(run.history[name], type=schema.field(name).type) for name in UNITS]
            writer.write_table(pa.Table.from_arrays([titles, *columns], schema=schema))
