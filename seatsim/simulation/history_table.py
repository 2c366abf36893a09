"""Histories of runs as one Parquet table: a row a step, a column a channel, units in the columns' metadata."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from pathlib import Path

import numpy as np

from seatsim.schema.files import write_whole
from seatsim.schema.parquet import store_numbers, store_texts
from seatsim.simulation.result import UNITS, Run


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
            titles = pa.DictionaryArray.from_arrays(
                store_numbers(np.zeros(length), pa.int32()), store_texts([run.scenario.title])
            )
            columns = [store_numbers(run.history[name], schema.field(name).type) for name in UNITS]
            writer.write_table(pa.Table.from_arrays([titles, *columns], schema=schema))
