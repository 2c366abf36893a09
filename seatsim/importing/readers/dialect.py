"""How a text table is written: its delimiter, its decimal sign, and which of its rows hold numbers."""

import csv
import re
from collections.abc import Sequence
from typing import NamedTuple

from seatsim.schema.errors import InputError
from seatsim.schema.units import USUAL

DELIMITERS = (";", "\t", ",", "|", " ")
"""Delimiters in the order in which they are taken where several fit alike: a blank stands inside names, too."""
MISSING = ("", "nan", "NaN", "NAN", "NA", "n/a", "N/A", "null", "NULL", "None", "-", "#N/A", "inf", "-inf", "---", "*")
"""What a cell without a value holds."""
SIGN = "[+\\-\u2212\u2013]"
"""Signs of numbers: a minus and a dash of typesetting are a minus, too."""
THOUSANDS = {
    ".": re.compile(rf"(?:{SIGN}\s*)?[1-9]\d{{0,2}}(?:[,'\u2019 \u00a0\u202f]\d{{3}})+(?:\.\d+)?"),
    ",": re.compile(rf"(?:{SIGN}\s*)?[1-9]\d{{0,2}}(?:[.'\u2019 \u00a0\u202f]\d{{3}})+(?:,\d+)?"),
}
"""A number whose thousands are parted, such as 1,234.5, by decimal sign."""
PLAIN = {
    ".": re.compile(rf"(?:{SIGN}\s*)?(?:\d+(?:\.\d*)?|\.\d+)(?:[eEdD][+-]?\d+)?"),
    ",": re.compile(rf"(?:{SIGN}\s*)?(?:\d+(?:,\d*)?|,\d+)(?:[eEdD][+-]?\d+)?"),
}
"""What a number looks like with each decimal sign."""
DATE = r"\d{4}[-/.]\d{1,2}[-/.]\d{1,2}|\d{1,2}[-/.]\d{1,2}[-/.]\d{2,4}|\d{8}"
CLOCK = r"\d{1,2}:\d{2}(?::\d{2})?(?:[.,:]\d+)?(?:\s*[AaPp]\.?[Mm]\.?)?"
_STAMP = re.compile(rf"(?:{DATE})(?:[ T_,-]+{CLOCK})?(?:Z| ?UTC|[+-]\d\d:?\d\d)?|{CLOCK}")
"""A date, a time of day, or both."""
BLANKS = re.compile(rf'"[^"]*"|(?:(?<![^\s]){SIGN} +(?=[.,\d]))?[^\s"]+')
"""A cell of a table that is parted by blanks; one may stand between a sign and its number."""
_OTHER_UNITS = """m/s2 m/s² mm/s2 °c c k f hz - sec in lb kg bar pa deg rad ° 1/s rpm w %"""
LISTED_UNITS = {unit.lower() for units in USUAL.values() for unit in units} | set(_OTHER_UNITS.split())
WITH_UNIT = re.compile(r"(\S.*?[\d.,])\s+([^\W\d_][^\s\d]*[²2]?|%|°C?)")
"""A number with its unit in the same cell."""
_LEADING_ZERO = re.compile(r"0\d+")
_LONGEST_NUMBER = 40
"""Letters of a cell that may hold a number and its unit."""
COMMENT = re.compile(r"^\s*(?:#+|%+|//+|!+)\s*")
"""What begins a remark; names may stand in one."""
_MOSTLY = 0.75
"""Share of the rows from the first one on, as far as the table was looked at, that belong to it."""
_SCORED = 50
"""Lines at either end by which delimiter and decimal sign are chosen."""
_DISAGREEING = 0.9
"""Weight of a way to read a table in which the line above its rows has another number of cells."""

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

        The last lines tell it, as the first may be titles; these tell which way has as many names as columns.
        """
        first, last = lines[:_SCORED], lines[-_SCORED:]
        best, most = None, 0.0
        for each in (delimiter,) if delimiter else DELIMITERS:
            for sign in (decimal,) if decimal else (".", ","):
                if each == sign and not any('"' in line for line in last):
                    continue
                dialect = cls(each, sign)
                score = _score(last, dialect) * (1.0 if _agrees_with_names(first, dialect) else _DISAGREEING)
                score += 1e-3 * _score(first, dialect)
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
        return any(pattern.fullmatch(_without_unit(plain)) for pattern in patterns)

    def kinds(self, rows: Sequence[Sequence[str]]) -> list[list[Kind]]:
        """Say what the cells of rows hold."""
        return [[self.kind(cell) for cell in row] for row in rows]


def _without_unit(cell: str) -> str:
    """Return a cell without a well-known unit at its end."""
    found = WITH_UNIT.fullmatch(cell) if len(cell) <= _LONGEST_NUMBER else None
    return found[1] if found and found[2].lower() in LISTED_UNITS else cell


def find_body(kinds: Sequence[Sequence[Kind]]) -> tuple[int, int]:
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


def check_header(header: int, lines: int, place: str) -> None:
    """Raise InputError where no row is left below so many lines above the first row of numbers."""
    if header >= lines:
        raise InputError(f"{place}: has {lines} lines; csv.header {header} counts those above the first row of numbers")


def find_first_row(rows: Sequence[Sequence[Kind]], place: str) -> int:
    """Return the first row of the table; `rows` say of each cell what it holds.

    The table is the longest stretch of equally wide rows with numbers. A row belongs to it where the first column of
    numbers holds no text, and at most half of the others do: a line of factors or serial numbers begins with a word.

    Raises:
        InputError: there is no such row.
    """
    begin, end = find_body(rows)
    if begin == end:
        raise InputError(f"{place}: holds no row of numbers; it is no table")
    body = rows[begin:end]
    columns = range(len(body[0]))
    numeric = [column for column in columns if 2 * sum(row[column] is True for row in body) > len(body)]
    numeric = numeric or [column for column in columns if any(row[column] for row in body)]
    belongs = [len(row) == len(columns) and _belongs(row, numeric) for row in rows[:end]]
    # Rows above a remark belong to the table, a line of numbers among titles does not.
    return next(row for row in range(end) if belongs[row] and sum(belongs[row:end]) >= _MOSTLY * (end - row))


def _belongs(row: Sequence[Kind], numeric: Sequence[int]) -> bool:
    texts = sum(row[column] is False for column in numeric)
    return any(row) and row[numeric[0]] is not False and 2 * texts <= len(numeric)


def _agrees_with_names(lines: Sequence[str], dialect: Dialect) -> bool:
    """Say whether the line above the first rows has as many cells as they have, or there is none."""
    rows = [dialect.split(line) for line in lines]
    begin, _ = find_body(dialect.kinds(rows))
    return begin == 0 or len(rows[begin - 1]) == len(rows[begin])


def _score(lines: Sequence[str], dialect: Dialect) -> float:
    """Return how well lines are read: which share of them is the table, and how much of it is numbers."""
    rows = [dialect.split(line) for line in lines]
    begin, end = find_body(dialect.kinds(rows))
    filled = [cell.strip() for row in rows[begin:end] for cell in row if cell.strip() not in MISSING]
    numbers = sum(_count(cell, dialect.decimal) for cell in filled)
    if not numbers:
        return 0.0
    # A column of texts (remarks) is no reason against a delimiter; a comma that splits 0,5 in two gives as many
    # columns, so that lines which agree and the numbers of a line count as well.
    return float((numbers / len(filled)) ** 2 * (end - begin) / len(lines) * (numbers / (end - begin)) ** 0.1)


def _count(cell: str, decimal: str) -> float:
    """Return how certainly a cell is a number: 1,234 may be 1.234, and 0500 may stand behind a decimal sign."""
    cell = _without_unit(cell)
    if PLAIN[decimal].fullmatch(cell) or _STAMP.fullmatch(cell):
        return 0.5 if _LEADING_ZERO.fullmatch(cell) else 1.0
    return (1.0 if decimal in cell else 0.5) if THOUSANDS[decimal].fullmatch(cell) else 0.0


def quote(line: str) -> str:
    """Return a line as an error quotes it."""
    text = line.strip()
    return f"'{text}'" if len(text) <= _QUOTED else f"'{text[:_QUOTED]}...'"
