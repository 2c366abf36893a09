"""Parquet and Feather files; a column's unit stands in the metadata of its field, and a column of dates is the time."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from seatsim.importing.readers.arrow_messages import bytes_of_messages
from seatsim.importing.readers.columns import column_values
from seatsim.importing.readers.reading import TextLayout
from seatsim.importing.signals import TIME, Array, DataFile, Group, Signal
from seatsim.schema.bounds import check_made

if TYPE_CHECKING:
    import pyarrow as pa

UNIT_KEYS = (b"unit", b"units", b"Unit", b"Units")
WORDS_FOR_TIME = ("time", "zeit", "temps")
"""A column of dates without such a word in its name, as an index has it, is called time."""

UNITS_OF_TIME = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}


def read(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the columns of a table as one group."""
    table = _table(content)
    signals, left_out = [], []
    has_time = False
    for field, column in zip(table.schema, table.columns, strict=True):
        name, unit = str(field.name), _unit(field)
        values = _seconds(column)
        if values is not None:
            name = name if has_time or any(word in name.lower() for word in WORDS_FOR_TIME) else TIME
            unit, has_time = "s", True
        else:
            values = column_values(column)
        if values is None:
            left_out.append(name)
        else:
            signals.append(Signal(name, unit, values))
    notes = (f"columns that hold no numbers: {', '.join(left_out)}",) if left_out else ()
    return DataFile(path, "", (Group("", tuple(signals)),) if signals else (), notes)


def _table(content: bytes) -> pa.Table:
    import pyarrow as pa

    if content.startswith(b"PAR1"):
        from pyarrow import parquet

        file = parquet.ParquetFile(pa.BufferReader(content))
        stated = file.metadata
        packed = sum(stated.row_group(index).total_byte_size for index in range(stated.num_row_groups))
        check_made(max(packed, 8 * stated.num_rows * stated.num_columns), len(content), "what its columns state")
        return file.read()
    from pyarrow import feather

    check_made(bytes_of_messages(content), len(content), "what its columns state")
    return feather.read_table(pa.BufferReader(content))


def _seconds(column: pa.ChunkedArray) -> Array | None:
    """Return dates or durations in s since the first of them, NaN where none stands; None for another column."""
    import pyarrow as pa

    if not (pa.types.is_timestamp(column.type) or pa.types.is_duration(column.type)):
        return None
    counts = column.cast(pa.int64()).fill_null(0).to_numpy()
    there = np.asarray(column.is_valid())
    first = counts[there][0] if there.any() else 0
    return np.where(there, (counts - first) * UNITS_OF_TIME[column.type.unit], np.nan)


def _unit(field: pa.Field) -> str:
    stated = field.metadata or {}
    return next((stated[key].decode() for key in UNIT_KEYS if key in stated), "")
