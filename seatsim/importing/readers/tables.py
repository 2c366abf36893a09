"""Parquet and Feather files, and the columns of tables as numbers: times and dates in s since the first, texts too."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from seatsim.importing.readers.header import CLOCK, DATE, PLAIN, SIGN, THOUSANDS
from seatsim.importing.readers.reading import TextLayout
from seatsim.importing.signals import TIME, DataFile, Group, Signal, note_left_out, stated_unit
from seatsim.schema.arrays import Array, open_parquet
from seatsim.schema.bounds import BYTES_OF_NUMBER, check_made

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa

_MOST_TEXTS = 0.5
"""Share of the rows that are no numbers from which a column is one of texts."""
_DAY = 86400.0
_AMBIGUOUS = rf"{SIGN}?[1-9]\d{{0,2}}[.,]\d{{3}}"
"""A number that may have a decimal sign, or one between thousands."""
_WORDS_FOR_TIME = ("time", "zeit", "temps")
"""A column of dates without such a word in its name, as an index has it, is called time."""


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
    made, batches = 0, []
    with pa.ipc.open_file(pa.BufferReader(content)) as file:
        for number in range(file.num_record_batches):
            batch = file.get_batch(number)
            made += max(batch.nbytes, BYTES_OF_NUMBER * batch.num_rows * batch.num_columns)
            check_made(made, len(content), "what its columns state")
            batch.validate()
            batches.append(batch)
        return pa.Table.from_batches(batches, file.schema)


class Cells(NamedTuple):
    """Values of shape (N,), NaN where none stands; the unit is `s` where they were read off times.

    `parted` quotes a cell such as `1.234` whose mark was taken for one of thousands, empty where there is none.
    """

    values: Array
    unit: str = ""
    parted: str = ""

    @property
    def is_date(self) -> bool:
        """Say whether these are dates without a time of day."""
        return self.unit == "s" and not (self.values[np.isfinite(self.values)] % _DAY).any()


def read_column(column: pa.ChunkedArray, decimal: str) -> Cells | None:
    """Return a column as numbers, None where most of it is text; cells are texts with this decimal sign."""
    import pyarrow as pa

    kind = column.type
    if any(
        is_kind(kind) for is_kind in (pa.types.is_timestamp, pa.types.is_time, pa.types.is_date, pa.types.is_duration)
    ):
        return Cells(_seconds(column), "s")
    if pa.types.is_null(kind):
        return Cells(np.full(len(column), np.nan))
    if pa.types.is_string(kind) or pa.types.is_large_string(kind):
        return _read_texts(column.to_pandas(), decimal)
    if pa.types.is_dictionary(kind) or not (pa.types.is_primitive(kind) or pa.types.is_decimal(kind)):
        return None
    whole = column.cast(pa.float64(), safe=False).combine_chunks()
    if whole.null_count:
        values = np.asarray(whole.to_numpy(zero_copy_only=False), dtype=np.float64)
    else:  # without pandas, which pyarrow would load, and which takes longer than a small file
        values = np.frombuffer(whole.buffers()[1], np.float64, len(whole), 8 * whole.offset)
    return Cells(values if np.isfinite(values).all() else np.where(np.isfinite(values), values, np.nan))


def _seconds(column: pa.ChunkedArray) -> Array:
    """Return dates, times of day and durations in s since the first, exact to a nanosecond."""
    import pyarrow as pa

    kind = column.type
    if pa.types.is_time(kind):
        fine = pa.time64("ns")
    else:
        fine = pa.duration("ns") if pa.types.is_duration(kind) else pa.timestamp("ns")
    counts = column.cast(fine, safe=False).cast(pa.int64())
    first = counts.drop_null()[0].as_py() if counts.null_count < len(counts) else 0
    there = np.asarray(counts.is_valid())
    return np.where(there, 1e-9 * (np.asarray(counts.fill_null(first)) - first), np.nan)


def _read_texts(texts: pd.Series[str], decimal: str) -> Cells | None:
    """Return texts as numbers, read with the decimal sign by which more of them are numbers, or as times."""
    plain = texts.str.strip()
    found = _numbers(plain, decimal)
    if not np.isfinite(found).all():
        found = max(found, _numbers(plain, "," if decimal == "." else "."), key=lambda each: np.isfinite(each).sum())
    if np.isnan(found).sum() <= _MOST_TEXTS * len(found):
        parted = plain[plain.str.fullmatch(_AMBIGUOUS, na=False) & (np.abs(found) >= 1e3)]
        return Cells(found, parted=f"'{parted.iloc[0]}'" if len(parted) else "")
    times = _read_stamps(plain)
    return None if np.isnan(times).sum() > _MOST_TEXTS * len(times) else Cells(times, "s")


def _numbers(texts: pd.Series[str], decimal: str) -> Array:
    """Return texts as numbers, NaN for those that are none with this decimal sign."""
    import pandas as pd

    parted = texts.str.fullmatch(THOUSANDS[decimal].pattern, na=False)
    is_number = parted | texts.str.fullmatch(PLAIN[decimal].pattern, na=False)
    marks = ".'\u2019 \u00a0\u202f" if decimal == "," else ",'\u2019 \u00a0\u202f"
    plain = texts.where(~parted, texts.str.replace(f"[{marks}]", "", regex=True)).str.replace(decimal, ".", regex=False)
    plain = plain.str.replace("[\u2212\u2013]", "-", regex=True)
    plain = plain.str.replace("[dD]", "e", regex=True)
    return np.asarray(pd.to_numeric(plain.where(is_number), errors="coerce"), dtype=np.float64)


def _read_stamps(texts: pd.Series[str]) -> Array:
    """Return dates with a time of day, or either of them, in s since the first; NaN for what is none."""
    import pandas as pd

    parts = texts.str.extract(rf"^(?P<date>{DATE})?[ T_,-]*(?P<clock>{CLOCK})?\s*(?:Z|UTC|[+-]\d\d:?\d\d)?$")
    if parts.isna().all(axis=None):
        dates = pd.to_datetime(texts.iloc[:5], errors="coerce", format="mixed")
        whole = pd.to_datetime(texts, errors="coerce", format="mixed", utc=True) if dates.notna().all() else dates
        since = (whole - whole.dropna().iloc[0]).dt.total_seconds() if whole.notna().any() else whole
        return np.asarray(since.reindex(texts.index) if len(since) == len(texts) else np.full(len(texts), np.nan))
    days = _days(parts["date"])
    clock = _clock_seconds(parts["clock"])
    total = np.where(parts["date"].isna(), 0.0, _DAY * days) + np.where(parts["clock"].isna(), 0.0, clock)
    total = np.where(parts["date"].isna() & parts["clock"].isna(), np.nan, total)
    there = np.flatnonzero(np.isfinite(total))
    return total - total[there[0]] if len(there) else total


def _days(dates: pd.Series[str]) -> Array:
    """Return dates as days since the first; of day and month that one comes first with which they span less."""
    import pandas as pd

    each = dates.dropna().unique()
    if not len(each):
        return np.full(len(dates), np.nan)
    ways = [pd.to_datetime(pd.Series(each), errors="coerce", format="mixed", dayfirst=first) for first in (True, False)]
    days = [(way - way.min()).dt.days.to_numpy(dtype=np.float64) for way in ways]
    best = min(days, key=lambda found: (np.isnan(found).sum(), np.nanmax(found, initial=0.0)))
    return np.asarray(dates.map(dict(zip(each, best, strict=True))), dtype=np.float64)


def _clock_seconds(clocks: pd.Series[str]) -> Array:
    """Return times of day in s: `16:53:12.5`, `4:53:12 PM`, `16:53:12:500`, and `53:12.5` in minutes and seconds."""
    parts = clocks.str.extract(r"^(\d{1,2}):(\d{2})(?::(\d{2}))?(?:[.,:](\d+))?\s*([AaPp])?")
    first, second, third = (parts[column].astype(float) for column in range(3))
    part = ("0." + parts[3].fillna("0")).astype(float)
    half = parts[4].str.lower()
    hours = first.where(half.isna(), first % 12 + 12.0 * (half == "p"))
    of_day = 3600.0 * hours + 60.0 * second + third.fillna(0.0) + part
    in_minutes = third.isna() & parts[3].notna()
    return np.asarray(of_day.where(~in_minutes, 60.0 * first + second + part), dtype=np.float64)
