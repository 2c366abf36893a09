"""How a table of cells is written, where its numbers begin, and what the lines above say: names and units of columns.

Text tables and sheets share this: lines of titles, a row of names, perhaps a row of units, then rows of numbers. A row
names the columns only where it has as many cells as there are columns. The `Dialect` of a text table is its delimiter,
its decimal sign, and which of its rows hold numbers.
"""

import csv
import re
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from seatsim.importing.names import Meaning, read_name
from seatsim.schema.errors import InputError
from seatsim.schema.units import USUAL, is_unit

_DELIMITERS = (";", "\t", ",", "|", " ")
"""Delimiters in the order in which they are taken where several fit alike: a blank stands inside names, too."""
MISSING = ("", "nan", "NaN", "NAN", "NA", "n/a", "N/A", "null", "NULL", "None", "-", "#N/A", "inf", "-inf", "---", "*")
"""What a cell without a value holds."""
SIGN = "[+\\-\u2212\u2013]"
"""Signs of numbers: a minus and a dash of typesetting are a minus, too."""
THOUSANDS = {
    ".": re.compile(rf"{SIGN}?[1-9]\d{{0,2}}(?:[,'\u2019 \u00a0\u202f]\d{{3}})+(?:\.\d+)?"),
    ",": re.compile(rf"{SIGN}?[1-9]\d{{0,2}}(?:[.'\u2019 \u00a0\u202f]\d{{3}})+(?:,\d+)?"),
}
"""A number whose thousands are parted, such as 1,234.5, by decimal sign."""
PLAIN = {
    ".": re.compile(rf"{SIGN}?(?:\d+(?:\.\d*)?|\.\d+)(?:[eEdD][+-]?\d+)?"),
    ",": re.compile(rf"{SIGN}?(?:\d+(?:,\d*)?|,\d+)(?:[eEdD][+-]?\d+)?"),
}
"""What a number looks like with each decimal sign."""
DATE = r"\d{4}[-/.]\d{1,2}[-/.]\d{1,2}|\d{1,2}[-/.]\d{1,2}[-/.]\d{2,4}|\d{8}"
CLOCK = r"\d{1,2}:\d{2}(?::\d{2})?(?:[.,:]\d+)?(?:\s*[AaPp]\.?[Mm]\.?)?"
_STAMP = re.compile(rf"(?:{DATE})(?:[ T_,-]+{CLOCK})?(?:Z| ?UTC|[+-]\d\d:?\d\d)?|{CLOCK}")
"""A date, a time of day, or both."""
BLANKS = re.compile(r'"[^"]*"|[^\s"]+')
"""A cell of a table that is parted by blanks."""
_OTHER_UNITS = """m/s2 m/s² mm/s2 °c c k f hz - sec in lb kg bar pa deg rad ° 1/s rpm w %"""
_LISTED_UNITS = {unit.lower() for units in USUAL.values() for unit in units} | set(_OTHER_UNITS.split())
_LEADING_ZERO = re.compile(r"0\d+")
_COMMENT = re.compile(r"^\s*(?:#+|%+|//+|!+)\s*")
"""What begins a remark; names may stand in one."""
_SCORED = 50
"""Last lines by which delimiter and decimal sign are chosen."""

_QUOTED = 120
"""Letters of a line that an error quotes."""

Kind = bool | None
"""True for a cell that holds a number or a time, None for one that holds nothing, False for a text."""


class Dialect(NamedTuple):
    """How a table is written."""

    delimiter: str
    decimal: str

    @classmethod
    def find(cls, lines: Sequence[str], delimiter: str | None, decimal: str | None) -> "Dialect | None":
        """Return how lines are written that are not blank, as far as it is not stated; None where they hold no numbers.

        The last lines tell it, as the first may be titles.
        """
        last = lines[-_SCORED:]
        best, most = None, 0.0
        for each in (delimiter,) if delimiter else _DELIMITERS:
            for sign in (decimal,) if decimal else (".", ","):
                if each == sign and not any('"' in line for line in last):
                    continue
                dialect = cls(each, sign)
                score = _score(last, dialect)
                if score > most + 1e-9:
                    best, most = dialect, score
        return best

    def split(self, line: str) -> list[str]:
        """Return the cells of a line, without the quotation marks around them."""
        if self.delimiter == " ":
            return [cell.strip('"') for cell in BLANKS.findall(line)]
        if '"' in line:
            return next(csv.reader([line], delimiter=self.delimiter, skipinitialspace=True))
        return line.split(self.delimiter)

    def kind(self, cell: str) -> Kind:
        """Say what a cell holds."""
        plain = cell.strip()
        if plain in MISSING:
            return None
        patterns = (PLAIN[self.decimal], THOUSANDS[self.decimal], _STAMP)
        return any(pattern.fullmatch(plain) for pattern in patterns)

    def kinds(self, rows: Sequence[Sequence[str]]) -> list[list[Kind]]:
        """Say what the cells of rows hold."""
        return [[self.kind(cell) for cell in row] for row in rows]


