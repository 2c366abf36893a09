"""Tables of numbers as CSV files, plain or packed, read within stated limits: one reader for all of them.

A table has a line of names and, below it, rows of as many values as there are names. A row with another number of
values is an error: shifted columns would be taken for each other.
"""

from __future__ import annotations

import csv
import gzip
import io
import lzma
import zipfile
import zlib
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from seatsim.schema.bounds import TooMuchError, check_made, check_memory
from seatsim.schema.errors import InputError
from seatsim.schema.guarded import in_mib, read_bytes

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa
    from pyarrow import csv as arrow_csv

LARGEST_FILE = 2**30
"""Bytes of a table: eight hours of eight channels at 500 Hz."""
_LONGEST_LINE = 2**20
"""Bytes of a table in which its first line must end."""
_MOST_COLUMNS = 4096
_CHUNK = 2**20
_NUMBERS_OF_VALUE = 3
"""Numbers in memory for each value of a table, while it is read."""
_SHORT = 2**24
"""Bytes up to which a table is read by one thread, so that an error can name the line."""


def read_table(path: Path) -> pd.DataFrame:
    """Return a table with its columns by name; row k of the frame stands in line k + 2 of the file.

    A column of numbers only is one of numbers, with NaN for what is empty; `numbers` tells where one is not.

    Raises:
        InputError: the file cannot be read, is beyond the limits, has a name twice, or a row of another length.
    """
    import pyarrow as pa

    content = unpack(read_bytes(path, LARGEST_FILE, "a table"), path).removeprefix(b"\xef\xbb\xbf")
    _check_text(content, path)
    names = _read_names(content, path)
    rows = content.count(b"\n")
    check_memory(8.0 * _NUMBERS_OF_VALUE * rows * len(names) + len(content), f"{path}: {rows} rows", "split the table")
    if rows:
        table, bad = parse_rows(content, path, names, skip=1, use_threads=len(content) > _SHORT)
    else:
        table, bad = pa.table({name: pa.array([], pa.float64()) for name in names}), []
    if bad:
        # Several threads do not tell the line of a row.
        place = f"{path}, line {bad[0].number}" if bad[0].number else str(path)
        seen = f"has {bad[0].actual_columns} columns where the others have {bad[0].expected_columns}"
        more = f" (and {len(bad) - 1} more lines)" if len(bad) > 1 else ""
        raise InputError(f"{place}: {seen}{more}; the file is truncated or damaged: export it again")
    _check_quotes(content, table.num_rows, path)
    frame: pd.DataFrame = table.to_pandas()
    return frame


def parse_rows(
    content: bytes,
    path: Path,
    names: Sequence[str],
    *,
    skip: int = 0,
    use_threads: bool = True,
    delimiter: str = ",",
    decimal: str = ".",
    missing: Sequence[str] | None = None,
) -> tuple[pa.Table, list[arrow_csv.InvalidRow]]:
    """Return the rows below so many lines under such names, and those that hold another number of values.

    `missing` are what a cell without a value holds, as pyarrow has them where they are None.

    Raises:
        InputError: the content is no table.
    """
    import pyarrow as pa
    from pyarrow import csv as arrow_csv

    bad: list[arrow_csv.InvalidRow] = []

    def note(row: arrow_csv.InvalidRow) -> str:
        bad.append(row)
        return "skip"

    try:
        table = arrow_csv.read_csv(
            pa.BufferReader(content),
            arrow_csv.ReadOptions(column_names=names, skip_rows=skip, use_threads=use_threads),
            arrow_csv.ParseOptions(delimiter=delimiter, invalid_row_handler=note),
            arrow_csv.ConvertOptions(decimal_point=decimal, null_values=missing, strings_can_be_null=True),
        )
    except pa.ArrowInvalid as error:
        raise InputError(f"{path}: cannot be read as a table: {str(error).splitlines()[0]}") from error
    return table, bad


