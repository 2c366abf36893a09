"""What simulations leave of measured signals: without the start of a run, by channel, in bins of the motion.

A gap and a diagnosis are shown by the same signals: the gap has one simulation, in the place of each of the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from seatsim.diagnosis.result import Diagnosis, Trace
from seatsim.metrics.motion import rms
from seatsim.recordings.gap import Gap
from seatsim.recordings.replay import LEFT_OUT
from seatsim.schema.arrays import Array

FEWEST = 20
"""Samples below which a bin is left empty: the standard error of an RMS is 1 / sqrt(2 n), a sixth of it at 20."""


def list_traces(found: Gap) -> list[Trace]:
    """Return the channels of a gap, of every run in which each was recorded."""
    traces = []
    for name in found.channels:
        recorded = {run: pair for run, pair in found.replayed.items() if name in pair.measured}
        every = [pair.measured[name] for pair in recorded.values()]
        noise = found.floor.channels[name] * float(np.std(np.concatenate(every))) if every else 0.0
        for run, pair in recorded.items():
            simulated = [pair.simulated[name]] * 3
            traces.append(Trace(run, name, pair.units[name], noise, pair.time, pair.measured[name], *simulated))
    return traces


def group_by_channel(traces: Sequence[Trace]) -> dict[str, list[Trace]]:
    """Return the signals of each channel, without the first second, in the order in which channels appear."""
    found: dict[str, list[Trace]] = {}
    for trace in traces:
        rest = drop_start(trace)
        if len(rest.time) > 1:
            found.setdefault(trace.channel, []).append(rest)
    return found


def drop_start(trace: Trace) -> Trace:
    """Return a signal without the first second of its run, which no gap counts."""
    first = _first_row(trace.time)
    signals = ("time", "measured", "nominal", "calibrated", "after")
    return replace(trace, **{name: getattr(trace, name)[first:] for name in signals})


def find_worst(diagnosis: Diagnosis) -> tuple[Trace, dict[str, Array]] | None:
    """Return the signal with the largest nominal gap whose motion is known, with that motion; None without signals.

    The motion is that of the first held-out run; a signal of another length is of another run.
    """
    motion = diagnosis.evidence.motion
    length = max((len(values) for values in motion.values()), default=0)
    fitting = [trace for trace in diagnosis.evidence.traces if len(trace.time) == length or not length]
    same = [trace for trace in fitting if trace.run == fitting[0].run and len(drop_start(trace).time) > 1]
    if not same:
        return None
    gaps = diagnosis.gap.before.channels
    chosen = max(same, key=lambda trace: gaps.get(trace.channel, nominal_gap(trace)))
    begin = _first_row(chosen.time)
    return drop_start(chosen), {name: values[begin:] for name, values in motion.items() if len(values) == length}


def bin_edges(values: Array, count: int) -> Array:
    """Return the borders of `count` equal bins over a quantity, shape (count + 1,).

    The rarest half per cent at either end is left out, since a few extremes would stretch the bins over empty range.
    """
    low, high = np.percentile(values, (0.5, 99.5))
    return np.linspace(low, high, count + 1)


def varies(values: Array | None) -> bool:
    """Return whether a quantity is known and moves beyond rounding: by a thousandth of its magnitude."""
    if values is None or not values.size:
        return False
    low, high = np.percentile(values, (1.0, 99.0))
    return bool(np.isfinite(low) and high - low > 1e-3 * max(abs(low), abs(high)))


def map_rms(x: Array, y: Array, values: Array, borders: tuple[Array, Array]) -> Array:
    """Return the RMS of values in bins over x and y, shape (bins of y, bins of x); NaN in bins of too few."""
    ends = list(borders)
    count, _, _ = np.histogram2d(x, y, bins=ends)
    energy, _, _ = np.histogram2d(x, y, bins=ends, weights=np.square(values))
    return np.asarray(np.where(count >= FEWEST, np.sqrt(energy / np.maximum(count, 1)), np.nan)).T


def nominal_gap(trace: Trace) -> float:
    """Return the nominal gap of one signal, RMS(measured - nominal) / std(measured); 0 where nothing was measured."""
    spread = float(np.std(trace.measured))
    return rms(trace.measured - trace.nominal) / spread if spread > 0 else 0.0


def _first_row(time: Array) -> int:
    # Times are multiples of a step: the slack keeps rounding from moving the cut by a row.
    return int(np.searchsorted(time, LEFT_OUT - 1e-9))
