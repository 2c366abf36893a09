"""Text tables: CSV and TSV with any delimiter, decimal sign, encoding, lines above the names, and a row of units.

The sheets of a workbook are read as such tables of their cells.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Sequence
from itertools import pairwise, takewhile
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from seatsim.importing.names import read_name
from seatsim.importing.readers.header import BLANKS, MISSING, Dialect, Head, list_used, quote, read_head
from seatsim.importing.readers.reading import TextLayout, need
from seatsim.importing.readers.tables import read_column
from seatsim.importing.signals import DataFile, Group, Signal, find_rate, measured_axis, note_left_out
from seatsim.schema.bounds import TooMuchError, check_made
from seatsim.schema.errors import InputError, gathered, raise_all
from seatsim.schema.tables import parse_rows

if TYPE_CHECKING:
    import pyarrow as pa
    from openpyxl.worksheet._read_only import ReadOnlyWorksheet

_SAMPLE = 65536
"""Bytes from which delimiter, decimal sign and header are found."""
_CELLS = re.compile(BLANKS.pattern.encode())
_LONGEST_NAME = 8
"""Lines over which a name in quotation marks may go."""
_MOST_ROWS = 2**20
_BYTES_OF_CELL = 64
"""Bytes that a cell takes in memory as Python holds it."""


def read(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the columns of a text table, in a group for each column of time that has others behind it.

    Raises:
        InputError: it holds no rows of numbers, its names are not as many as its columns, or a row has fewer or more
            columns than the others.
    """
    content = _as_utf8(content, layout.encoding)
    lines = _sample(content)
    dialect = Dialect.find([lines[index] for index in list_used(lines)], layout.delimiter, layout.decimal)
    if dialect is None:
        is_stated = layout.delimiter or layout.decimal
        reason = "csv.delimiter and csv.decimal are wrong" if is_stated else "csv.delimiter has to be stated in a map"
        raise InputError(f"{path}: holds no row of numbers; it is no table, or {reason}")
    return _read_table(path, content, read_head(path, lines, dialect, layout.header))


def _read_table(path: Path, content: bytes, head: Head) -> DataFile:
    body, notes = _clean(_without_lines(content, len(head.above)), head)
    columns, (delimiter, decimal) = [str(index) for index in range(len(head.columns))], head.dialect
    table, bad = parse_rows(body, path, columns, delimiter=delimiter, decimal=decimal, missing=MISSING)
    if bad:
        _refuse_rows(path, content, [(row.text, row.actual_columns) for row in bad], len(head.columns))
    signals = _signals(table, head, notes)
    if not content.endswith((b"\n", b"\r")):
        notes.append("the last line has no end; if the file was cut there, its last number is wrong")
    return DataFile(path, "CSV", _part_by_time(signals, find_rate(head.above)), tuple(notes))


def _as_utf8(content: bytes, stated: str | None) -> bytes:
    """Return a text in UTF-8, of the encoding that is stated, else found, without a mark of the order of its bytes."""
    encoding = stated or _encoding(content)
    if encoding != "utf-8":
        content = content.decode(encoding, errors="replace").encode()
    return content.removeprefix(b"\xef\xbb\xbf")


def _encoding(content: bytes) -> str:
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16"
    if b"\0" in content[:2]:
        return "utf-16-le" if content[1:2] == b"\0" else "utf-16-be"
    try:
        content.decode("utf-8")
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8"


def _sample(content: bytes) -> list[str]:
    """Return the first lines of a table; one that the sample cuts is left out, and a name over several stands in one.

    The lines that such a name takes beside its first one are empty here.
    """
    lines = [line.decode(errors="replace") for line in content[:_SAMPLE].splitlines()]
    lines = lines[:-1] if len(content) > _SAMPLE and len(lines) > 1 else lines
    for index, line in enumerate(lines):
        if line.count('"') % 2:
            following = range(index + 1, min(index + _LONGEST_NAME, len(lines)))
            end = next((each for each in following if lines[each].count('"') % 2), index)
            lines[index : end + 1] = [" ".join(lines[index : end + 1]), *[""] * (end - index)]
    return lines


def _without_lines(content: bytes, count: int) -> bytes:
    """Return the content below so many lines."""
    return content[sum(map(len, content[:_SAMPLE].splitlines(keepends=True)[:count])) :]


def _clean(body: bytes, head: Head) -> tuple[bytes, list[str]]:
    """Return rows as pyarrow reads them, without names among them, and a sentence on those."""
    for sign in ("\u2212", "\u2013"):
        body = body.replace(sign.encode(), b"-")
    above = [line.strip().encode() for line in head.above if line.strip()]
    names = {*above} if above and above[-1] in body else set[bytes]()
    is_parted_by_blanks = head.dialect.delimiter == " "
    if not (names or is_parted_by_blanks):
        return body, []
    lines = body.splitlines()
    headings = _find_headings(lines, names, head.dialect)
    kept = [line for k, line in enumerate(lines) if k not in headings]
    left_out = len(lines) - len(kept)
    if is_parted_by_blanks:
        kept = [b" ".join(_CELLS.findall(line)) for line in kept]
    notes = [f"lines among the rows that hold the names again are left out: {left_out}"] if left_out else []
    return b"\n".join(kept) + b"\n", notes


def _find_headings(lines: Sequence[bytes], names: set[bytes], dialect: Dialect) -> set[int]:
    """Return which lines hold the names again, with the lines of text above these: a new acquisition begins there."""
    found = set[int]()
    for index, line in enumerate(lines):
        if line.strip() in names:
            # Only to the heading before: a table of nothing but names would take the square of its lines.
            above = takewhile(lambda k: k not in found and not _is_row(lines[k], dialect), range(index - 1, -1, -1))
            found.update([index, *above])
    return found