def unpack(content: bytes, path: Path) -> bytes:
    """Return the bytes of a table, unpacked where they are packed by gzip.

    Raises:
        InputError: they are damaged, or larger than the limit once unpacked; no more than that is unpacked.
    """
    if not content.startswith(b"\x1f\x8b"):
        if path.suffix in (".bz2", ".xz", ".zip"):
            raise InputError(f"{path}: cannot be read as a table: is packed otherwise than by gzip; unpack it")
        if content and path.suffix == ".gz":
            problem = "its name ends in .gz, but it is not packed; copy it again"
            raise InputError(f"{path}: cannot be read as a table: {problem}")
        return content
    unpacked = bytearray()
    try:
        with gzip.GzipFile(fileobj=io.BytesIO(content)) as file:
            while part := file.read(_CHUNK):
                unpacked += part
                check_made(len(unpacked), len(content), "what it unpacks to")
    except TooMuchError as error:
        raise InputError(f"{path}: {error}") from error
    except UNPACKING_ERRORS as error:
        raise InputError(f"{path}: cannot be unpacked ({error}); it is truncated: copy it again") from error
    return bytes(unpacked)


def numbers(frame: pd.DataFrame, column: str) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """Return a column as numbers, shape (N,), and the rows that hold no finite one."""
    import pandas as pd

    values = pd.to_numeric(frame[column], errors="coerce").to_numpy(dtype=np.float64)
    return values, np.flatnonzero(~np.isfinite(values))


def read_finite(frame: pd.DataFrame, column: str, path: Path | str, remedy: str) -> NDArray[np.float64]:
    """Return a column of a table as numbers, shape (N,).

    Raises:
        InputError: a row of it is no finite number; the sentence ends with a remedy.
    """
    values, bad = numbers(frame, column)
    if bad.size:
        more = f" (and {bad.size - 1} more rows)" if bad.size > 1 else ""
        place = f"{path}, line {frame.index[bad[0]] + 2}, {column}: '{frame[column].iloc[bad[0]]}'{more}"
        raise InputError(f"{place} is not a finite number; {remedy}")
    return values


def _check_text(content: bytes, path: Path) -> None:
    """Raise InputError where content is not UTF-8: pyarrow passes over rows that are not, and over their length."""
    try:
        content.isascii() or content.decode()
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise InputError(
            f"{path}, line {line}: cannot be read as a table: is not UTF-8 text; save it as such"
        ) from error


def _check_quotes(content: bytes, rows: int, path: Path) -> None:
    """Raise InputError where a quotation mark is closed in another line only: all rows between would be one text."""
    # Where every line is a row, none is blank and no quotation mark reaches beyond its line: few tables need more.
    if b'"' not in content or rows == content.count(b"\n") - content.endswith(b"\n"):
        return
    if rows != sum(bool(line.strip()) for line in content.splitlines()) - 1:
        line = next((k for k, text in enumerate(content.splitlines(), 1) if text.count(b'"') % 2), 1)
        raise InputError(f"{path}, line {line}: a quotation mark is not closed in its line; remove it")


UNPACKING_ERRORS = (OSError, EOFError, ValueError, zlib.error, lzma.LZMAError, zipfile.BadZipFile, NotImplementedError)


def _read_names(content: bytes, path: Path) -> list[str]:
    """Return the names in the first line; one that is empty is called by its number."""
    head, end, _ = content[:_LONGEST_LINE].partition(b"\n")
    if len(content) > _LONGEST_LINE and not end:
        raise InputError(f"{path}: its first line does not end within {in_mib(_LONGEST_LINE)}; it is no table")
    try:
        row = next(csv.reader([head.decode("utf-8")]), [])
    except csv.Error as error:
        raise InputError(f"{path}: cannot be read as a table: {error}; its first line holds no names") from error
    names = [name.strip() or f"column {number}" for number, name in enumerate(row, 1)]
    if not names:
        raise InputError(f"{path}: cannot be read as a table: the file is empty")
    if len(names) > _MOST_COLUMNS:
        raise InputError(f"{path}: has {len(names)} columns; permitted: at most {_MOST_COLUMNS}")
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(f"{path}, line 1: column '{twice}' stands twice; rename or remove one")
    return names
