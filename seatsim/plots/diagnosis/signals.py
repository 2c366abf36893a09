"""Held-out signals before and after, with what is left of them, over time and over frequency."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator, NullLocator

from seatsim.diagnosis.result import Array, Diagnosis, Trace
from seatsim.plots import style
from seatsim.plots.diagnosis.bins import by_band, by_channel, gap, loudest, residual, rms, spectrum
from seatsim.plots.diagnosis.frame import (
    AFTER,
    FONT,
    MEASURED,
    NOISE,
    NOMINAL,
    Picture,
    Quantity,
    frame,
    quantity,
    short,
)  # fmt: skip
from seatsim.plots.style import COLOURS, GREY, Entry, Grid
from seatsim.plots.thinning import Window

SECONDS = 2.0
"""Length of the window that is shown."""
BAND = 2.0
"""Standard deviations of the noise that are shaded."""
LOWEST = 0.25
"""Hz from which on a spectrum is drawn."""
TICKS = (0.3, 1, 3, 10, 30, 100, 300, 1000, 3000)
DECADES = 1.5
"""Decades below the noise that a spectrum shows at most."""
SHORTEST = 64
"""Rows of a run from which on it has a spectrum."""
PER_OCTAVE = 16
EXCESS = 1.1
"""RMS of a residual over its noise up to which it is called noise."""
TALL = (1.85, 1.15)
SHADE = "0.82"


def after_look(diagnosis: Diagnosis) -> Entry:
    """Return what the simulation of `augmented.yaml` is called: without effects it is the refitted nominal one."""
    if not diagnosis.selected:
        return AFTER._replace(label="refitted", colour=COLOURS[2], width=2.6)
    return AFTER._replace(label="with effect" if len(diagnosis.selected) == 1 else "with effects")


def signals(diagnosis: Diagnosis) -> list[Picture]:
    """Return a picture of each channel: the window in which the nominal simulation is most wrong."""
    look = after_look(diagnosis)
    return [_signal(_clearest(traces), look) for traces in _ordered(diagnosis)]


def spectra(diagnosis: Diagnosis) -> list[Picture]:
    """Return a picture of each channel: spectra of what is left before and after, and of the noise."""
    look = after_look(diagnosis)
    return [_spectrum(traces, look) for traces in _ordered(diagnosis) if len(traces[0].time) >= SHORTEST]


def _ordered(diagnosis: Diagnosis) -> list[list[Trace]]:
    """Return the traces by channel, the channel with the largest nominal gap first."""
    return sorted(by_channel(diagnosis.evidence.traces).values(), key=lambda traces: -gap(_clearest(traces)))


def _clearest(traces: list[Trace]) -> Trace:
    """Return the run in which the nominal simulation is most wrong."""
    return max(traces, key=lambda trace: rms(residual(trace).before))


def _signal(trace: Trace, look: Entry) -> Picture:
    shown, left = quantity(trace.channel, trace.unit), residual(trace)
    window = loudest(trace.time, left.before, SECONDS)
    inside = (trace.time >= window.start) & (trace.time <= window.end)
    grid = Grid(TALL, left=0.95, right=0.25, top=0.1, bottom=0.5, gap=(0.0, 0.12))
    page = frame(grid, [MEASURED, NOMINAL, look])
    [upper], [lower] = page.rows
    for course, entry in ((trace.measured, MEASURED), (trace.after, look), (trace.nominal, NOMINAL)):
        style.line(upper, trace.time[inside], shown.factor * course[inside], entry)
    _noise(lower, BAND * trace.noise_rms * shown.factor)
    for course, entry in ((left.after, look), (left.before, NOMINAL)):
        style.line(lower, trace.time[inside], shown.factor * course[inside], entry)
    _finish(upper, lower, window, shown)
    return Picture(_signal_title(trace, shown, look), _signal_caption(trace, window), page.figure)


def _noise(axes: Axes, half: float) -> None:
    axes.axhspan(-half, half, color=SHADE, linewidth=0, zorder=0)
    axes.axhline(0.0, color="0.6", linewidth=0.8, zorder=0.5)


def _finish(upper: Axes, lower: Axes, window: Window, shown: Quantity) -> None:
    upper.tick_params(labelbottom=False)
    upper.set_ylabel(f"{shown.words}\n[{shown.unit}]", fontsize=FONT)
    lower.set_ylabel(f"measured less\nsimulated [{shown.unit}]", fontsize=FONT)
    lower.set_xlabel("time [s]", fontsize=FONT)
    for axes in (upper, lower):
        axes.set_xlim(*window)
        axes.yaxis.set_label_coords(-0.115, 0.5)


def _signal_title(trace: Trace, shown: Quantity, look: Entry) -> str:
    left = residual(trace)
    before, after = (shown.factor * rms(course) for course in left)
    noise = f", noise {shown.factor * trace.noise_rms:.3g} {shown.unit}" if trace.noise_rms > 0 else ""
    if rms(left.before) <= EXCESS * trace.noise_rms:
        return f"{_words(shown)}: nominal already within noise"
    return f"{_words(shown)}: RMS residual {before:.3g} nominal, {after:.3g} {look.label}{noise}"


def _signal_caption(trace: Trace, window: Window) -> str:
    noise = f" Grey band: ±{BAND:g} noise." if trace.noise_rms > 0 else ""
    return f"{window} of {trace.run}, where the nominal residual has most energy.{noise} RMS over the whole run."


def _spectrum(traces: list[Trace], look: Entry) -> Picture:
    first, shown = traces[0], quantity(traces[0].channel, traces[0].unit)
    noise = 2.0 * first.noise_rms**2 * float(np.median(np.diff(first.time)))
    measured = Entry("measured", GREY, width=1.0)
    legend = [measured, NOMINAL, look]
    page = frame(Grid((2.2,), left=0.95, right=0.25, top=0.1, bottom=0.5), legend + [NOISE] * bool(noise))
    axes = page.rows[0][0]
    left = [residual(trace) for trace in traces]
    courses = ([t.measured for t in traces], [r.before for r in left], [r.after for r in left])
    lines = [spectrum(first.time, course) for course in courses]
    for (frequency, power), entry in zip(lines, legend, strict=True):
        centres, density, _ = by_band(frequency, shown.factor**2 * power, LOWEST, PER_OCTAVE)
        style.line(axes, centres, np.where(density > 0, density, np.nan), entry)
    if noise:
        style.line(axes, [LOWEST, 1e4], [shown.factor**2 * noise] * 2, NOISE)
    _axes(axes, lines[0][0], shown.factor**2 * noise, shown)
    noisy = max(rms(course.before) for course in left) <= EXCESS * first.noise_rms
    said = "nominal already within noise" if noisy else _peak(lines[1][0], lines[1][1], lines[2][1], look)
    caption = f"Residuals of the simulation, nominal and {look.label}, and the measured signal. Welch's method."
    return Picture(f"{_words(shown)}: {said}", caption, page.figure)


def _axes(axes: Axes, frequency: Array, noise: float, shown: Quantity) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(LOWEST, frequency[-1])
    ticks = [tick for tick in TICKS if LOWEST <= tick <= frequency[-1]]
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.xaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_locator(LogLocator(numticks=6))
    axes.yaxis.set_minor_locator(NullLocator())
    low, high = axes.get_ylim()
    axes.set_ylim(max(low, noise / 10**DECADES if noise else high / 1e9), high)
    axes.set_xlabel("frequency [Hz]", fontsize=FONT)
    unit = f"({shown.unit})²" if "/" in shown.unit or "·" in shown.unit else f"{shown.unit}²"
    axes.set_ylabel(f"power density [{unit}/Hz]", fontsize=FONT)


def _peak(frequency: Array, before: Array, after: Array, look: Entry) -> str:
    """Return the octave in which most of the nominal residual lies, and what is left of it there."""
    energy = np.concatenate([[0.0], np.cumsum(np.where(frequency >= LOWEST, before, 0.0))])
    first, last = (np.searchsorted(frequency, frequency * side) for side in (2**-0.5, 2**0.5))
    # Over its width, so that white noise does not draw the answer to the highest octave.
    octave = (energy[last] - energy[first]) / np.sqrt(frequency)
    centre = float(frequency[int(np.argmax(octave))])
    near = (frequency >= centre / np.sqrt(2)) & (frequency <= centre * np.sqrt(2))
    ratio = float(np.sqrt(np.sum(after[near]) / max(np.sum(before[near]), 1e-300)))
    return f"nominal residual greatest near {short(centre)} Hz; {look.label}, {100 * ratio:.0f} % of it stays there"


def _words(shown: Quantity) -> str:
    return shown.words[:1].upper() + shown.words[1:]
