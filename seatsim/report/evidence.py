"""Evidence for a diagnosis: signals, spectra, maps, the missing signal, comfort, the error budget, notes."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from seatsim.diagnosis.result import Diagnosis, Trace
from seatsim.metrics.motion import rms
from seatsim.plots.diagnosis.bins import (
    bin_edges,
    compute_residual,
    drop_start,
    find_window,
    find_worst,
    map_rms,
    varies,
)
from seatsim.report.blocks import Block, Items, Table, Text
from seatsim.report.formatting import (
    UNKNOWN,
    describe_channel,
    format_number,
    format_percent,
    format_quantity,
    format_sentence,
)
from seatsim.report.packing import Axis, Panel, make_density, pack_signals
from seatsim.report.planes import Curve, Range, draw_cells, draw_curves, join_planes
from seatsim.report.spectra import estimate_spectrum
from seatsim.schema.arrays import Array
from seatsim.schema.text import join_names

CLOSE_UP = 2.0
"""Seconds of the closer look at the held-out run, with every sample."""
BINS = (22, 13)
"""Bins of a map over velocity and over the other quantity."""
DOTS = 2500
OVER = {
    "velocity": ("suspension velocity [m/s]", 1.0), "displacement": ("travel [mm]", 1e3),
    "coil_current": ("coil current [A]", 1.0), "damper_temperature": ("damper temperature [°C]", 1.0),
}  # fmt: skip
"""Labels of the axes of measured motion, and factors to their units."""


def show_signals(diagnosis: Diagnosis) -> list[Block]:
    """Return every run over time, the held-out one first, then that one closely where the nominal is most wrong."""
    traces = _by_run([*diagnosis.evidence.traces, *diagnosis.evidence.other_traces])
    if not traces:
        return []
    lines = [("measured", 0), ("nominal", 1), (_name_last(diagnosis), 2)]
    channels = _order_channels(diagnosis, next(iter(traces.values())))
    units = {trace.channel: trace.unit for group in traces.values() for trace in group}
    axes = {_mark(run, diagnosis): group[0].time for run, group in traces.items()}
    panels = [
        Panel(name, units[name], _describe_residual(traces, name, diagnosis),
              {_mark(run, diagnosis): _lines_of(group, name) for run, group in traces.items()})
        for name in channels
    ]  # fmt: skip
    caption = "Every run is in the list above the pictures."
    whole = pack_signals("signals-time", caption, lines, Axis("time", "s", axes), panels)
    return [whole, *_show_close_up(next(iter(traces.values())), channels, lines)]


def _show_close_up(group: Sequence[Trace], channels: Sequence[str], lines: Sequence[tuple[str, int]]) -> list[Block]:
    first = next(trace for trace in group if trace.channel == channels[0])
    window = find_window(first.time, compute_residual(first).before, CLOSE_UP)
    inside = (first.time >= window.start) & (first.time <= window.end)
    panels = [
        Panel(name, trace.unit, "", {"": [signal[inside] for signal in (trace.measured, trace.nominal, trace.after)]})
        for name in channels for trace in group if trace.channel == name and len(trace.time) == len(first.time)
    ]  # fmt: skip
    lead = f"{window} of {first.run}, where the nominal {channels[0].replace('_', ' ')} is most wrong:"
    axis = Axis("time", "s", {"": first.time[inside]})
    return [Text(lead), pack_signals("signals-closely", "Every sample is drawn.", lines, axis, panels)]


def show_spectra(diagnosis: Diagnosis) -> list[Block]:
    """Return the spectra of what is left on the held-out run, nominal and in the end, beside the measured signal."""
    traces = _by_run(diagnosis.evidence.traces)
    group = next(iter(traces.values()), [])
    found = []
    frequency: Array = np.empty(0)
    for name in _order_channels(diagnosis, group):
        trace = next(each for each in group if each.channel == name)
        left = compute_residual(trace)
        spectra = [estimate_spectrum(trace.time, signal) for signal in (trace.measured, left.before, left.after)]
        known = [each for each in spectra if each is not None]
        if len(known) == 3:
            frequency = known[0][0]
            # The one-sided density of white noise of RMS s, sampled every dt, is 2 s^2 dt.
            noise = np.full(len(frequency), 2.0 * trace.noise_rms**2 * float(trace.time[1] - trace.time[0]))
            values = [*(power for _, power in known), noise if trace.noise_rms > 0 else None]
            found.append(make_density(name, trace.unit, {"": values}))
    if not found:
        return []
    after = f"difference, {_name_last(diagnosis)}"
    lines = [("measured", 0), ("difference, nominal", 1), (after, 2), ("sensor noise", 3)]
    axis = Axis("frequency", "Hz", {"": frequency}, logarithmic=True)
    caption = f"Run {group[0].run}; the difference is measured less simulated."
    return [pack_signals("signals-frequency", caption, lines, axis, found, logarithmic=True)]


def show_maps(diagnosis: Diagnosis) -> list[Block]:
    """Return maps of what is left of the worst channel over velocity and current (or travel), before and after."""
    found = find_worst(diagnosis)
    if found is None:
        return []
    trace, motion = found
    other = next((name for name in ("coil_current", "displacement") if varies(motion.get(name))), "")
    if not other or not varies(motion.get("velocity")):
        return []
    x, y = (OVER[name][1] * motion[name] for name in ("velocity", other))
    borders = bin_edges(x, BINS[0]), bin_edges(y, BINS[1])
    shown, left = describe_channel(trace.channel, trace.unit), compute_residual(trace)
    cells = [shown.factor * map_rms(x, y, signal, borders) for signal in left]
    known = np.concatenate([each[np.isfinite(each)] for each in cells])
    if not known.size or not known.max() > 0:
        return []
    noise = shown.factor * trace.noise_rms
    ends = Range(max(noise, float(known.max()) / 100), float(known.max()) * 1.0001)
    axes = (OVER["velocity"][0], OVER[other][0])
    caption = f"RMS of measured less simulated on {trace.run}; cells of too few samples stay empty."
    planes = [
        draw_cells(title, axes, borders, values, ends, shown.unit)
        for title, values in zip(("nominal", _name_last(diagnosis)), cells, strict=True)
    ]
    return [join_planes(f"Error of the {shown.words} over velocity and {other.replace('_', ' ')}", caption, planes)]


def show_discrepancy(diagnosis: Diagnosis) -> list[Block]:
    """Return the signal that would close the gap, described, over time and over what may drive it."""
    found = diagnosis.evidence.discrepancy
    if found is None or len(found.values) < 2:
        return []
    blocks: list[Block] = [
        Text(
            f"The {found.quantity} that the simulation lacks in the {found.block}: with it, it would follow the"
            " recording. It is estimated from the measured signals."
        ),
        Items([format_sentence(text) for text in found.description]),
    ]
    panel = Panel(f"missing {found.quantity}", found.unit, "", {"": [found.values]})
    blocks.append(
        pack_signals(
            "signals-missing", "On the held-out run.", [("missing", 6)], Axis("time", "s", {"": found.time}), [panel]
        )
    )
    shown = describe_channel(found.quantity, found.unit)
    every = -(-len(found.values) // DOTS)
    planes = []
    for name, values in diagnosis.evidence.motion.items():
        if len(values) == len(found.values) and varies(values):
            label, factor = OVER.get(name, (name.replace("_", " "), 1.0))
            curve = Curve("", factor * values[::every], shown.factor * found.values[::every], 6, "dots")
            title = f"over {label.partition(' [')[0]}"
            planes.append(draw_curves(title, "", (label, f"missing {shown.axis}"), [curve]))
    if planes:
        blocks.append(join_planes(f"Missing {shown.words}", "Samples of the held-out run.", planes))
    return blocks


def show_comfort(diagnosis: Diagnosis) -> list[Block]:
    """Return comfort and travel on the held-out run, the figures by which seats are assessed."""
    if not diagnosis.evidence.comfort:
        return []
    last = _name_last(diagnosis)
    rows = [
        [each.quantity.replace("_", " "), format_quantity(each.measured, each.unit),
         format_quantity(each.nominal, each.unit), _format_error(each.nominal, each.measured),
         format_quantity(each.after, each.unit), _format_error(each.after, each.measured)]
        for each in diagnosis.evidence.comfort
    ]  # fmt: skip
    return [Table("On the held-out run", ["figure", "measured", "nominal", "error", last, "error of that"], rows)]


def show_budget(diagnosis: Diagnosis) -> list[Block]:
    """Return what the error of the stated scenario is made of on the held-out run, by channel."""
    if not diagnosis.error_budget:
        return []
    lead = (
        "The error E is the RMS of measured less simulated, of the scenario with the effects found. Its parts are those"
        " of ASME V&V 20: what halving the step of the integration changes (u_num), what the noise of the recorded"
        " inputs makes (u_input), and the noise of the sensor itself (u_D). What these leave is the error of the"
        " form of the model."
    )
    rows = []
    for channel, unit, *parts in diagnosis.error_budget:
        shown = describe_channel(channel, unit)
        rows.append([shown.words, shown.unit, *(format_number(shown.factor * part) for part in parts)])
    head = ["channel", "unit", "error E", "step u_num", "inputs u_input", "sensor u_D", "model form"]
    return [Text(lead), Table("Parts of the error", head, rows, 2)]


def show_notes(diagnosis: Diagnosis) -> list[Block]:
    """Return notes on the data, and the groups of blocks that the recorded channels can tell apart."""
    sentences = [format_sentence(note) for note in diagnosis.notes]
    if diagnosis.held_out:
        sentences.append(f"Held out, no part of any fit: {join_names(diagnosis.held_out)}.")
    groups = [join_names(group, "or") for group in diagnosis.isolable if group]
    if groups:
        sentences.append(f"These channels can distinguish these groups of blocks: {'; '.join(groups)}.")
    return [Items(sentences)] if sentences else []


def _by_run(traces: Sequence[Trace]) -> dict[str, list[Trace]]:
    """Return signals by run, without the first second that no gap counts."""
    found: dict[str, list[Trace]] = {}
    for trace in traces:
        rest = drop_start(trace)
        if len(rest.time) > 1:
            found.setdefault(trace.run, []).append(rest)
    return found


def _order_channels(diagnosis: Diagnosis, group: Sequence[Trace]) -> list[str]:
    """Return the channels, the largest nominal gap first."""
    gaps = diagnosis.gap.before.channels
    return sorted((trace.channel for trace in group), key=lambda name: -gaps.get(name, 0.0))


def _lines_of(group: Sequence[Trace], channel: str) -> list[Array | None]:
    trace = next((each for each in group if each.channel == channel), None)
    return [None, None, None] if trace is None else [trace.measured, trace.nominal, trace.after]


def _describe_residual(traces: dict[str, list[Trace]], channel: str, diagnosis: Diagnosis) -> str:
    trace = next(each for group in traces.values() for each in group if each.channel == channel)
    before, after = (format_quantity(rms(signal), trace.unit) for signal in compute_residual(trace))
    noise = f", noise {format_quantity(trace.noise_rms, trace.unit)}" if trace.noise_rms > 0 else ""
    return f"RMS of the difference on {trace.run}: {before} nominal, {after} {_name_last(diagnosis)}{noise}."


def _mark(run: str, diagnosis: Diagnosis) -> str:
    return f"{run} (held out)" if run in diagnosis.held_out else run


def _name_last(diagnosis: Diagnosis) -> str:
    return "with effects" if len(diagnosis.selected) > 1 else "with effect" if diagnosis.selected else "refitted"


def _format_error(value: float, truth: float) -> str:
    if not math.isfinite(value) or not math.isfinite(truth) or truth == 0:
        return UNKNOWN
    error = value / truth - 1
    return f"{'+' if error >= 0 else ''}{format_percent(error)}"
