"""Reading of two columns of a table; a record that is not evenly sampled is refused."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError, nearest
from seatsim.schema.guarded import is_there
from seatsim.schema.tables import numbers, read_table

if TYPE_CHECKING:
    import pandas as pd

LEAST_ROWS = 16
# Rounded times of a steady clock deviate by less than this part of an interval; a lost row deviates by more.
LARGEST_JITTER = 0.25


class EvenSeries(NamedTuple):
    """Values at even intervals of time (s) or distance (m)."""

    interval: float
    values: Array

    @property
    def length(self) -> float:
        """From the first to the last value, in s or m."""
        return self.interval * (len(self.values) - 1)

    def after(self, start: float) -> EvenSeries:
        """Return the record from `start` on, in s or m after the first value."""
        return self._replace(values=self.values[round(start / self.interval) :])


def read_record(path: str, axis: str, column: str, start: float) -> EvenSeries:
    """Read `column` of a CSV (or CSV.gz) table over its column `axis`, from `start` after its first row.

    Raises:
        InputError: no such file or column, not a table, fewer than 16 rows, an entry that is not a finite
            number, or an `axis` that does not grow in even intervals.
    """
    table = _read(path, axis, column)
    if len(table) < LEAST_ROWS:
        raise InputError(f"{path}: {len(table)} rows are too few; permitted: at least {LEAST_ROWS}")
    position = _numbers(path, table, axis)
    whole = EvenSeries(_interval(path, axis, position), _numbers(path, table, column))
    record = whole.after(start)
    if len(record.values) < LEAST_ROWS:
        raise InputError(f"{path}: start {start:g} leaves fewer than {LEAST_ROWS} rows of {whole.length:g} (s or m)")
    return record


def _read(path: str, axis: str, column: str) -> pd.DataFrame:
    if not is_there(Path(path)):
        raise InputError(f"{path}: no such file{_neighbour(Path(path))}")
    table = read_table(Path(path))
    for name in (axis, column):
        _check_column(path, name, list(map(str, table)))
    return table


def _check_column(path: str, name: str, known: list[str]) -> None:
    if name not in known:
        shown = ", ".join(known[:8]) + (f", ... ({len(known)} in all)" if len(known) > 8 else "")
        raise InputError(f"{path}: no column '{name}'{nearest(name, known)}; columns: {shown}")


def _neighbour(path: Path) -> str:
    return nearest(path.name, (p.name for p in path.parent.iterdir())) if path.parent.is_dir() else ""


def _numbers(path: str, table: pd.DataFrame, name: str) -> Array:
    values, bad = numbers(table, name)
    if len(bad):
        raise InputError(
            f"{path}, line {bad[0] + 2}: column '{name}' holds '{table[name].iloc[bad[0]]}', not a number "
            f"({len(bad)} of {len(values)} rows); choose another column or mend the table"
        )
    return values


def _interval(path: str, axis: str, position: Array) -> float:
    back = np.flatnonzero(np.diff(position) <= 0)
    if len(back):
        raise InputError(f"{path}, line {back[0] + 3}: column '{axis}' does not grow; sort the rows, drop repeats")
    interval = float(position[-1] - position[0]) / (len(position) - 1)
    jitter = np.abs(position - position[0] - interval * np.arange(len(position)))
    worst = int(np.argmax(jitter))
    if jitter[worst] > LARGEST_JITTER * interval:
        raise InputError(
            f"{path}, line {worst + 2}: column '{axis}' is {jitter[worst]:.3g} off even steps of "
            f"{interval:g}; permitted: {LARGEST_JITTER:g} of a step; resample the table at a steady rate"
        )
    return interval
