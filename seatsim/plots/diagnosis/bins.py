"""What the pictures of a diagnosis count: residuals in bins, spectra, the most telling window."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim import metrics
from seatsim.diagnosis.result import Array, Diagnosis, Trace
from seatsim.plots.thinning import Window
from seatsim.recordings.compared import LEFT_OUT

FEWEST = 20
"""Samples below which a bin is left empty."""
SEGMENT = 4.0
"""Longest segment of a spectrum in s."""
AVERAGES = 4
"""Fewest half-overlapping segments of a spectrum."""
STRIDE = 0.05
"""Raster in s on which a telling window begins."""


class Residual(NamedTuple):
    """What is left of a channel: measured less nominal, and measured less the simulation with the effects."""

    before: Array
    after: Array


def residual(trace: Trace) -> Residual:
    """Return what is left of a channel before and after."""
    return Residual(trace.measured - trace.nominal, trace.measured - trace.after)


def by_channel(traces: list[Trace]) -> dict[str, list[Trace]]:
    """Return the traces of each channel, without the first second, in the order in which channels appear."""
    found: dict[str, list[Trace]] = {}
    for trace in traces:
        rest = settled(trace)
        if len(rest.time) > 1:
            found.setdefault(trace.channel, []).append(rest)
    return found


def settled(trace: Trace) -> Trace:
    """Return a trace without the first second of its run, which no gap counts."""
    part = slice(_begin(trace.time), None)
    return replace(
        trace, time=trace.time[part], measured=trace.measured[part], nominal=trace.nominal[part],
        calibrated=trace.calibrated[part], after=trace.after[part],
    )  # fmt: skip


def worst(diagnosis: Diagnosis) -> tuple[Trace, dict[str, Array]] | None:
    """Return the trace with the largest nominal gap whose motion is known, with that motion; None without traces.

    The motion is that of the first held-out run; a trace of another length is of another run.
    """
    motion = diagnosis.evidence.motion
    length = max((len(values) for values in motion.values()), default=0)
    fitting = [trace for trace in diagnosis.evidence.traces if len(trace.time) == length or not length]
    same = [trace for trace in fitting if trace.run == fitting[0].run and len(settled(trace).time) > 1]
    if not same:
        return None
    gaps = diagnosis.gap.before.get("channels", {})
    chosen = max(same, key=lambda trace: gaps.get(trace.channel, gap(trace)))
    begin = _begin(chosen.time)
    return settled(chosen), {name: values[begin:] for name, values in motion.items() if len(values) == length}


def rms(values: Array) -> float:
    """Return the root of the mean square."""
    return float(np.sqrt(np.mean(np.square(values)))) if values.size else 0.0


def step(time: Array) -> float:
    """Return the interval between rows in s."""
    return float((time[-1] - time[0]) / (len(time) - 1))


def loudest(time: Array, values: Array, seconds: float) -> Window:
    """Return the window of that many seconds in which the energy is greatest, the first of equals."""
    interval = step(time)
    size = round(seconds / interval)
    if size >= len(values):
        return Window(float(time[0]), float(time[-1]))
    energy = np.concatenate([[0.0], np.cumsum(np.square(values))])
    starts = np.arange(0, len(values) - size, max(1, round(STRIDE / interval)))
    start = int(starts[np.argmax(energy[starts + size] - energy[starts])])
    return Window(float(time[start]), float(time[start + size]))


def edges(values: Array, count: int) -> Array:
    """Return the borders of equal bins over a quantity, without its rarest extremes."""
    low, high = np.percentile(values, (0.5, 99.5))
    return np.linspace(low, high, count + 1)


def varies(values: Array | None) -> bool:
    """Tell whether a quantity is known and moves beyond rounding."""
    if values is None or not values.size:
        return False
    low, high = np.percentile(values, (1.0, 99.0))
    return bool(np.isfinite(low) and high - low > 1e-3 * max(abs(low), abs(high)))


def binned_rms(x: Array, values: Array, borders: Array) -> Array:
    """Return the RMS of values in bins over x; NaN in bins of too few."""
    count, _ = np.histogram(x, borders)
    energy, _ = np.histogram(x, borders, weights=np.square(values))
    return _root(energy, count)


def binned_mean(x: Array, values: Array, borders: Array) -> Array:
    """Return the mean of values in bins over x; NaN in bins of too few."""
    count, _ = np.histogram(x, borders)
    total, _ = np.histogram(x, borders, weights=values)
    return np.asarray(np.where(count >= FEWEST, total / np.maximum(count, 1), np.nan))


def mapped_rms(x: Array, y: Array, values: Array, borders: tuple[Array, Array]) -> Array:
    """Return the RMS of values in bins over x and y, shape (bins of y, bins of x); NaN in bins of too few."""
    ends = list(borders)
    count, _, _ = np.histogram2d(x, y, bins=ends)
    energy, _, _ = np.histogram2d(x, y, bins=ends, weights=np.square(values))
    return _root(energy, count).T


def spectrum(time: Array, courses: list[Array]) -> tuple[Array, Array]:
    """Return frequency in Hz and power density by Welch's method, the mean over runs; without the mean value."""
    rate = 1.0 / step(time)
    shortest = min(len(values) for values in courses)
    length = max(8, min(round(SEGMENT * rate), 2 * shortest // (AVERAGES + 1)))
    found = [metrics.power_spectral_density(values, rate, min(length, shortest)) for values in courses]
    return found[0][0][1:], np.mean([power for _, power in found], axis=0)[1:]


def by_band(frequency: Array, power: Array, lowest: float, per_octave: int) -> tuple[Array, Array, NDArray[np.int64]]:
    """Return mean frequency, mean density and number of lines of bands of equal width on a logarithmic axis."""
    inside = frequency >= lowest
    band = np.floor(per_octave * np.log2(frequency[inside] / lowest)).astype(int)
    _, index, count = np.unique(band, return_inverse=True, return_counts=True)
    return np.bincount(index, frequency[inside]) / count, np.bincount(index, power[inside]) / count, count


def _begin(time: Array) -> int:
    return int(np.searchsorted(time, LEFT_OUT - 1e-9))


def gap(trace: Trace) -> float:
    """Return the RMS of the nominal residual over the standard deviation of what was measured."""
    spread = float(np.std(trace.measured))
    return rms(residual(trace).before) / spread if spread > 0 else 0.0


def _root(energy: Array, count: Array) -> Array:
    return np.asarray(np.where(count >= FEWEST, np.sqrt(energy / np.maximum(count, 1)), np.nan))
