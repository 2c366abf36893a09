"""Parquet and Feather files; a column's unit stands in the metadata of its field, and a column of dates is the time."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from seatsim.importing.readers.arrow_messages import bytes_of_messages
from seatsim.importing.readers.columns import read_column
from seatsim.importing.readers.naming import note_left_out, stated_unit
from seatsim.importing.readers.reading import TextLayout
from seatsim.importing.signals import TIME, DataFile, Group, Signal
from seatsim.schema.bounds import check_made
from seatsim.schema.parquet import open_parquet

if TYPE_CHECKING:
    import pyarrow as pa

WORDS_FOR_TIME = ("time", "zeit", "temps")
"""A column of dates without such a word in its name, as an index has it, is called time."""


def read(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the columns of a table as one group."""
    table = _table(content)
    signals, left_out = [], []
    has_time = False
    for field, column in zip(table.schema, table.columns, strict=True):
        name = str(field.name)
        unit = stated_unit({key.decode(errors="replace"): value for key, value in (field.metadata or {}).items()})
        cells = read_column(column, ".")
        if cells is None:
            left_out.append(name)
            continue
        if cells.unit == "s":
            name = name if has_time or any(word in name.lower() for word in WORDS_FOR_TIME) else TIME
            has_time = True
        signals.append(Signal(name, cells.unit or unit, cells.values))
    groups = (Group("", tuple(signals)),) if signals else ()
    return DataFile(path, "", groups, note_left_out("columns that hold no numbers", left_out))


def _table(content: bytes) -> pa.Table:
    import pyarrow as pa

    if content.startswith(b"PAR1"):
        return open_parquet(content).read()
    from pyarrow import feather

    check_made(bytes_of_messages(content), len(content), "what its columns state")
    return feather.read_table(pa.BufferReader(content))
