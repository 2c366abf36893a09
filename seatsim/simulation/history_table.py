"""Histories of runs as one Parquet table: a row a step, a column a channel, units in the columns' metadata."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from seatsim.schema.files import write_whole
from seatsim.simulation.result import UNITS, Run

if TYPE_CHECKING:
    import pyarrow as pa


def write_histories(runs: Iterable[Run], path: Path) -> Path:
    """Write all runs below each other, in single precision but for the time; column `run` holds their titles."""
    return write_whole(path, partial(_write, runs))


def _write(runs: Iterable[Run], path: Path) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    fields = [pa.field("run", pa.dictionary(pa.int32(), pa.string()))]
    fields += [
        pa.field(name, pa.float64() if name == "time" else pa.float32(), metadata={"unit": unit})
        for name, unit in UNITS.items()
    ]
    schema = pa.schema(fields)
    with pq.ParquetWriter(path, schema, compression="zstd", compression_level=1) as writer:
        for run in runs:
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
