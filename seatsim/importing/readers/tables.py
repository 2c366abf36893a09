"""Tables of other programs: the sheets of Excel workbooks, read as text tables are, and Parquet and Feather files.

How much the messages of a Feather file make once they are unpacked is taken from their heads alone. A message is a flat
buffer: a table begins with the distance back to a list of 2-byte offsets, one for each field, and a field that is a
table or a list holds the distance forward to it.
"""

from __future__ import annotations

import csv
import datetime
import io
import struct
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from seatsim.importing.readers import text
from seatsim.importing.readers.columns import read_column
from seatsim.importing.readers.reading import TextLayout, need
from seatsim.importing.signals import TIME, DataFile, Group, Signal, note_left_out, stated_unit
from seatsim.schema.arrays import open_parquet
from seatsim.schema.bounds import BYTES_OF_NUMBER, TooMuchError, check_made
from seatsim.schema.errors import InputError, gathered, raise_all

if TYPE_CHECKING:
    import pyarrow as pa
    from openpyxl.worksheet._read_only import ReadOnlyWorksheet

_MOST_ROWS = 2**20
_BYTES_OF_CELL = 64
"""Bytes that a cell takes in memory as Python holds it."""
_Cell = str | float | int | bool | datetime.datetime | datetime.date | datetime.time | datetime.timedelta | None
_WORDS_FOR_TIME = ("time", "zeit", "temps")
"""A column of dates without such a word in its name, as an index has it, is called time."""
_KIND, _HEADER = 1, 2
"""Fields of a message: what kind of header it has, and the header."""
_DICTIONARY, _BATCH = 2, 3
"""Kinds of headers: a batch of rows, and one within a dictionary."""
_ROWS, _NODES, _BUFFERS, _PACKING = 0, 1, 2, 3
"""Fields of a batch: the number of its rows, its columns, where their bytes lie, and how those are packed."""
_BEFORE = 8
"""Bytes before the first message."""


def read_xlsx(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the sheets of a workbook that hold rows of numbers."""
    openpyxl = need("openpyxl", "XLSX")
    book = openpyxl.load_workbook(io.BytesIO(content), read_only=True, data_only=True)
    groups, notes, refused = list[Group](), list[str](), list[InputError]()
    for sheet in book.worksheets:
        place = f"{path}, sheet {sheet.title}"
        with gathered(refused):
            read = text.read_cells(Path(place), _as_csv(_rows(sheet, len(content))), layout)
            groups += [group._replace(name=f"{sheet.title} {group.name}".strip()) for group in read.groups]
            notes += [f"sheet {sheet.title}: {note}" for note in read.notes]
    if not groups:
        raise_all(refused)
    return DataFile(path, "", tuple(groups), (*notes, *map(str, refused)))


def _rows(sheet: ReadOnlyWorksheet, size: int) -> list[Sequence[_Cell]]:
    """Return the rows of a sheet that hold something, of equal length.

    Raises:
        TooMuchError: the sheet has more rows or cells than one of a file of `size` bytes may have.
    """
    # The stated dimensions may be anything; without them a row is as long as its last cell.
    sheet.reset_dimensions()
    rows: list[Sequence[_Cell]] = []
    cells = 0
    for number, row in enumerate(sheet.iter_rows(values_only=True)):
        if number >= _MOST_ROWS:
            raise TooMuchError(f"the sheet {sheet.title} states more than {_MOST_ROWS} rows, the most that Excel has")
        if any(cell is not None for cell in row):
            rows.append(row)
            cells += len(row)
            check_made(_BYTES_OF_CELL * cells, size, f"the sheet {sheet.title}")
    width = max((len(row) for row in rows), default=0)
    check_made(_BYTES_OF_CELL * width * len(rows), size, f"the sheet {sheet.title}")
    return [(*row, *[None] * (width - len(row))) for row in rows]


def _as_csv(rows: Iterable[Sequence[_Cell]]) -> bytes:
    """Return rows as a text table; a cell of several lines stands in one."""
    content = io.StringIO()
    lines = (["" if cell is None else " ".join(str(cell).splitlines()) for cell in row] for row in rows)
    csv.writer(content, lineterminator="\n").writerows(lines)
    return content.getvalue().encode()


def read_arrow(path: Path, content: bytes, layout: TextLayout) -> DataFile:
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
            name = name if has_time or any(word in name.lower() for word in _WORDS_FOR_TIME) else TIME
            has_time = True
        signals.append(Signal(name, cells.unit or unit, cells.values))
    groups = (Group("", tuple(signals)),) if signals else ()
    return DataFile(path, "", groups, note_left_out("columns that hold no numbers", left_out))


def _table(content: bytes) -> pa.Table:
    import pyarrow as pa

    if content.startswith(b"PAR1"):
        return open_parquet(content).read()
    from pyarrow import feather

    check_made(_bytes_of_messages(content), len(content), "what its columns state")
    return feather.read_table(pa.BufferReader(content))


def _bytes_of_messages(content: bytes) -> int:
    """Return how many bytes the batches of a file make: what they unpack to, or a number for each row and column.

    Raises:
        ValueError: a message is damaged.
    """
    import pyarrow as pa

    made = 0
    if content.startswith(b"ARROW1"):
        for message in pa.ipc.MessageReader.open_stream(pa.BufferReader(content[_BEFORE:])):
            head = message.metadata.to_pybytes()
            try:
                made += _bytes_of_batch(head, message.body.to_pybytes() if message.body else b"")
            except struct.error as error:
                raise ValueError(f"a message ends too soon: {error}") from error
    return made


def _bytes_of_batch(head: bytes, body: bytes) -> int:
    message = struct.unpack_from("<I", head)[0]
    kind = _place(head, message, _KIND)
    if kind is None or head[kind] not in (_DICTIONARY, _BATCH):
        return 0
    batch = _follow(head, message, _HEADER)
    if head[kind] == _DICTIONARY:
        batch = _follow(head, batch, 1)
    rows, nodes = _place(head, batch, _ROWS), _follow(head, batch, _NODES)
    columns = struct.unpack_from("<I", head, nodes)[0]
    stated = struct.unpack_from("<q", head, rows)[0] if rows is not None else 0
    buffers = _follow(head, batch, _BUFFERS)
    unpacked = 0
    for number in range(struct.unpack_from("<I", head, buffers)[0]):
        offset, length = struct.unpack_from("<qq", head, buffers + 4 + 16 * number)
        packed = _place(head, batch, _PACKING) is not None and length >= BYTES_OF_NUMBER
        unpacked += max(length, struct.unpack_from("<q", body, offset)[0] if packed else 0)
    return int(max(unpacked, BYTES_OF_NUMBER * stated * columns))


def _place(head: bytes, table: int, number: int) -> int | None:
    """Return where a field of a table lies, None where it is left out."""
    offsets = table - struct.unpack_from("<i", head, table)[0]
    if 4 + 2 * number >= struct.unpack_from("<H", head, offsets)[0]:
        return None
    offset = struct.unpack_from("<H", head, offsets + 4 + 2 * number)[0]
    return table + offset if offset else None


def _follow(head: bytes, table: int, number: int) -> int:
    """Return where the table or list lies to which a field leads."""
    field = _place(head, table, number)
    if field is None:
        raise ValueError("a message lacks a part of its head")
    return field + int(struct.unpack_from("<I", head, field)[0])
