"""Sections of a diagnosis: causes of the gap, its way to the noise floor, signals, what is missing, what is left.

Here stand also the words in which a cause and its parameters are told.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from seatsim.diagnosis.residuals import drop_start
from seatsim.diagnosis.result import CalibratedParameter, Cause, Diagnosis, Estimate, Gaps, RunGaps
from seatsim.plots.diagnosis.answer import STAGES, Key, find_last, read_gap, select_stages
from seatsim.report.blocks import Block, Figures, Items, Table, Text, show_pictures, tabulate
from seatsim.report.formatting import (
    describe_effect,
    explain,
    format_noise,
    format_quantity,
    format_sentence,
    format_setting,
    read_words,
    say_noise,
    scale_row,
    show_table,
)
from seatsim.report.packing import MEASURED, pack_traces
from seatsim.schema.printing import MINUS, UNKNOWN, describe_channel, format_number, format_percent, format_unit
from seatsim.schema.text import join_names

LIKELY = 0.05
"""Probability from which on the parameters of a cause are printed."""
_ALIKE, _MOST_PAIRS = 0.5, 12
"""Collinearity from which on two effects are named as similar, and the most pairs that are."""
EXPLAINED = "Refitted is the nominal scenario with its parameters moved inside their tolerance."


def format_estimate(value: Estimate | str) -> str:
    """Return a parameter with its standard deviation, rounded to two digits of that, its unit, and whether it ends."""
    if isinstance(value, str):
        return value
    if value.at_bound:
        return f"{format_estimate(value._replace(at_bound=False))} (the end of its range)"
    shown = describe_channel("", value.unit)
    unit = "" if shown.unit == "-" else f" {shown.unit}"
    value = value._replace(value=shown.factor * value.value, std=shown.factor * value.std)
    if not math.isfinite(value.std) or value.std <= 0:
        return f"{format_number(value.value, 4)}{unit}"
    decimals = max(0, 1 - math.floor(math.log10(value.std)))
    # With more than seven decimals, leading zeros would hide the significant digits.
    if decimals > 7:
        return f"{format_number(value.value, 4)} ± {format_number(value.std, 2)}{unit}"
    return f"{value.value:.{decimals}f} ± {value.std:.{decimals}f}{unit}".replace("-", MINUS)


def say_cause(cause: Cause) -> str:
    """Return what is the matter in a clause; of an effect of the reader's own, its documentation."""
    words = read_words().effects.get(cause.effect)
    if words is None:
        return f"{cause.effect} is at work ({describe_effect(cause.effect) or 'an effect of your own'})"
    return words.clause.format(_say_size(cause.parameters, words.parameter), **_say_rest(cause.parameters))


def say_action(effect: str) -> str:
    """Return what to do about an effect."""
    words = read_words().effects.get(effect)
    return words.action if words else format_sentence(f"look at what {effect} describes on the rig")


def show_causes(diagnosis: Diagnosis, figures: Figures) -> list[Block]:
    """Return where the gap lies, which effects may cause it, and their parameters."""
    shown = [each for each in diagnosis.causes if each.probability >= LIKELY or each.effect in diagnosis.selected]
    rows = []
    for cause in shown:
        meaning = format_sentence(describe_effect(cause.effect)) or UNKNOWN
        shares = (format_percent(cause.probability), format_percent(cause.shrink))
        sizes = "; ".join(f"{name} {format_estimate(value)}" for name, value in cause.parameters.items()) or UNKNOWN
        rows.append((cause.effect, meaning, sizes, *shares))
    strong = [row for row, cause in enumerate(shown) if cause.effect in diagnosis.selected]
    return [*show_pictures(figures, "location", "ranking"), *show_table("causes", rows, 3, strong)]


