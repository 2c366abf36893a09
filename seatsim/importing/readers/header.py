"""Where the numbers of a table of cells begin, and what the lines above them say: names and units of its columns.

Text tables and sheets share this: lines of titles, a row of names, perhaps a row of units, then rows of numbers. A row
names the columns only where it has as many cells as there are columns.
"""

import re
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from seatsim.importing.names import Meaning, read_name
from seatsim.importing.readers.dialect import BLANKS, COMMENT, DELIMITERS, LISTED_UNITS, Dialect, Kind, quote
from seatsim.schema.errors import InputError
from seatsim.schema.units import is_unit

_BRACKETS = re.compile(r"^(.*?)\s*([\[({<])\s*([^\[\](){}<>]*?)\s*[\])}>]\s*$")
_SLASH = re.compile(r"^(.*?\S)\s*/\s*\(?([^/()\s]+(?:/[^/()\s]+)?)\)?$")
_UNIT_CELL = re.compile(r"^[\[(]?\s*[A-Za-zµμ°²³%\"Ω][A-Za-zµμ°²³%/*^_. ·0-9-]{0,11}\s*[\])]?$|^[\[(]?[-1]?[\])]?$")

_PLAIN = Dialect(",", ".")
_NOTHING = "-"
"""What stands in place of a unit where none is stated."""
_COMMENT_OR_SEMICOLON = re.compile(r"^\s*(?:#+|%+|//+|!+|;)\s*")
_LABEL = re.compile(r"^(?:headers?|columns?|fields?|names?|channels?|spalten|colonnes)\s*[:=,;\t ]\s*", re.IGNORECASE)
"""A word before the names that says that they follow."""
_LEFT_OUT = ("", "comment", "comments", "remark", "remarks", "kommentar", "bemerkung", "commentaire")
"""Last names of a line, in lower case, that may have no cells in the rows: LabVIEW writes `Comment`."""
_ROW = "row"
"""Name of a first column of row numbers or labels, which has none in the file."""


def split_header(rows: Sequence[Sequence[str]], columns: int) -> list[tuple[str, str]]:
    """Return name and unit of each column as the rows above the numbers say them; rows of another width are titles.

    Of the rows of texts that fill most columns one may hold units; of the others the one that says most holds the
    names, the last one where several say as much.
    """
    full = [row for row in rows if len(row) == columns and _may_be_names(row)]
    below = next((row for row in reversed(full) if _is_units(row)), None) if len(full) > 1 else None
    others = [row for row in full if row is not below]
    names = max(reversed(others), key=_count_meanings, default=[""] * columns)
    named = [_name_and_unit(name, index) for index, name in enumerate(names)]
    stated = [_unmarked(unit).strip("[]() ") for unit in below or [""] * columns]
    stated = ["" if unit == _NOTHING else unit for unit in stated]
    return [(name, unit or of_name) for unit, (name, of_name) in zip(stated, named, strict=True)]


def _may_be_names(row: Sequence[str]) -> bool:
    """Say whether a row holds texts in most columns, and no number; numbers that count columns are names, too."""
    filled = [cell for cell in row if cell.strip()]
    holds_numbers = any(_PLAIN.kind(cell) for cell in filled)
    return len(filled) >= max(1, 0.6 * len(row)) and (not holds_numbers or count_columns(row))


def count_columns(row: Sequence[str]) -> bool:
    """Say whether a row has a text or nothing in front, and then numbers that count from 0 or 1."""
    numbers = [cell.strip() for cell in row[1:]]
    counts = [[str(number) for number in range(begin, begin + len(numbers))] for begin in (0, 1)]
    return len(numbers) > 1 and not _PLAIN.kind(row[0]) and numbers in counts


def _count_meanings(row: Sequence[str]) -> int:
    """Return how many different names of a row mean something: `V, V` are units of several columns."""
    return sum(read_name(cell)[:2] != (None, None) for cell in {*row})


def _is_units(row: Sequence[str]) -> bool:
    """Say whether a row of cells holds units: all look like one, and at least half are well known."""
    cells = [text for cell in row if (text := _unmarked(cell))]
    known = sum(cell.strip("[]() ").lower() in LISTED_UNITS for cell in cells)
    return bool(cells) and all(_UNIT_CELL.match(cell) for cell in cells) and known >= 0.5 * len(cells)


def _unmarked(cell: str) -> str:
    return cell.strip().strip('"').strip()


def _name_and_unit(cell: str, index: int) -> tuple[str, str]:
    """Return the name and the unit of a cell such as `a_Sitz [g]` or `F/kN`; one without name is called by its number.

    A word in round brackets, such as `(left)`, is a unit only where there is such a one.
    """
    text = " ".join(_unmarked(cell).split())
    found = _BRACKETS.match(text)
    if found and found[1]:
        unit = found[3].removeprefix("in ").strip()
        if found[2] == "[" or is_unit(unit) or unit == _NOTHING:
            return found[1].rstrip("/ ").strip() or text, "" if unit == _NOTHING else unit
    parted = _SLASH.match(text)
    if parted and is_unit(parted[2]):
        return parted[1], parted[2]
    return text or f"column {index + 1}", ""


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
    fits = [len(cells) == rows.columns and _may_be_names(cells) for cells in fitted]
    last = next((index for index in reversed(range(len(above))) if _names(above[index], fitted[index], dialect)), None)
    if last is None or fits[last] or (any(fits) and not _is_units(fitted[last])):
        return [[_ROW, *cells[1:]] if cells and not cells[0] and rows.has_labels else cells for cells in fitted]
    if len(fitted[last]) == rows.columns - 1 and rows.has_labels:
        return [*fitted[:last], [_ROW, *fitted[last]]]
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
    if len(cells) < 2 or any(dialect.kind(cell) for cell in cells):
        return False
    return dialect.delimiter != " " or any(read_name(cell)[:2] != (None, None) for cell in cells)


def _fit(line: str, rows: Rows, dialect: Dialect) -> list[str]:
    """Return the cells of a line, as many as there are columns where it can be parted so."""
    mark = COMMENT if dialect.delimiter == ";" else _COMMENT_OR_SEMICOLON
    text = mark.sub("", line)
    is_remark = text != line.lstrip()
    for words in (text, _LABEL.sub("", text)):
        for part in _ways(words, dialect, is_remark):
            cells = [cell.strip() for cell in part(words)]
            cells[:1] = [mark.sub("", cell) for cell in cells[:1]]
            while len(cells) > rows.columns and cells[-1].lower() in _LEFT_OUT:
                cells.pop()
            if rows.filled <= len(cells) <= rows.columns:
                return [*cells, *[""] * (rows.columns - len(cells))]
    return [cell.strip() for cell in dialect.split(text)]


def _ways(text: str, dialect: Dialect, is_remark: bool) -> Iterator[Callable[[str], list[str]]]:
    """Yield how names may be parted: as the numbers are; where that delimiter is absent, by another one.

    Blanks part them in a remark, or where every word means something: a title is no row of names.
    """
    delimiter = dialect.delimiter
    if delimiter != " ":
        yield dialect.split
        if delimiter in text:
            return
    yield from (
        dialect._replace(delimiter=each).split for each in DELIMITERS if each not in (" ", delimiter) and each in text
    )
    if is_remark or delimiter == " " or all(read_name(word) != Meaning(None) for word in text.split()):
        yield lambda text: [cell.strip('"') for cell in BLANKS.findall(text)]
        yield lambda text: re.split(r"\s+(?![\[({</])", text.strip())
        yield lambda text: re.split(r"\s{2,}|\t", text.strip())
