"""Text tables: CSV and TSV with any delimiter, decimal sign, encoding, lines above the names, and a row of units."""

from __future__ import annotations

import csv
import re
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from seatsim.importing.readers.header import Header, first_row_of_numbers, split_header
from seatsim.importing.readers.reading import TextLayout
from seatsim.importing.signals import Array, DataFile, Group, Signal
from seatsim.schema.errors import InputError
from seatsim.schema.tables import InvalidRow, check_rows

if TYPE_CHECKING:
    import pyarrow as pa

SAMPLE = 65536
"""Bytes from which delimiter, decimal sign and header are found."""
MOST_HEADER_LINES = 200
DELIMITERS = (";", "\t", ",", "|", " ")
MISSING = ("", "nan", "NaN", "NAN", "NA", "n/a", "N/A", "null", "NULL", "None", "-", "#N/A", "inf", "-inf", "---", "*")
"""What a cell without a value holds."""
THOUSANDS = r"[+-]?\d{1,3}(?:\.\d{3})+,\d+"
"""A number such as 1.234,5."""
NUMBER = {
    ".": re.compile(r"^[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)?$"),
    ",": re.compile(rf"^(?:[+-]?(\d+,?\d*|,\d+)([eEdD][+-]?\d+)?|{THOUSANDS})$"),
}
"""What a number looks like with each decimal sign."""


