"""Held-out signals before and after, with what is left of them, over time and over frequency."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator, NullLocator

from seatsim.diagnosis.result import Diagnosis, Trace
from seatsim.metrics.motion import rms
from seatsim.plots import style
from seatsim.plots.averaging import average_bands
from seatsim.plots.diagnosis.bins import (
    LOWEST,
    SHORTEST,
    compute_residual,
    estimate_spectrum,
    find_window,
    group_by_channel,
    nominal_gap,
)
from seatsim.plots.diagnosis.frame import MEASURED, NOISE, NOMINAL, choose_after_look, scale_frequency_axis
from seatsim.plots.frame import FONT, Picture, describe_quantity, format_number, make_frame
from seatsim.plots.quantities import Quantity
from seatsim.plots.style import GREY, Entry, Grid
from seatsim.plots.thinning import Window
from seatsim.schema.arrays import Array

SECONDS = 2.0
"""Length in s of the window that is shown."""
BAND = 2.0
"""Standard deviations of the noise that are shaded."""
DECADES = 1.5
"""Decades below the noise that a spectrum shows at most."""
PER_OCTAVE = 16
"""Bands in an octave of a spectrum."""
EXCESS = 1.1
"""RMS of a residual over its noise up to which it is called noise."""
TALL = (1.85, 1.15)
"""Heights in inches of the panels of the signals and of their residuals."""
SHADE = "0.82"


def plot_signals(diagnosis: Diagnosis) -> list[Picture]:
    """Return a picture of each channel: the window in which the nominal simulation is most wrong."""
    look = choose_after_look(diagnosis)
    return [_plot_signal(_find_worst_run(traces), look) for traces in _order_channels(diagnosis)]


def plot_spectra(diagnosis: Diagnosis) -> list[Picture]:
    """Return a picture of each channel: spectra of what is left before and after, and of the noise."""
    look = choose_after_look(diagnosis)
    return [_plot_spectrum(traces, look) for traces in _order_channels(diagnosis) if len(traces[0].time) >= SHORTEST]


def _order_channels(diagnosis: Diagnosis) -> list[list[Trace]]:
    """Return the signals by channel, the channel with the largest nominal gap first."""
    return sorted(
        group_by_channel(diagnosis.evidence.traces).values(), key=lambda traces: -nominal_gap(_find_worst_run(traces))
    )


def _find_worst_run(traces: list[Trace]) -> Trace:
    """Return the run in which the nominal simulation is most wrong."""
    return max(traces, key=lambda trace: rms(compute_residual(trace).before))


def _plot_signal(trace: Trace, look: Entry) -> Picture:
    shown, left = describe_quantity(trace.channel, trace.unit), compute_residual(trace)
    window = find_window(trace.time, left.before, SECONDS)
    inside = (trace.time >= window.start) & (trace.time <= window.end)
    grid = Grid(TALL, left=0.95, right=0.25, top=0.1, bottom=0.5, gap=(0.0, 0.12))
    page = make_frame(grid, [MEASURED, NOMINAL, look])
    [upper], [lower] = page.rows
    for signal, entry in ((trace.measured, MEASURED), (trace.after, look), (trace.nominal, NOMINAL)):
        style.draw_line(upper, trace.time[inside], shown.factor * signal[inside], entry)
    _draw_noise(lower, BAND * trace.noise_rms * shown.factor)
    for signal, entry in ((left.after, look), (left.before, NOMINAL)):
        style.draw_line(lower, trace.time[inside], shown.factor * signal[inside], entry)
    _label_signal(upper, lower, window, shown)
    return Picture(_make_signal_title(trace, shown, look), _make_signal_caption(trace, window), page.figure)


def _draw_noise(axes: Axes, half: float) -> None:
    axes.axhspan(-half, half, color=SHADE, linewidth=0, zorder=0)
    axes.axhline(0.0, color="0.6", linewidth=0.8, zorder=0.5)


def _label_signal(upper: Axes, lower: Axes, window: Window, shown: Quantity) -> None:
    upper.tick_params(labelbottom=False)
    upper.set_ylabel(f"{shown.words}\n[{shown.unit}]", fontsize=FONT)
    lower.set_ylabel(f"measured less\nsimulated [{shown.unit}]", fontsize=FONT)
    lower.set_xlabel("time [s]", fontsize=FONT)
    for axes in (upper, lower):
        axes.set_xlim(*window)
        axes.yaxis.set_label_coords(-0.115, 0.5)


def _make_signal_title(trace: Trace, shown: Quantity, look: Entry) -> str:
    left = compute_residual(trace)
    before, after = (shown.factor * rms(signal) for signal in left)
    noise = f", noise {shown.factor * trace.noise_rms:.3g} {shown.unit}" if trace.noise_rms > 0 else ""
    if rms(left.before) <= EXCESS * trace.noise_rms:
        return f"{_capitalise(shown)}: nominal already within noise"
    return f"{_capitalise(shown)}: RMS residual {before:.3g} nominal, {after:.3g} {look.label}{noise}"


def _make_signal_caption(trace: Trace, window: Window) -> str:
    noise = f" Grey band: ±{BAND:g} noise." if trace.noise_rms > 0 else ""
    return f"{window} of {trace.run}, where the nominal residual has most energy.{noise} RMS over the whole run."


def _plot_spectrum(traces: list[Trace], look: Entry) -> Picture:
    first, shown = traces[0], describe_quantity(traces[0].channel, traces[0].unit)
    # The one-sided density of white noise of RMS s, sampled every dt, is 2 s^2 dt.
    noise = 2.0 * first.noise_rms**2 * float(np.median(np.diff(first.time)))
    measured = Entry("measured", GREY, width=1.0)
    legend = [measured, NOMINAL, look]
    page = make_frame(Grid((2.2,), left=0.95, right=0.25, top=0.1, bottom=0.5), legend + [NOISE] * bool(noise))
    axes = page.rows[0][0]
    left = [compute_residual(trace) for trace in traces]
    groups = ([t.measured for t in traces], [r.before for r in left], [r.after for r in left])
    lines = [estimate_spectrum(first.time, signal) for signal in groups]
    for (frequency, power), entry in zip(lines, legend, strict=True):
        centres, density, _ = average_bands(frequency, shown.factor**2 * power, LOWEST, PER_OCTAVE)
        style.draw_line(axes, centres, np.where(density > 0, density, np.nan), entry)
    if noise:
        style.draw_line(axes, [LOWEST, 1e4], [shown.factor**2 * noise] * 2, NOISE)
    _scale_spectrum(axes, lines[0][0], shown.factor**2 * noise, shown)
    noisy = max(rms(signal.before) for signal in left) <= EXCESS * first.noise_rms
    said = "nominal already within noise" if noisy else _describe_peak(lines[1][0], lines[1][1], lines[2][1], look)
    caption = f"Residuals of the simulation, nominal and {look.label}, and the measured signal. Welch's method."
    return Picture(f"{_capitalise(shown)}: {said}", caption, page.figure)


def _scale_spectrum(axes: Axes, frequency: Array, noise: float, shown: Quantity) -> None:
    axes.set_yscale("log")
    axes.set_xlim(LOWEST, frequency[-1])
    scale_frequency_axis(axes, LOWEST, float(frequency[-1]))
    axes.yaxis.set_major_locator(LogLocator(numticks=6))
    axes.yaxis.set_minor_locator(NullLocator())
    low, high = axes.get_ylim()
    axes.set_ylim(max(low, noise / 10**DECADES if noise else high / 1e9), high)
    axes.set_xlabel("frequency [Hz]", fontsize=FONT)
    unit = f"({shown.unit})²" if "/" in shown.unit or "·" in shown.unit else f"{shown.unit}²"
    axes.set_ylabel(f"power density [{unit}/Hz]", fontsize=FONT)


def _describe_peak(frequency: Array, before: Array, after: Array, look: Entry) -> str:
    """Return words on the octave in which most of the nominal residual lies, and on what is left of it there."""
    energy = np.concatenate([[0.0], np.cumsum(np.where(frequency >= LOWEST, before, 0.0))])
    first, last = (np.searchsorted(frequency, frequency * side) for side in (2**-0.5, 2**0.5))
    # Power per width of the octave, so that white noise does not favour the highest octave.
    octave = (energy[last] - energy[first]) / np.sqrt(frequency)
    centre = float(frequency[int(np.argmax(octave))])
    near = (frequency >= centre / np.sqrt(2)) & (frequency <= centre * np.sqrt(2))
    ratio = float(np.sqrt(np.sum(after[near]) / max(np.sum(before[near]), 1e-300)))
    place = f"near {format_number(centre)} Hz"
    return f"nominal residual greatest {place}; {look.label}, {100 * ratio:.0f} % of it stays there"


def _capitalise(shown: Quantity) -> str:
    return shown.words[:1].upper() + shown.words[1:]