def _find_body(kinds: Sequence[Sequence[Kind]]) -> tuple[int, int]:
    """Return where the longest stretch of rows begins and ends that are equally wide and hold numbers or nothing."""
    best, begin, holds_numbers = (0, 0), 0, False
    for index, row in enumerate(kinds):
        if not any(row) and False in row:
            begin, holds_numbers = index + 1, False
            continue
        if len(row) != len(kinds[begin]):
            begin, holds_numbers = index, False
        holds_numbers |= any(row)
        if holds_numbers and index + 1 - begin > best[1] - best[0]:
            best = (begin, index + 1)
    return best


def _find_first_row(rows: Sequence[Sequence[Kind]], place: str) -> int:
    """Return the first row of the table; `rows` say of each cell what it holds.

    The table is the longest stretch of equally wide rows with numbers. A row belongs to it where the first column of
    numbers holds no text, and at most half of the others do: a line of factors or serial numbers begins with a word.

    Raises:
        InputError: there is no such row.
    """
    begin, end = _find_body(rows)
    if begin == end:
        raise InputError(f"{place}: holds no row of numbers; it is no table")
    body = rows[begin:end]
    columns = range(len(body[0]))
    numeric = [column for column in columns if 2 * sum(row[column] is True for row in body) > len(body)]
    numeric = numeric or [column for column in columns if any(row[column] for row in body)]
    return next(row for row in range(begin, end) if _belongs(rows[row], numeric))


def _belongs(row: Sequence[Kind], numeric: Sequence[int]) -> bool:
    texts = sum(row[column] is False for column in numeric)
    return any(row) and row[numeric[0]] is not False and 2 * texts <= len(numeric)


def _score(lines: Sequence[str], dialect: Dialect) -> float:
    """Return how well lines are read: which share of them is the table, and how much of it is numbers."""
    rows = [dialect.split(line) for line in lines]
    begin, end = _find_body(dialect.kinds(rows))
    filled = [cell.strip() for row in rows[begin:end] for cell in row if cell.strip() not in MISSING]
    numbers = sum(_count(cell, dialect.decimal) for cell in filled)
    if not numbers:
        return 0.0
    # A column of texts (remarks) is no reason against a delimiter; a comma that splits 0,5 in two gives as many
    # columns, so that lines which agree and the numbers of a line count as well.
    return float((numbers / len(filled)) ** 2 * (end - begin) / len(lines) * (numbers / (end - begin)) ** 0.1)


def _count(cell: str, decimal: str) -> float:
    """Return how certainly a cell is a number: 1,234 may be 1.234, and 0500 may stand behind a decimal sign."""
    if PLAIN[decimal].fullmatch(cell) or _STAMP.fullmatch(cell):
        return 0.5 if _LEADING_ZERO.fullmatch(cell) else 1.0
    return (1.0 if decimal in cell else 0.5) if THOUSANDS[decimal].fullmatch(cell) else 0.0


def quote(line: str) -> str:
    """Return a line as an error quotes it."""
    text = line.strip()
    return f"'{text}'" if len(text) <= _QUOTED else f"'{text[:_QUOTED]}...'"


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


def _split_header(rows: Sequence[Sequence[str]], columns: int) -> list[tuple[str, str]]:
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
    stated = ["" if unit == _NOTHING or "unit" in unit.lower() else unit for unit in stated]
    return [(name, unit or of_name) for unit, (name, of_name) in zip(stated, named, strict=True)]


