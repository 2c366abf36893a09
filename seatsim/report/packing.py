"""Signals made small enough for a page: the least and largest value of every interval, in 16 bits each."""

from __future__ import annotations

import base64
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from seatsim.plots import labels
from seatsim.report.blocks import Signals
from seatsim.report.formatting import describe_channel
from seatsim.schema.arrays import Array

BUDGET = 330_000
"""Bytes that the lines of one group of pictures take on the page together."""
BYTES = 8 / 3
"""Bytes of a value on the page: 16 bits in base 64."""
MOST_VALUES = 2400
"""Most values of a line: two for each of 1200 intervals, finer than the pixels of a picture."""
LEVELS = 32767
GAP = -32768
"""Stands for a value that is not known."""


class Panel(NamedTuple):
    """A picture: its quantity and unit, a sentence on it, and for each run the values of every line (None: absent)."""

    quantity: str
    unit: str
    sentence: str
    values: Mapping[str, Sequence[Array | None]]


class Axis(NamedTuple):
    """What the pictures of a group are drawn over: a name and a unit, and values, shape (N,), for each run."""

    name: str
    unit: str
    values: Mapping[str, Array]
    logarithmic: bool = False


def pack_signals(
    identity: str, caption: str, lines: Sequence[tuple[str, int]], axis: Axis, panels: Sequence[Panel],
    logarithmic: bool = False,
) -> Signals:  # fmt: skip
    """Return linked pictures of signals over time or frequency.

    A line of more values than fit keeps the least and the largest value of every interval, in their order, so that no
    peak is lost; the caption says how long an interval is. Every value is rounded to 1/65534 of the range of its line.
    """
    runs = list(axis.values)
    take = _take_logarithm if logarithmic else np.asarray
    count = sum(line is not None for panel in panels for each in panel.values.values() for line in each)
    most = min(MOST_VALUES, max(200, int(BUDGET / BYTES / max(1, count))) // 2 * 2)
    longest = max((values for values in axis.values.values()), key=len)
    if len(longest) > most and not axis.logarithmic:
        interval = 2000.0 * float(longest[-1] - longest[0]) / most
        caption += f" Drawn are the least and the largest value in every {interval:.0f} ms; figures use all samples."
    data: dict[str, Any] = {
        "x": {"name": axis.name, "unit": labels.format_unit(axis.unit), "log": axis.logarithmic},
        "log": logarithmic,
        "lines": [{"name": name, "look": look} for name, look in lines],
        "runs": [_pack_axis(values, most, axis.logarithmic) for values in axis.values.values()],
        "panels": [_pack_panel(panel, runs, most, take) for panel in panels],
    }
    titles = [(_make_title(panel), panel.sentence) for panel in panels]
    return Signals(identity, caption, runs, lines, titles, data)


def reduce_line(values: Array, most: int) -> Array:
    """Return at most `most` values: the least and the largest of every interval in their order, or all of them."""
    if len(values) <= most:
        return values
    size = -(-len(values) * 2 // most)
    bins = np.pad(values, (0, -len(values) % size), mode="edge").reshape(-1, size)
    ends = np.sort(np.column_stack([bins.argmin(axis=1), bins.argmax(axis=1)]), axis=1)
    return np.asarray(np.take_along_axis(bins, ends, axis=1).ravel())


def pack_line(values: Array) -> dict[str, Any]:
    """Return values as 16-bit integers in base 64, with the offset and the step that make numbers of them again."""
    known = values[np.isfinite(values)]
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 0.0)
    middle, step = 0.5 * (low + high), (high - low) / (2 * LEVELS) or 1.0
    whole = np.where(np.isfinite(values), np.round((np.nan_to_num(values) - middle) / step), GAP)
    bits = np.clip(whole, GAP, LEVELS).astype("<i2").tobytes()
    return {"at": middle, "step": step, "bits": base64.b64encode(bits).decode("ascii")}


def _pack_axis(values: Array, most: int, listed: bool) -> dict[str, Any]:
    """Return the places of the values of a run: listed, or a first one and the distance of the next."""
    if listed:
        return {"list": [float(f"{value:.5g}") for value in values]}
    length = len(values)
    interval = float(values[-1] - values[0]) / max(1, length - 1)
    if length > most:
        half = 0.5 * interval * -(-length * 2 // most)
        return {"first": float(values[0]) + 0.5 * half, "step": half}
    return {"first": float(values[0]), "step": interval}


def make_density(quantity: str, unit: str, values: Mapping[str, Sequence[Array | None]], sentence: str = "") -> Panel:
    """Return a picture of power spectral densities, given in (SI unit)^2/Hz, in the square of the unit shown."""
    shown = describe_channel(quantity, unit)
    scaled = {
        run: [None if line is None else shown.factor**2 * line for line in lines] for run, lines in values.items()
    }
    square = f"({shown.unit})²" if "/" in shown.unit else f"{shown.unit}²"
    return Panel(f"{quantity}, power density", f"{square}/Hz", sentence, scaled)


def _take_logarithm(values: Array) -> Array:
    """Return log10 of values, NaN where they are not positive; the page raises them to powers again."""
    return np.log10(np.where(values > 0, values, np.nan))


def _pack_panel(panel: Panel, runs: Sequence[str], most: int, take: Callable[[Array], Array]) -> dict[str, Any]:
    shown = describe_channel(panel.quantity, panel.unit)
    return {
        "unit": shown.unit,
        "runs": [
            [None if line is None else pack_line(take(shown.factor * reduce_line(np.asarray(line, float), most)))
             for line in panel.values[run]]
            for run in runs
        ],
    }  # fmt: skip


def _make_title(panel: Panel) -> str:
    shown = describe_channel(panel.quantity, panel.unit)
    return f"{shown.words[:1].upper()}{shown.words[1:]} [{shown.unit}]"
