"""One quantity over another as SVG paths: loops, clouds of points, maps of cells."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from seatsim.report.blocks import Facets, Plane, Shape, Tick
from seatsim.report.formatting import format_number
from seatsim.schema.arrays import Array

SIDE = 1000.0
"""Side of the square in which paths are drawn, whatever the shape of the picture."""
TICKS = 5
SHADES = 10
LOOKS = 8
MARGIN = 0.04


class Curve(NamedTuple):
    """A line (or dots) of a plane: its name in the legend (empty: none), x and y, shape (N,), and its look."""

    name: str
    x: Array
    y: Array
    look: int
    form: str = "line"


class Range(NamedTuple):
    """Least and greatest value of an axis."""

    low: float
    high: float

    def place(self, values: Array) -> Array:
        """Return where values stand between the ends, 0 to 1."""
        return np.asarray((values - self.low) / (self.high - self.low))


def draw_curves(title: str, caption: str, axes: tuple[str, str], curves: Sequence[Curve]) -> Plane:
    """Return a plane with lines and clouds of points; one without a finite point says that it is empty."""
    xs = [curve.x[np.isfinite(curve.x) & np.isfinite(curve.y)] for curve in curves]
    ys = [curve.y[np.isfinite(curve.x) & np.isfinite(curve.y)] for curve in curves]
    if not any(len(x) for x in xs):
        return Plane(title, caption, *axes, [], [], [], [], "Nothing to draw: no finite values.")
    across, up = find_range(np.concatenate(xs)), find_range(np.concatenate(ys))
    shapes = [
        Shape(_write_path(across.place(curve.x), up.place(curve.y), curve.form), curve.look % LOOKS, curve.form)
        for curve in curves
    ]
    legend = list(dict.fromkeys((curve.name, curve.look % LOOKS, curve.form) for curve in curves if curve.name))
    return Plane(title, caption, *axes, list_ticks(across), list_ticks(up), shapes, legend)


def join_planes(title: str, caption: str, planes: Sequence[Plane]) -> Facets:
    """Return planes as one figure; the legend names each look once."""
    return Facets(title, caption, planes, list(dict.fromkeys(entry for plane in planes for entry in plane.legend)))


def draw_cells(
    title: str, axes: tuple[str, str], borders: tuple[Array, Array], values: Array, ends: Range, unit: str
) -> Plane:
    """Return a map: values, shape (rows, columns), between borders of columns and rows, shaded over log10 of `ends`."""
    across, up = (Range(float(edges[0]), float(edges[-1])) for edges in borders)
    x, y = SIDE * across.place(borders[0]), SIDE * (1.0 - up.place(borders[1]))
    shade = np.log(np.clip(values, ends.low, ends.high) / ends.low) / max(math.log(ends.high / ends.low), 1e-12)
    paths: dict[int, list[str]] = {}
    for row, column in np.argwhere(np.isfinite(values)):
        left, right, bottom, top = x[column], x[column + 1], y[row], y[row + 1]
        level = min(SHADES - 1, int(SHADES * shade[row, column]))
        paths.setdefault(level, []).append(f"M{left:.0f} {bottom:.0f}H{right:.0f}V{top:.0f}H{left:.0f}Z")
    shapes = [Shape("".join(parts), level, "cell") for level, parts in sorted(paths.items())]
    steps = np.geomspace(ends.low, ends.high, SHADES + 1)
    legend = [
        (f"{format_number(steps[k], 2)} to {format_number(steps[k + 1], 2)} {unit}", k, "cell") for k in range(SHADES)
    ]
    empty = "" if shapes else "Nothing to draw: too few samples in every cell."
    return Plane(title, "", *axes, list_ticks(across), list_ticks(up), shapes, legend, empty)


def find_range(values: Array) -> Range:
    """Return the range that holds values with a little room on either side."""
    low, high = float(np.min(values)), float(np.max(values))
    room = MARGIN * (high - low) or 0.5 * abs(low) or 0.5
    return Range(low - room, high + room)


def list_ticks(ends: Range) -> list[Tick]:
    """Return marks at round values, 1, 2 or 5 times a power of ten apart."""
    raw = (ends.high - ends.low) / TICKS
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(factor * power for factor in (1, 2, 5, 10) if factor * power >= raw)
    first = math.ceil(ends.low / step)
    marks = [k * step for k in range(first, math.floor(ends.high / step) + 1)]
    decimals = max(0, -math.floor(math.log10(step) + 1e-9))
    return [
        Tick(round(100 * (mark - ends.low) / (ends.high - ends.low), 2), f"{mark + 0.0:.{decimals}f}".replace("-", "−"))
        for mark in marks
    ]


def _write_path(x: Array, y: Array, form: str) -> str:
    """Return a path; a dot is a line without length, which the round ends of its pen make visible."""
    points = np.column_stack([SIDE * x, SIDE * (1.0 - y)])
    if form == "dots":
        return "".join(f"M{a:.0f} {b:.0f}h0" for a, b in points if math.isfinite(a + b))
    pen, parts = "M", []
    for a, b in points:
        if not math.isfinite(a + b):
            pen = "M"
            continue
        parts.append(f"{pen}{a:.0f} {b:.0f}")
        pen = "L"
    return "".join(parts)