def read(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the columns of a text table as one group.

    Raises:
        InputError: it holds no rows of numbers, or a row has fewer or more columns than the others.
    """
    encoding = layout.encoding or _encoding(content)
    if encoding != "utf-8":
        content = content.decode(encoding, errors="replace").encode()
    content = content.removeprefix(b"\xef\xbb\xbf")
    lines = _sample(content)
    delimiter, decimal = _dialect(lines, layout, path)
    rows = [_cells(line, delimiter) for line in lines]
    numeric = [[_is_number(cell, decimal) for cell in row] for row in rows]
    first = layout.header if layout.header is not None else first_row_of_numbers(_padded(numeric), str(path))
    if first >= len(rows):
        raise InputError(
            f"{path}: has {len(rows)} lines; csv.header {first} counts those above the first row of numbers"
        )
    columns = len(rows[first])
    header = split_header(rows, first, columns)
    table = _table(path, content, header, delimiter, decimal)
    signals, left_out = _signals(table, header, decimal)
    return DataFile(path, "CSV", (Group("", tuple(signals)),), _notes(left_out, content))


def _encoding(content: bytes) -> str:
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16"
    try:
        content.decode("utf-8")
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8"


def _sample(content: bytes) -> list[str]:
    """Return the first lines of a table; one that the sample cuts is left out."""
    lines = content[:SAMPLE].decode(errors="replace").splitlines()
    return lines[:-1] if len(content) > SAMPLE and len(lines) > 1 else lines


def _dialect(lines: list[str], layout: TextLayout, path: Path) -> tuple[str, str]:
    """Return the delimiter and the decimal sign with which most cells of the last lines are numbers."""
    body = [line for line in lines if line.strip()][-50:]
    best, most = ("", ""), 0.0
    for delimiter in [layout.delimiter] if layout.delimiter else DELIMITERS:
        for decimal in [layout.decimal] if layout.decimal else (".", ","):
            if delimiter == decimal and not any('"' in line for line in body):
                continue
            score = _score(body, delimiter, decimal)
            if score > most:
                best, most = (delimiter, decimal), score
    if most <= 0.0:
        raise InputError(f"{path}: holds no row of numbers; it is no table, or csv.delimiter and csv.decimal are wrong")
    return best


def _score(lines: list[str], delimiter: str, decimal: str) -> float:
    """Return how many numbers a line has, for lines that agree in their columns and hold hardly anything else."""
    rows = [_cells(line, delimiter) for line in lines]
    width, alike = Counter(len(row) for row in rows).most_common(1)[0]
    cells = [cell for row in rows if len(row) == width for cell in row]
    filled = [cell for cell in cells if cell.strip() not in MISSING]
    numbers = sum(_is_number(cell, decimal) for cell in filled)
    if not numbers:
        return 0.0
    # A column of texts (dates, remarks) is no reason against a delimiter; a comma that splits 0,5 in two is one of
    # several columns too, so that lines which agree and cells which are filled count as well.
    return float((numbers / len(filled)) ** 2 * alike / len(rows) * width**0.1 * (numbers / len(cells)) ** 0.1)


def _cells(line: str, delimiter: str) -> list[str]:
    if delimiter == " ":
        return line.split()
    if '"' in line:
        return next(csv.reader([line], delimiter=delimiter))
    return line.split(delimiter)


def _is_number(cell: str, decimal: str) -> bool:
    return bool(NUMBER[decimal].match(cell.strip()))


def _padded(numeric: list[list[bool]]) -> list[list[bool]]:
    """Return the rows as wide as most are, so that a long line of title does not count as the table's width."""
    width = Counter(len(row) for row in numeric).most_common(1)[0][0]
    return [row if len(row) == width else [False] * width for row in numeric[:MOST_HEADER_LINES]]


def _table(path: Path, content: bytes, header: Header, delimiter: str, decimal: str) -> pa.Table:
    import pyarrow as pa
    from pyarrow import csv as arrow_csv

    if delimiter == " ":
        content = b"\n".join(b" ".join(line.split()) for line in content.splitlines())
    bad: list[InvalidRow] = []

    def note(row: arrow_csv.InvalidRow) -> str:
        bad.append(InvalidRow(row.number, row.actual_columns, row.expected_columns))
        return "skip"

    names = [str(index) for index in range(len(header.names))]
    try:
        table = arrow_csv.read_csv(
            pa.BufferReader(content),
            arrow_csv.ReadOptions(skip_rows=header.lines, column_names=names, use_threads=not _is_short(content)),
            arrow_csv.ParseOptions(delimiter=delimiter, invalid_row_handler=note),
            arrow_csv.ConvertOptions(decimal_point=decimal, null_values=list(MISSING), strings_can_be_null=True),
        )
    except pa.ArrowInvalid as error:
        raise InputError(f"{path}: cannot be read as a table: {error}") from error
    check_rows(bad, path)
    return table


def _is_short(content: bytes) -> bool:
    """Say whether one thread is enough, so that an error can name the line."""
    return len(content) < 16 * SAMPLE


def _signals(table: pa.Table, header: Header, decimal: str) -> tuple[list[Signal], list[str]]:
    """Return the columns of numbers, and the names of the others."""
    signals, left_out = [], []
    for name, unit, column in zip(header.names, header.units, table.columns, strict=True):
        values = column_values(column, decimal)
        if values is None:
            left_out.append(name)
        elif not (name.startswith("column ") and np.isnan(values).all()):
            signals.append(Signal(name, unit, values))
    return signals, left_out


def column_values(column: pa.ChunkedArray, decimal: str = ".") -> Array | None:
    """Return a column as numbers, a time of day in s since its first value; None where most of it is text."""
    import pyarrow as pa

    kind = column.type
    if pa.types.is_timestamp(kind) or pa.types.is_time(kind) or pa.types.is_date(kind):
        return _seconds(column)
    if pa.types.is_null(kind):
        return np.full(len(column), np.nan)
    if pa.types.is_string(kind) or pa.types.is_large_string(kind):
        return _numbers_of_texts(column, decimal)
    if pa.types.is_dictionary(kind) or not (pa.types.is_primitive(kind) or pa.types.is_decimal(kind)):
        return None
    whole = column.cast(pa.float64(), safe=False).combine_chunks()
    if whole.null_count:
        values = np.asarray(whole.to_numpy(zero_copy_only=False), dtype=np.float64)
    else:  # without pandas, which pyarrow would load, and which takes longer than a small file
        values = np.frombuffer(whole.buffers()[1], np.float64, len(whole), 8 * whole.offset)
    return values if np.isfinite(values).all() else np.where(np.isfinite(values), values, np.nan)


def _seconds(column: pa.ChunkedArray) -> Array:
    import pandas as pd

    times = pd.Series(column.to_pandas().astype(str))
    parsed = pd.to_timedelta(times, errors="coerce")
    if parsed.isna().all():
        dates = pd.to_datetime(times, errors="coerce", utc=True, format="mixed")
        parsed = dates - dates.dropna().iloc[0]
    return np.asarray((parsed - parsed.dropna().iloc[0]).dt.total_seconds(), dtype=np.float64)


def _numbers_of_texts(column: pa.ChunkedArray, decimal: str) -> Array | None:
    """Return the numbers of a column that a few other texts made one of texts, NaN for those."""
    import pandas as pd

    texts = column.to_pandas()
    plain = texts.str.strip()
    if decimal == ",":  # with a decimal sign behind them points can only part thousands
        plain = plain.where(~plain.str.fullmatch(THOUSANDS, na=False), plain.str.replace(".", "", regex=False))
    plain = plain.str.replace(decimal, ".", regex=False)
    values = np.asarray(pd.to_numeric(plain, errors="coerce"), dtype=np.float64)
    if np.isnan(values).sum() <= 0.5 * len(values):
        return np.where(np.isfinite(values), values, np.nan)
    dates = pd.to_datetime(texts.iloc[:5], errors="coerce", format="mixed")
    if dates.notna().all() and len(texts):
        whole = pd.to_datetime(texts, errors="coerce", format="mixed")
        return np.asarray((whole - whole.dropna().iloc[0]).dt.total_seconds(), dtype=np.float64)
    return None


def _notes(left_out: list[str], content: bytes) -> tuple[str, ...]:
    notes = [f"columns that hold no numbers: {', '.join(left_out)}"] if left_out else []
    if not content.endswith((b"\n", b"\r")):
        notes.append("the last line has no end; if the file was cut there, its last number is wrong")
    return tuple(notes)