def show_confusions(diagnosis: Diagnosis) -> list[Block]:
    """Return which effects this recording cannot tell apart, and what would decide."""
    blocks: list[Block] = [
        Text(f"This recording cannot distinguish {join_names(group)}: each explains the gap equally well.")
        for group in diagnosis.indistinguishable
        if len(group) > 1
    ]
    found = diagnosis.experiment
    if found is not None:
        row = (found.name.replace("_", " "), found.kind, found.likeness_now, found.likeness_then)
        blocks += [*show_table("experiment", [row], 2), Text(format_sentence(found.reason))]
    names, matrix = diagnosis.evidence.collinearity
    known = ((float(matrix[i][j]), names[i], names[j]) for i in range(len(names)) for j in range(i))
    pairs = sorted(known, reverse=True)
    rows = [(one, other, format_number(value, 2)) for value, one, other in pairs[:_MOST_PAIRS] if value >= _ALIKE]
    return [*blocks, *show_table("alike", rows, 2)]


def show_forms(diagnosis: Diagnosis) -> list[Table]:
    """Return the table of other forms of the damper, where they were tried."""
    forms = diagnosis.alternatives
    rows = [
        (form.model, join_names(form.beside or ["no effect"]), *map(format_percent, (form.shrink, form.refitted)))
        for form in forms
    ]
    return show_table("forms", rows, 2, [0], own=forms[0].replaces) if forms else []


def show_gaps(diagnosis: Diagnosis, figures: Figures) -> list[Block]:
    """Return picture and tables of the gaps by channel and by run, and of the refitted parameters."""
    gap, keys = diagnosis.gap, select_stages(diagnosis)
    held = ", ".join(diagnosis.held_out) or "all runs"
    rows = [_make_row(gap, name, name.replace("_", " "), keys) for name in ("overall", *gap.before.channels)]
    head = ["channel", *(STAGES[key].label for key in keys), "shrinks by"]
    blocks = [Text(f"{_describe_shrink(diagnosis)} {EXPLAINED}"), *show_pictures(figures, "gaps")]
    blocks += tabulate(f"Gaps on {held}", head, rows, 1, [0])
    if len(gap.by_run) > 1:
        rows = [_make_row(each, "overall", each.run, keys) for each in gap.by_run]
        strong = [k for k, each in enumerate(gap.by_run) if each.run in diagnosis.held_out]
        blocks += tabulate("Gaps of every run, overall; held out in bold", ["run", *head[1:]], rows, 1, strong)
    return [*blocks, *_tabulate_parameters(diagnosis.parameters)]


def _make_row(gaps: Gaps | RunGaps, channel: str, name: str, keys: Sequence[Key]) -> list[str]:
    sizes = {key: read_gap(gaps, key, channel) for key in (*keys, "before", "after")}
    before, after = sizes["before"], sizes["after"]
    change = 1 - after / before if after is not None and before else None
    if channel == "overall" and math.isfinite(gaps.shrink):
        change = gaps.shrink
    shown = [format_noise(sizes[key]) if key == "floor" else format_percent(sizes[key]) for key in keys]
    return [name, *shown, format_percent(change)]


def _describe_shrink(diagnosis: Diagnosis) -> str:
    gap = diagnosis.gap
    if not diagnosis.selected or not math.isfinite(gap.shrink):
        before, after = format_percent(gap.before.overall), format_percent(gap.calibrated.overall)
        return f"Refitting alone takes the gap from {before} to {after}; {say_noise(gap.floor.overall)}."
    low, high = gap.shrink_interval
    known = math.isfinite(low + high)
    between = f" (90 % interval on other runs of the kind: {format_percent(low)} to {format_percent(high)})" * known
    effects = "effect" if len(diagnosis.selected) == 1 else "effects"
    return f"The gap shrinks by {format_percent(gap.shrink)}{between} with the {effects} found."


def _tabulate_parameters(parameters: Sequence[CalibratedParameter]) -> list[Table]:
    ranked = sorted(parameters, key=lambda each: not each.at_bound)
    rows = []
    for each in ranked:
        nominal, low, high = map(format_setting, (each.nominal, *each.bound))
        name = f"{each.name} (at its bound)" if each.at_bound else each.name
        rows.append((name, format_unit(each.unit), nominal, format_number(each.value, 4), f"{low} to {high}"))
    strong = [k for k, each in enumerate(ranked) if each.at_bound]
    return show_table("refit", rows, 2, strong)


