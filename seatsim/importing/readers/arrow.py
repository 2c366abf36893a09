"""Parquet and Feather files; a column's unit stands in the metadata of its field."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from seatsim.importing.readers.columns import column_values
from seatsim.importing.readers.reading import TextLayout
from seatsim.importing.signals import DataFile, Group, Signal

if TYPE_CHECKING:
    import pyarrow as pa

UNIT_KEYS = (b"unit", b"units", b"Unit", b"Units")


def read(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the columns of a table as one group."""
    table = _table(content)
    signals, left_out = [], []
    for field, column in zip(table.schema, table.columns, strict=True):
        values = column_values(column)
        if values is None:
            left_out.append(str(field.name))
        else:
            signals.append(Signal(str(field.name), _unit(field), values))
    notes = (f"columns that hold no numbers: {', '.join(left_out)}",) if left_out else ()
    return DataFile(path, "", (Group("", tuple(signals)),) if signals else (), notes)


def _table(content: bytes) -> pa.Table:
    import pyarrow as pa

    if content.startswith(b"PAR1"):
        from pyarrow import parquet

        return parquet.read_table(pa.BufferReader(content))
    from pyarrow import feather

    return feather.read_table(pa.BufferReader(content))


def _unit(field: pa.Field) -> str:
    stated = field.metadata or {}
    return next((stated[key].decode() for key in UNIT_KEYS if key in stated), "")
