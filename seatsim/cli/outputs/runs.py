"""Files of a result: table, histories, pictures."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from seatsim.schema.files import write_json, write_whole
from seatsim.simulation.performance_bounds import measure_distance
from seatsim.simulation.result import UNITS, Result, Run

if TYPE_CHECKING:
    import pyarrow as pa
    from matplotlib.figure import Figure

DPI = 110
"""Dots per inch of a picture: 1100 over the width of a page."""
COMPRESSION = 3
"""Level of zlib, 0 to 9: fast rather than small."""


def write_result(result: Result, folder: Path) -> list[Path]:
    """Write `summary.csv`, `summary.json`, `history.parquet` and the pictures of a result; return their paths."""
    with ThreadPoolExecutor(max_workers=1) as pool:
        # Compressing the histories, in a thread of its own, releases Python's lock to the drawing of the pictures.
        history = pool.submit(write_whole, folder / "history.parquet", partial(_write_history, result))
        from seatsim.plots.runs.draw import plot_result

        paths = [
            write_whole(folder / "summary.csv", partial(_write_table, result.rows)),
            write_json(folder / "summary.json", _encode_runs(result)),
        ]
        pictures = write_pictures(plot_result(result), folder)
        if result.brackets:
            paths.append(write_json(folder / "brackets.json", {"rigs": _encode_brackets(result)}))
        return [*paths, history.result(), *pictures]


def encode_result(result: Result) -> dict[str, object]:
    """Return what `summary.json` holds of a result, with what `brackets.json` holds where there are bounds."""
    return _encode_runs(result) | ({"rigs": _encode_brackets(result)} if result.brackets else {})


def _encode_runs(result: Result) -> dict[str, object]:
    return {"runs": [_encode_summary(run) for run in result.runs]}


def write_pictures(figures: Mapping[str, Figure], folder: Path) -> list[Path]:
    """Write figures as `NAME.png` and return their paths; the same figure gives the same bytes."""
    # The stated software takes the place of matplotlib's own entry, which holds its version.
    metadata, options = {"Software": "seatsim"}, {"compress_level": COMPRESSION}
    return [
        write_whole(folder / f"{name}.png", partial(figure.savefig, dpi=DPI, metadata=metadata, pil_kwargs=options))
        for name, figure in figures.items()
    ]


def _encode_brackets(result: Result) -> list[dict[str, object]]:
    """Return for each rig its performance bounds, and for each of its runs how far from them it is."""
    found = []
    for rig, bracket in result.brackets.items():
        runs = [run for run in result.runs if run.scenario.rig == rig]
        standing = [_encode_name(run) | measure_distance(run, bracket)._asdict() for run in runs]
        found.append({**bracket.as_dict(), "runs": standing})
    return found


def _encode_name(run: Run) -> dict[str, object]:
    """Return the name of a run's scenario, and what sets the run apart from the others."""
    return {"scenario": run.scenario.name, "label": dict(run.scenario.label)}


def _encode_summary(run: Run) -> dict[str, object]:
    metrics = {name: {"value": m.value, "unit": m.unit, "meaning": m.meaning} for name, m in run.metrics.items()}
    return _encode_name(run) | {
        "metrics": metrics,
        "warnings": list(run.warnings),
        "notes": list(run.history.notes),
    }


def _write_table(rows: Sequence[Mapping[str, object]], path: Path) -> None:
    """Write rows below each other, with a column for every name; what is absent or NaN stays empty."""
    names = dict.fromkeys(name for row in rows for name in row)
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, list(names), lineterminator="\n")
        writer.writeheader()
        writer.writerows({name: _cell(value) for name, value in row.items()} for row in rows)


def _cell(value: object) -> object:
    """Return a value as a table writes it; NaN is an empty cell."""
    return "" if isinstance(value, float) and math.isnan(value) else value


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
            titles = pa.DictionaryArray.from_arrays(_array(np.zeros(length), pa.int32()), _text(run.scenario.title))
            columns = [_array(run.history[name], schema.field(name).type) for name in UNITS]
            writer.write_table(pa.Table.from_arrays([titles, *columns], schema=schema))


def _array(values: NDArray[np.float64], kind: pa.DataType) -> pa.Array:
    """Return numbers as pyarrow holds them. Its own conversion imports pandas, which takes longer than writing."""
    import pyarrow as pa

    stored = np.ascontiguousarray(values, dtype=kind.to_pandas_dtype())
    return pa.Array.from_buffers(kind, len(stored), [None, pa.py_buffer(stored)])


def _text(text: str) -> pa.Array:
    """Return an array of one text."""
    import pyarrow as pa

    content = text.encode()
    ends = np.array([0, len(content)], dtype=np.int32)
    return pa.Array.from_buffers(pa.string(), 1, [None, pa.py_buffer(ends), pa.py_buffer(content)])