def _is_row(line: bytes, dialect: Dialect) -> bool:
    """Say whether the first cell of a line that is not empty holds a number, or what stands for a missing one."""
    cells = [cell for cell in dialect.split(line.decode(errors="replace")) if cell.strip()]
    return bool(cells) and dialect.kind(cells[0]) is not False


def _refuse_rows(path: Path, content: bytes, bad: Sequence[tuple[str, int]], wanted: int) -> NoReturn:
    """Raise InputError at the first row of another length than the names."""
    lines = [line.strip() for line in content.decode(errors="replace").splitlines()]
    text, columns = min(bad, key=lambda row: _find(lines, row[0]))
    is_last = text.strip() == next(line for line in reversed(lines) if line)
    remedy = "if it is no remark, the file is truncated or damaged: export it again" if is_last else ""
    reason = "; ".join(filter(None, (f"{quote(text)}; correct or remove that line", remedy)))
    more = f" (and {len(bad) - 1} more lines)" if len(bad) > 1 else ""
    place = f"{path}, line {_find(lines, text)}"
    raise InputError(f"{place}: has {columns} columns where the others have {wanted}{more}: {reason}")


def _find(lines: Sequence[str], text: str) -> int:
    plain = text.strip()
    return lines.index(plain) + 1 if plain in lines else len(lines)


def _signals(table: pa.Table, head: Head, notes: list[str]) -> list[Signal]:
    """Return the columns of numbers; a column of dates is added to the times of day behind it. The others are noted."""
    signals, left_out, days = [], [], None
    for (name, unit), column in zip(head.columns, table.columns, strict=True):
        found = read_column(column, head.dialect.decimal)
        if found is None or np.isnan(found.values).all():
            left_out += [] if re.fullmatch(r"column \d+", name) else [name]
        elif found.is_date:
            days = found.values
        else:
            since = days if days is not None and found.unit == "s" else 0.0
            signals.append(Signal(name, unit or found.unit, found.values + since))
            notes += [f"{name}: {found.parted} is read with its thousands parted"] if found.parted else []
    notes += note_left_out("columns that hold no numbers", left_out)
    return signals


def _part_by_time(signals: Sequence[Signal], rate: float | None) -> tuple[Group, ...]:
    """Return one group, or one for each column of time where every one has others behind it.

    Columns whose times are alike share a group. Rows that have no time end a group.
    """
    begins = [index for index, signal in enumerate(signals) if _is_clock(signal)]
    ends = [*begins[1:], len(signals)]
    if len(begins) < 2 or any(end - begin < 2 for begin, end in zip(begins, ends, strict=True)):
        return (Group("", tuple(signals), rate),)
    parts: list[list[Signal]] = []
    for begin, end in pairwise([0, *begins[1:], len(signals)]):
        part = list(signals[begin:end])
        clock = _clock(part)
        same = next((each for each in parts if np.array_equal(_clock(each).values, clock.values, equal_nan=True)), None)
        if same is None:
            parts.append(part)
        else:
            same += [signal for signal in part if signal is not clock]
    if len(parts) == 1:
        return (Group("", tuple(parts[0]), rate),)
    clocked = [(_clock(part), Group("", tuple(part))) for part in parts]
    return tuple(group.take(np.isfinite(clock.values))._replace(name=clock.name) for clock, group in clocked)


def _is_clock(signal: Signal) -> bool:
    is_named = read_name(signal.name, signal.unit).quantity == "time"
    return is_named and measured_axis(signal.values[np.isfinite(signal.values)]) is not None


def _clock(part: Sequence[Signal]) -> Signal:
    return next(signal for signal in part if _is_clock(signal))


def read_xlsx(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the sheets of a workbook that hold rows of numbers."""
    openpyxl = need("openpyxl", "XLSX")
    book = openpyxl.load_workbook(io.BytesIO(content), read_only=True, data_only=True)
    groups, notes, refused = list[Group](), list[str](), list[InputError]()
    for sheet in book.worksheets:
        place = f"{path}, sheet {sheet.title}"
        with gathered(refused):
            read = _read_cells(Path(place), _as_csv(_rows(sheet, len(content))), layout)
            groups += [group._replace(name=f"{sheet.title} {group.name}".strip()) for group in read.groups]
            notes += [f"sheet {sheet.title}: {note}" for note in read.notes]
    if not groups:
        raise_all(refused)
    return DataFile(path, "", tuple(groups), (*notes, *map(str, refused)))


def _rows(sheet: ReadOnlyWorksheet, size: int) -> list[Sequence[object]]:
    """Return the rows of a sheet that hold something, of equal length.

    Raises:
        TooMuchError: the sheet has more rows or cells than one of a file of `size` bytes may have.
    """
    # The stated dimensions may be anything; without them a row is as long as its last cell.
    sheet.reset_dimensions()
    rows: list[Sequence[object]] = []
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


def _as_csv(rows: Iterable[Sequence[object]]) -> bytes:
    """Return rows as a text table; a cell of several lines stands in one."""
    content = io.StringIO()
    lines = (["" if cell is None else " ".join(str(cell).splitlines()) for cell in row] for row in rows)
    csv.writer(content, lineterminator="\n").writerows(lines)
    return content.getvalue().encode()


def _read_cells(place: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the columns of a table that was written with commas and decimal points, as `read` does."""
    return _read_table(place, content, read_head(place, _sample(content), Dialect(",", "."), layout.header))