def _may_be_names(row: Sequence[str]) -> bool:
    """Say whether a row holds texts in most columns, and no number; numbers that count columns are names, too."""
    filled = [cell for cell in row if cell.strip()]
    holds_numbers = any(_PLAIN.kind(cell) for cell in filled)
    return len(filled) >= max(1, 0.6 * len(row)) and (not holds_numbers or _count_columns(row))


def _count_columns(row: Sequence[str]) -> bool:
    """Say whether a row has a text or nothing in front, and then numbers that count from 0 or 1."""
    numbers = [cell.strip() for cell in row[1:]]
    counts = [[str(number) for number in range(begin, begin + len(numbers))] for begin in (0, 1)]
    return len(numbers) > 1 and not _PLAIN.kind(row[0]) and numbers in counts


def _count_meanings(row: Sequence[str]) -> int:
    """Return how many different names of a row mean something: `V, V` are units of several columns."""
    return sum(read_name(cell)[:2] != (None, None) for cell in {*row})


def _is_units(row: Sequence[str]) -> bool:
    """Say whether a row of cells holds units: all look like one, and at least half are well known."""
    cells = [text for cell in row if (text := _unmarked(cell)) and "unit" not in text.lower()]
    known = sum(cell.strip("[]() ").lower() in _LISTED_UNITS for cell in cells)
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


class _Rows(NamedTuple):
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


def _fit_names(path: Path, above: Sequence[str], rows: _Rows, dialect: Dialect, is_stated: bool) -> list[list[str]]:
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
        return fitted
    if is_stated:
        return [[] for _ in above]
    seen = f"has {len(fitted[last])} names, {quote(above[last])}, but the rows have {rows.columns} columns"
    correct = "correct that line (a name that holds the delimiter stands in quotation marks), or state csv.header"
    remedy = f"{correct} in a map: then columns are called by their number"
    raise InputError(f"{path}, line {last + 1}: {seen}, such as {quote(rows.line)}; {remedy}")


def _names(line: str, cells: Sequence[str], dialect: Dialect) -> bool:
    """Say whether a line may hold names: several texts and no number, and where blanks part them a word that is known.

    A sentence is parted by blanks, too.
    """
    if len(cells) < 2 or any(dialect.kind(cell) for cell in cells):
        return False
    return dialect.delimiter != " " or any(read_name(cell)[:2] != (None, None) for cell in cells)


def _fit(line: str, rows: _Rows, dialect: Dialect) -> list[str]:
    """Return the cells of a line, as many as there are columns where it can be parted so."""
    mark = _COMMENT if dialect.delimiter == ";" else _COMMENT_OR_SEMICOLON
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
        dialect._replace(delimiter=each).split for each in _DELIMITERS if each not in (" ", delimiter) and each in text
    )
    if is_remark or delimiter == " " or all(read_name(word) != Meaning(None) for word in text.split()):
        yield lambda text: [cell.strip('"') for cell in BLANKS.findall(text)]
        yield lambda text: re.split(r"\s{2,}|\t", text.strip())


class Head(NamedTuple):
    """The beginning of a table: how it is written, and the lines above its numbers with what they say."""

    dialect: Dialect
    columns: list[tuple[str, str]]
    above: list[str]


def list_used(lines: Sequence[str]) -> list[int]:
    """Return which lines hold something, and no remark."""
    return [index for index, line in enumerate(lines) if line.strip() and not _COMMENT.match(line)]


def read_head(path: Path, lines: Sequence[str], dialect: Dialect, header: int | None) -> Head:
    """Return what stands above the rows, which begin below `header` lines where that is stated."""
    used = list_used(lines)
    rows = [dialect.split(lines[index]) for index in used]
    kinds = dialect.kinds(rows)
    if header is None:
        first = _find_first_row(kinds, str(path))
        first += first == 0 and len(rows) > 1 and _count_columns(rows[0])
    else:
        first, count = sum(index < header for index in used), used[-1] + 1
        if header >= count:
            said = f"csv.header {header} counts those above the first row of numbers"
            raise InputError(f"{path}: has {count} lines; {said}")
    above = used[first] if header is None else header
    table = _Rows(lines[used[first]], rows[first:], kinds[first:])
    names = _fit_names(path, lines[:above], table, dialect, header is not None)
    return Head(dialect, _split_header(names, len(rows[first])), list(lines[:above]))
