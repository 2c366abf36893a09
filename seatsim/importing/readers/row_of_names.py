"""The lines above a text table as cells: a row of names has as many as there are columns, or the file is refused."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

from seatsim.importing.names import Meaning, read_name
from seatsim.importing.readers.dialect import BLANKS, DELIMITERS, Dialect, Kind, kind_of, split_line
from seatsim.importing.readers.header import is_units, may_be_names
from seatsim.schema.errors import InputError

COMMENT = re.compile(r"^\s*(?:#+|%+|//+|!+)\s*")
"""What begins a remark; names may stand in one."""
COMMENT_OR_SEMICOLON = re.compile(r"^\s*(?:#+|%+|//+|!+|;)\s*")
LABEL = re.compile(r"^(?:headers?|columns?|fields?|names?|channels?|spalten|colonnes)\s*[:=,;\t ]\s*", re.IGNORECASE)
"""A word before the names that says that they follow."""
QUOTED = 120
"""Letters of a line that an error quotes."""
LEFT_OUT = ("", "comment", "comments", "remark", "remarks", "kommentar", "bemerkung", "commentaire")
"""Last names of a line, in lower case, that may have no cells in the rows: LabVIEW writes `Comment`."""
ROW = "row"
"""Name of a first column of row numbers or labels, which has none in the file."""


class Rows(NamedTuple):
    """The first rows of a table: the line of the first one, and by row its cells and what they hold."""

    line: str
    cells: Sequence[Sequence[str]]
    kinds: Sequence[Sequence[Kind]]

    @property
    def columns(self) -> int:
        """Columns of the table."""
        return len(self.cells[0])

    @property
    def filled(self) -> int:
        """Columns up to the last one that holds anything: a delimiter may end each row."""
        return max((index + 1 for row in self.kinds for index, kind in enumerate(row) if kind is not None), default=0)

    @property
    def has_labels(self) -> bool:
        """Whether the first column holds texts, or counts the rows."""
        first = [row[0].strip() for row in self.cells if len(row) == self.columns]
        if all(text.isdecimal() for text in first):
            return [int(text) for text in first] == list(range(int(first[0]), int(first[0]) + len(first)))
        return not any(row[0] for row in self.kinds if row)


def fit_names(path: Path, above: Sequence[str], rows: Rows, dialect: Dialect, is_stated: bool) -> list[list[str]]:
    """Return the cells of each line above the numbers; `is_stated` says that the map counts these lines.

    A mark of a remark is none of the names. Names that are parted by another delimiter than the numbers are understood
    where they are as many as the columns.

    Raises:
        InputError: the last line with words has another number of names than there are columns, and no line has as
            many; it quotes both lines.
    """
    fitted = [_fit(line, rows, dialect) for line in above]
    fits = [len(cells) == rows.columns and may_be_names(cells) for cells in fitted]
    last = next((index for index in reversed(range(len(above))) if _names(above[index], fitted[index], dialect)), None)
    if last is None or fits[last] or (any(fits) and not is_units(fitted[last])):
        return [[ROW, *cells[1:]] if cells and not cells[0] and rows.has_labels else cells for cells in fitted]
    if len(fitted[last]) == rows.columns - 1 and rows.has_labels:
        return [*fitted[:last], [ROW, *fitted[last]]]
    if is_stated:
        return [[] for _ in above]
    raise InputError(
        f"{path}, line {last + 1}: has {len(fitted[last])} names, {quote(above[last])}, but the rows have"
        f" {rows.columns} columns, such as {quote(rows.line)}; correct that line (a name that holds the delimiter"
        " stands in quotation marks), or state csv.header in a map: then columns are called by their number"
    )


def _names(line: str, cells: Sequence[str], dialect: Dialect) -> bool:
    """Say whether a line may hold names: several texts and no number, and where blanks part them a word that is known.

    A sentence is parted by blanks, too.
    """
    if len(cells) < 2 or any(kind_of(cell, dialect.decimal) for cell in cells):
        return False
    return dialect.delimiter != " " or any(read_name(cell)[:2] != (None, None) for cell in cells)


def _fit(line: str, rows: Rows, dialect: Dialect) -> list[str]:
    """Return the cells of a line, as many as there are columns where it can be parted so."""
    mark = COMMENT if dialect.delimiter == ";" else COMMENT_OR_SEMICOLON
    text = mark.sub("", line)
    is_remark = text != line.lstrip()
    for words in (text, LABEL.sub("", text)):
        for part in _ways(words, dialect.delimiter, is_remark):
            cells = [cell.strip() for cell in part(words)]
            cells[:1] = [mark.sub("", cell) for cell in cells[:1]]
            while len(cells) > rows.columns and cells[-1].lower() in LEFT_OUT:
                cells.pop()
            if rows.filled <= len(cells) <= rows.columns:
                return [*cells, *[""] * (rows.columns - len(cells))]
    return [cell.strip() for cell in split_line(text, dialect.delimiter)]


def _ways(text: str, delimiter: str, is_remark: bool) -> Iterator[Callable[[str], list[str]]]:
    """Yield how names may be parted: as the numbers are; where that delimiter is absent, by another one.

    Blanks part them in a remark, or where every word means something: a title is no row of names.
    """
    if delimiter != " ":
        yield partial(split_line, delimiter=delimiter)
        if delimiter in text:
            return
    yield from (
        partial(split_line, delimiter=each) for each in DELIMITERS if each not in (" ", delimiter) and each in text
    )
    if is_remark or delimiter == " " or all(read_name(word) != Meaning(None) for word in text.split()):
        yield lambda text: [cell.strip('"') for cell in BLANKS.findall(text)]
        yield lambda text: re.split(r"\s+(?![\[({</])", text.strip())
        yield lambda text: re.split(r"\s{2,}|\t", text.strip())


def quote(line: str) -> str:
    """Return a line as an error quotes it."""
    text = line.strip()
    return f"'{text}'" if len(text) <= QUOTED else f"'{text[:QUOTED]}...'"