def show_signals(diagnosis: Diagnosis, figures: Figures) -> list[Block]:
    """Return the held-out signals with what is left of them, then every run over time, the held-out one first."""
    gaps, evidence = diagnosis.gap.before.channels, diagnosis.evidence
    known = [trace for trace in map(drop_start, [*evidence.traces, *evidence.other_traces]) if len(trace.time) > 1]
    if not known:
        return []
    named = [replace(each, run=f"{each.run}{' (held out)' * (each.run in diagnosis.held_out)}") for each in known]
    lines = {
        "measured": ("measured", MEASURED),
        "nominal": ("nominal", 1),
        "after": (find_last(diagnosis).label, 0 if diagnosis.selected else 2),
    }
    ordered = sorted(named, key=lambda trace: -gaps.get(trace.channel, 0.0))
    runs = list(dict.fromkeys(trace.run for trace in named))
    packed = pack_traces(sorted(ordered, key=lambda trace: runs.index(trace.run)), lines)
    return [*show_pictures(figures, "signal_"), packed]


def show_discrepancy(diagnosis: Diagnosis, figures: Figures) -> list[Block]:
    """Return the signal that would close the gap, described, over time and over what may drive it."""
    found = diagnosis.evidence.discrepancy
    if found is None or len(found.values) < 2:
        return []
    lead = (
        f"The {found.quantity} that the simulation lacks in the {found.block}: with it, it would follow the recording."
        " It is estimated from the measured signals."
    )
    return [Text(lead), Items(list(map(format_sentence, found.description))), *show_pictures(figures, "discrepancy")]


def show_comfort(diagnosis: Diagnosis) -> list[Table]:
    """Return comfort and travel on the held-out run, the figures by which seats are assessed."""
    rows = []
    for each in diagnosis.evidence.comfort:
        measured, nominal, after = (format_quantity(x, each.unit) for x in (each.measured, each.nominal, each.after))
        errors = [_format_error(value, each.measured) for value in (each.nominal, each.after)]
        rows.append((each.quantity.replace("_", " "), measured, nominal, errors[0], after, errors[1]))
    return show_table("comfort", rows, last=find_last(diagnosis).label)


def show_budget(diagnosis: Diagnosis) -> list[Block]:
    """Return what the error of the stated scenario is made of on the held-out run, by channel."""
    rows = [scale_row(channel, unit, parts) for channel, unit, *parts in diagnosis.error_budget]
    return [*explain("budget"), *show_table("budget", rows, 2)] if rows else []


def list_notes(diagnosis: Diagnosis) -> list[str]:
    """Return notes on the data, and the groups of blocks that the recorded channels can tell apart."""
    sentences = list(diagnosis.notes)
    if diagnosis.held_out:
        sentences.append(f"Held out, no part of any fit: {join_names(diagnosis.held_out)}.")
    groups = [join_names(group, "or") for group in diagnosis.isolable if group]
    if groups:
        sentences.append(f"These channels can distinguish these groups of blocks: {'; '.join(groups)}.")
    return sentences


def _format_error(value: float, truth: float) -> str:
    if not math.isfinite(value) or not math.isfinite(truth) or truth == 0:
        return UNKNOWN
    error = value / truth - 1
    return f"{'+' if error >= 0 else ''}{format_percent(error)}"


def _say_size(parameters: Mapping[str, Estimate | str], name: str) -> str:
    found = parameters.get(name)
    if not isinstance(found, Estimate):
        return "some amount"
    if found.unit == "s":
        return f"{format_quantity(abs(1e3 * found.value), '-')} ms"
    return format_quantity(abs(found.value), found.unit)


def _say_rest(parameters: Mapping[str, Estimate | str]) -> dict[str, str]:
    channel, shift = parameters.get("channel"), parameters.get("shift")
    ahead = isinstance(shift, Estimate) and shift.value < 0
    name = channel.replace("_", " ") if isinstance(channel, str) else "of one sensor"
    return {"channel": name, "side": "early" if ahead else "late"}
