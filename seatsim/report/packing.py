"""Long signals made small enough for a page: every value where there is room, in 16 bits, as differences, deflated."""

from __future__ import annotations

import base64
import zlib
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple, TypeAlias

import numpy as np

from seatsim.diagnosis.result import Trace
from seatsim.plots.thinning import thin_line
from seatsim.report.blocks import Line, Signals
from seatsim.schema.arrays import Array
from seatsim.schema.printing import Quantity, describe_channel

BUDGET = 200_000
"""Bytes that the lines of one group of pictures take on the page together."""
FINEST, QUICK = 50_000, 3_000
"""Most intervals of a line, of two values each, in a report and on a page that is made in an instant."""
_COARSEST = 100
_LEVEL = 6
"""Level of zlib."""
LEVELS = 32767
GAP = -32768
"""Stands for a value that is not known."""
MEASURED, NOMINAL = 8, 9
"""Looks of what lies wide and pale below another line; looks 0 to 7 are those of the figures' colours."""

_Line: TypeAlias = dict[str, float | str]


class Panel(NamedTuple):
    """A picture: its quantity and unit, and for each run the values of every line (None: absent)."""

    quantity: str
    unit: str
    values: Mapping[str, Sequence[Array | None]]


def pack_signals(
    caption: str,
    lines: Sequence[tuple[str, int] | tuple[str, int, float]],
    time: Mapping[str, Array],
    panels: Sequence[Panel],
    finest: int = FINEST,
) -> Signals:
    """Return linked pictures of signals over time.

    Lines of more values than fit keep the least and the largest value of every interval, in their order, so that no
    peak is lost; the caption says how long an interval is. Every value is rounded to 1/65534 of the range of its line.

    Args:
        caption: a sentence on all of them.
        lines: name and look of each, and its opacity where that is not 1.
        time: in s, equally spaced, shape (N,), of each run.
        panels: the pictures.
        finest: most intervals of a line.
    """
    drawn, longest = [Line(*line) for line in lines], max(time.values(), key=len)
    bins = min(finest, -(-len(longest) // 2))
    shown = [describe_channel(panel.quantity, panel.unit) for panel in panels]
    packed, size = _pack_panels(panels, shown, list(time), bins)
    while bins > _COARSEST and size > BUDGET:
        # What noise there is takes the same bits in each value, whatever their number.
        bins = max(_COARSEST, int(0.95 * bins * BUDGET / size))
        packed, size = _pack_panels(panels, shown, list(time), bins)
    if len(longest) > 2 * bins:
        interval = 1000.0 * float(longest[-1] - longest[0]) / bins
        caption += f" Drawn are the least and the largest value in every {interval:.3g} ms; figures use all samples."
    data = {
        "lines": [line._asdict() for line in drawn],
        "runs": [_pack_time(values, bins) for values in time.values()],
        "panels": [{"unit": each.unit, "runs": runs} for each, runs in zip(shown, packed, strict=True)],
    }
    titles = [f"{each.axis[:1].upper()}{each.axis[1:]}" for each in shown]
    return Signals("signals-time", caption, list(time), drawn, titles, data)


def pack_traces(traces: Iterable[Trace], lines: Mapping[str, tuple[str, int]], finest: int = FINEST) -> Signals:
    """Return linked pictures of compared channels, of every run.

    traces: in the order of runs and channels. lines: name and look of what is drawn, by its name in a trace. finest: as
    for `pack_signals`.
    """
    runs: dict[str, dict[str, Trace]] = {}
    for trace in traces:
        runs.setdefault(trace.run, {})[trace.channel] = trace
    units = {channel: trace.unit for found in runs.values() for channel, trace in found.items()}
    panels = [
        Panel(channel, unit, {
            run: [getattr(found[channel], name) if channel in found else None for name in lines]
            for run, found in runs.items()
        })
        for channel, unit in units.items()
    ]  # fmt: skip
    time = {run: next(iter(found.values())).time for run, found in runs.items()}
    return pack_signals("Every run is in the list above the pictures.", list(lines.values()), time, panels, finest)


def pack_line(values: Array) -> _Line:
    """Return values as integers of 16 bits, with the offset and the step that make numbers of them again.

    The integers are differences modulo 2^16, their low bytes before their high ones, deflated, in base 64.
    """
    known = values[np.isfinite(values)]
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 0.0)
    middle, step = 0.5 * (low + high), (high - low) / (2 * LEVELS) or 1.0
    whole = np.where(np.isfinite(values), np.round((np.nan_to_num(values) - middle) / step), GAP)
    steps = np.diff(np.clip(whole, GAP, LEVELS).astype("<i2"), prepend=np.int16(0))
    bits = zlib.compress(steps.view(np.uint8).reshape(-1, 2).T.tobytes(), _LEVEL)
    return {"at": middle, "step": step, "bits": base64.b64encode(bits).decode("ascii")}


def _pack_time(values: Array, bins: int) -> dict[str, float]:
    """Return the first place of the values of a run, and the distance of the next."""
    first, interval = float(values[0]), float(values[-1] - values[0]) / max(1, len(values) - 1)
    if len(values) > 2 * bins:
        half = 0.5 * interval * -(-len(values) // bins)
        return {"first": first + 0.5 * half, "step": half}
    return {"first": first, "step": interval}


def _pack_panels(
    panels: Sequence[Panel], shown: Sequence[Quantity], runs: Sequence[str], bins: int
) -> tuple[list[list[list[_Line | None]]], int]:
    """Return the lines of each run of each panel, in the unit in which it is shown, and the bytes of all lines."""

    def pack(line: Array | None, factor: float) -> _Line | None:
        return None if line is None else pack_line(factor * thin_line(line, line, bins)[1])

    scaled = zip(panels, shown, strict=True)
    packed = [[[pack(line, each.factor) for line in panel.values[run]] for run in runs] for panel, each in scaled]
    return packed, sum(len(str(line["bits"])) for panel in packed for run in panel for line in run if line)
