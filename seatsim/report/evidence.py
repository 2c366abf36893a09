"""Evidence for a diagnosis: every run over time, what is missing, comfort, the error budget, notes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from seatsim.diagnosis.result import Diagnosis, Trace
from seatsim.plots.diagnosis.bins import drop_start
from seatsim.plots.diagnosis.signals import name_last
from seatsim.plots.labels import UNKNOWN, describe_channel, format_percent
from seatsim.report.blocks import Block, Items, Text, show_pictures, tabulate
from seatsim.report.formatting import format_quantity, format_sentence
from seatsim.report.packing import MEASURED, Panel, pack_signals
from seatsim.schema.arrays import Array
from seatsim.schema.text import join_names

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def show_signals(diagnosis: Diagnosis, figures: Mapping[str, Figure]) -> list[Block]:
    """Return the held-out signals with what is left of them, then every run over time, the held-out one first."""
    groups: dict[str, list[Trace]] = {}
    for trace in map(drop_start, [*diagnosis.evidence.traces, *diagnosis.evidence.other_traces]):
        if len(trace.time) > 1:
            groups.setdefault(f"{trace.run}{' (held out)' * (trace.run in diagnosis.held_out)}", []).append(trace)
    if not groups:
        return []
    lines = [("measured", MEASURED), ("nominal", 1), (name_last(diagnosis), 0 if diagnosis.selected else 2)]
    gaps = diagnosis.gap.before.channels
    first = sorted(next(iter(groups.values())), key=lambda trace: -gaps.get(trace.channel, 0.0))
    panels = [
        Panel(each.channel, each.unit, "", {run: _read_lines(group, each.channel) for run, group in groups.items()})
        for each in first
    ]
    time = {run: group[0].time for run, group in groups.items()}
    packed = pack_signals("Every run is in the list above the pictures.", lines, time, panels)
    return [*show_pictures(figures, "signal_"), packed]


def show_discrepancy(diagnosis: Diagnosis, figures: Mapping[str, Figure]) -> list[Block]:
    """Return the signal that would close the gap, described, over time and over what may drive it."""
    found = diagnosis.evidence.discrepancy
    if found is None or len(found.values) < 2:
        return []
    lead = (
        f"The {found.quantity} that the simulation lacks in the {found.block}: with it, it would follow the recording."
        " It is estimated from the measured signals."
    )
    return [Text(lead), Items(list(map(format_sentence, found.description))), *show_pictures(figures, "discrepancy")]


def show_comfort(diagnosis: Diagnosis) -> list[Block]:
    """Return comfort and travel on the held-out run, the figures by which seats are assessed."""
    rows = [
        (each.quantity.replace("_", " "), format_quantity(each.measured, each.unit),
         format_quantity(each.nominal, each.unit), _format_error(each.nominal, each.measured),
         format_quantity(each.after, each.unit), _format_error(each.after, each.measured))
        for each in diagnosis.evidence.comfort
    ]  # fmt: skip
    return tabulate(
        "On the held-out run", f"figure, measured, nominal, error, {name_last(diagnosis)}, error of that", rows
    )


def show_budget(diagnosis: Diagnosis) -> list[Block]:
    """Return what the error of the stated scenario is made of on the held-out run, by channel."""
    lead = (
        "The error E is the RMS of measured less simulated, of the scenario with the effects found. Its parts are those"
        " of ASME V&V 20: what halving the step of the integration changes (u_num), what the noise of the recorded"
        " inputs makes (u_input), and the noise of the sensor itself (u_D). What these leave is the error of the"
        " form of the model."
    )
    rows = []
    for channel, unit, *parts in diagnosis.error_budget:
        shown = describe_channel(channel, unit)
        rows.append([shown.words, shown.unit, *(shown.factor * part for part in parts)])
    head = "channel, unit, error E, step u_num, inputs u_input, sensor u_D, model form"
    return [Text(lead), *tabulate("Parts of the error", head, rows, 2)] if rows else []


def list_notes(diagnosis: Diagnosis) -> list[str]:
    """Return notes on the data, and the groups of blocks that the recorded channels can tell apart."""
    sentences = list(diagnosis.notes)
    if diagnosis.held_out:
        sentences.append(f"Held out, no part of any fit: {join_names(diagnosis.held_out)}.")
    groups = [join_names(group, "or") for group in diagnosis.isolable if group]
    if groups:
        sentences.append(f"These channels can distinguish these groups of blocks: {'; '.join(groups)}.")
    return sentences


def _read_lines(group: Sequence[Trace], channel: str) -> list[Array | None]:
    trace = next((each for each in group if each.channel == channel), None)
    return [None, None, None] if trace is None else [trace.measured, trace.nominal, trace.after]


def _format_error(value: float, truth: float) -> str:
    if not math.isfinite(value) or not math.isfinite(truth) or truth == 0:
        return UNKNOWN
    error = value / truth - 1
    return f"{'+' if error >= 0 else ''}{format_percent(error)}"
