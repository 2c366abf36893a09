"""Limits that a damper has to keep: which figures they may be on, and whether the tables of a bench day keep them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from seatsim.characterisation.sheet import BenchSheet, LimitCheck
from seatsim.schema.errors import nearest
from seatsim.schema.validation import check_keys, mapping
from seatsim.schema.yaml_source import Source

_TIMES = ("start", "t10", "t63", "t90", "settling", "recovery", "overshoot", "dip", "current_overshoot")
_FIGURES = {
    "rebound": ("peak_forces", "rebound"),
    "compression": ("peak_forces", "compression"),
    "spread": ("peak_forces", "spread"),
    "gas_force": ("gas_force", "force"),
    "friction": ("friction", "force"),
    "dynamic_range": ("dynamic_range", "both"),
    "hysteresis": ("hysteresis", "width"),
    "energy": ("energy", "energy"),
    "current_hysteresis": ("current_hysteresis", "width"),
    "fade": ("fade", "per_kelvin"),
    "fade_by_energy": ("fade", "per_kilojoule"),
}
"""Table and column of each figure that may have a limit, beside the times of responses."""


def check_limits(sheet: BenchSheet, file: Path) -> list[LimitCheck]:
    """Return each limit of a file, `limits: {t90_up: {max: 0.025}}`, with the worst value of its figure.

    A figure is one of `_FIGURES`, or one of the response times with `_up` or `_down`, for steps to a larger or to a
    smaller current. A figure that the tables do not hold fails.

    Raises:
        InputError: the file holds no limits, or one of them is on no such figure or no number.
    """
    source = Source(file)
    check_keys(source.data, ("limits",), source, ())
    stated = mapping(source.data.get("limits"), source, ("limits",))
    return [check for name, bounds in stated.items() for check in _check(sheet, source, str(name), bounds)]


def _check(sheet: BenchSheet, source: Source, name: str, bounds: object) -> Iterator[LimitCheck]:
    figures = _list_figures(sheet)
    if name not in figures:
        permitted = f"permitted: {', '.join(figures)}"
        raise source.error(("limits", name), f"is no figure of a damper{nearest(name, figures)}; {permitted}")
    values = figures[name]
    for bound, limit in mapping(bounds, source, ("limits", name)).items():
        keys = ("limits", name, str(bound))
        if bound not in ("min", "max"):
            raise source.error(keys, "is no bound; permitted: min, max")
        if isinstance(limit, bool) or not isinstance(limit, int | float):
            raise source.error(keys, f"{limit!r} is no number")
        worst = (max if bound == "max" else min)(values, default=math.nan)
        kept = worst <= limit if bound == "max" else worst >= limit
        yield LimitCheck(name, worst, float(limit), str(bound), kept)


def _list_figures(sheet: BenchSheet) -> Mapping[str, list[float]]:
    """Return the values of every figure that may have a limit."""
    found = {name: _list_column(getattr(sheet, table), column) for name, (table, column) in _FIGURES.items()}
    for name in _TIMES:
        for way, sign in (("up", 1.0), ("down", -1.0)):
            rows = [each for each in sheet.response if sign * (each.after - each.before) > 0.0]
            found[f"{name}_{way}"] = _list_column(rows, name)
    return found


def _list_column(rows: Iterable[object], column: str) -> list[float]:
    """Return the values of a column that are known."""
    return [value for row in rows if math.isfinite(value := getattr(row, column))]
