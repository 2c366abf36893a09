"""The report of a diagnosis: what is the matter, what to do, how far the gap shrinks, and the evidence.

Here stand also the words in which a cause and its parameters are told.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from seatsim.diagnosis.answer import share_taken
from seatsim.diagnosis.residuals import drop_start
from seatsim.diagnosis.result import Cause, Diagnosis, Estimate, Gaps, RunGaps
from seatsim.plots.diagnosis import find_last, plot_diagnosis
from seatsim.recordings.gap import GapFigures
from seatsim.report import formatting
from seatsim.report.blocks import Block, Figures, Items, Report, Table, Text, show_pictures, tabulate
from seatsim.report.composing import compose
from seatsim.report.formatting import choose_advice, format_quantity, format_sentence, read_words, show_table
from seatsim.report.packing import MEASURED, NOMINAL, pack_traces
from seatsim.schema.printing import MINUS, UNKNOWN, describe_channel, format_number, format_percent, format_unit
from seatsim.schema.text import join_names

_STAGES = {"before": "nominal", "calibrated": "refitted", "after": "with effects", "floor": "noise floor"}
"""How each gap of a diagnosis is called."""
_NEARLY_ALL = 0.98
_LIKELY = 0.05
"""Probability from which on the parameters of a cause are printed."""
_ALIKE, _MOST_PAIRS = 0.5, 12
"""Collinearity from which on two effects are named as similar, and the most pairs that are."""
EXPLAINED = "Refitted is the nominal scenario with its parameters moved inside their tolerance."


def report_diagnosis(diagnosis: Diagnosis) -> Report:
    """Return the report of a diagnosis; without a gap it has no evidence for causes."""
    figures = plot_diagnosis(diagnosis)
    # What the error of the stated scenario is made of on the held-out run, by channel.
    errors = [formatting.scale_row(channel, unit, parts) for channel, unit, *parts in diagnosis.error_budget]
    sections: dict[str, Sequence[Block]] = {
        "causes": _show_causes(diagnosis),
        "gaps": _show_gaps(diagnosis, figures),
        "signals": show_signals(diagnosis, figures),
        "missing": show_discrepancy(diagnosis, figures),
        "forms": _show_forms(diagnosis),
        "confusions": _show_confusions(diagnosis),
        "maps": show_pictures(figures, "maps"),
        "budget": [*formatting.explain("budget"), *show_table("budget", errors, 2)] if errors else [],
        "comfort": _show_comfort(diagnosis),
    }
    if diagnosis.verdict == "none":
        sections |= {anchor: [] for anchor in ("causes", "missing", "confusions", "maps")}
    about, command = f"Diagnosis: {diagnosis.name}", f"seatsim diagnose {diagnosis.name}"
    answer = [_say_diagnosis(diagnosis), format_sentence(diagnosis.sentence)]
    report = compose("diagnosis", about, answer, _advise(diagnosis), sections, _list_notes(diagnosis), command)
    badge = (diagnosis.verdict, *read_words().verdicts[diagnosis.verdict])
    return report._replace(badge=badge)


def _say_diagnosis(diagnosis: Diagnosis) -> str:
    """Return the answer as an engineer says it: what is the matter, and how much of the gap that explains."""
    gap = diagnosis.gap
    size, noise = format_percent(gap.before.overall), formatting.say_noise(gap.floor.overall)
    if diagnosis.verdict == "none":
        return (
            f"The simulation fits the recording: it is off by {size} of the signals' spread; {noise}, and the tolerance"
            " of the parameters allows the rest."
        )
    causes = _select(diagnosis)
    if not causes:
        where = f", in the {diagnosis.where[0].block}" if diagnosis.where else ""
        return f"Something that no known effect explains makes the gap of {size}{where}; {noise}."
    clauses = join_names([say_cause(cause) for cause in causes])
    if diagnosis.verdict == "ambiguous":
        others = [name for group in diagnosis.indistinguishable for name in group if name not in diagnosis.selected]
        if others:
            clauses = f"either {clauses}, or it is {join_names(others, 'or')}, which look the same here"
    return f"{clauses[0].upper()}{clauses[1:]}. {_say_share(diagnosis)}"


def _advise(diagnosis: Diagnosis) -> list[str]:
    """Return what to do next: look at the rig, decide between equals, use the scenario."""
    if diagnosis.verdict == "none":
        return choose_advice(use_nominal=True)
    found, experiment = [say_action(name) for name in diagnosis.selected], diagnosis.experiment
    if experiment is not None:
        file = "; its scenario is experiment.yaml beside this report" if experiment.scenario is not None else ""
        what = f"to tell the likely causes apart: {experiment.name.replace('_', ' ')}{file}. {experiment.reason}"
        found.append(format_sentence(what))
    is_unknown = diagnosis.verdict == "unknown"
    return found + choose_advice(
        read_missing=is_unknown,
        begin_with_block=is_unknown and [share.block for share in diagnosis.where[:1]],
        measure=[each.name for each in diagnosis.parameters if each.at_bound],
        confirm=[cause.effect for cause in _select(diagnosis) if cause.at_bound],
        check=f"the refitted parameters{' and the effects found' * bool(diagnosis.selected)}",
    )


def _select(diagnosis: Diagnosis) -> list[Cause]:
    by_name = {cause.effect: cause for cause in diagnosis.causes}
    return [by_name.get(name, Cause(name, 1.0, 0.0, {})) for name in diagnosis.selected]


def _say_share(diagnosis: Diagnosis) -> str:
    """Return how much of the gap that can be removed is gone, on the run held out."""
    gap, share = diagnosis.gap, share_taken(diagnosis.gap)
    if not share > 0.0:
        return "That takes nothing off the gap of the run held out."
    subject = "That explains" if len(diagnosis.selected) == 1 else "Together that explains"
    if diagnosis.verdict == "unknown":
        return f"{subject} {format_percent(share)} of the gap; no known effect explains the rest."
    left = f"; what is left is {format_percent(gap.after.overall)} of the signals' spread"
    rest = "" if share > _NEARLY_ALL else left
    return f"{subject} {format_percent(share)} of the gap beyond noise{rest}."


def _format_estimate(value: Estimate | str) -> str:
    """Return a parameter with its standard deviation, rounded to two digits of that, its unit, and whether it ends."""
    if isinstance(value, str):
        return value
    if value.at_bound:
        return f"{_format_estimate(value._replace(at_bound=False))} (the end of its range)"
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
        return f"{cause.effect} is at work ({formatting.describe_effect(cause.effect) or 'an effect of your own'})"
    channel, shift = cause.parameters.get("channel"), cause.parameters.get("shift")
    side = "early" if isinstance(shift, Estimate) and shift.value < 0 else "late"
    name = channel.replace("_", " ") if isinstance(channel, str) else "of one sensor"
    return words.clause.format(_say_size(cause.parameters, words.parameter), channel=name, side=side)


def say_action(effect: str) -> str:
    """Return what to do about an effect."""
    words = read_words().effects.get(effect)
    return words.action if words else format_sentence(f"look at what {effect} describes on the rig")


def _show_causes(diagnosis: Diagnosis) -> list[Table]:
    """Return where the gap lies, which effects may cause it, and their parameters."""
    shown = [each for each in diagnosis.causes if each.probability >= _LIKELY or each.effect in diagnosis.selected]
    rows = []
    for cause in shown:
        meaning = format_sentence(formatting.describe_effect(cause.effect)) or UNKNOWN
        shares = (format_percent(cause.probability), format_percent(cause.shrink))
        sizes = "; ".join(f"{name} {_format_estimate(value)}" for name, value in cause.parameters.items()) or UNKNOWN
        name = cause.effect + " (own)" * (cause.effect not in read_words().effects)
        rows.append((name, meaning, sizes, *shares))
    if rest := [each.probability for each in diagnosis.causes if each not in shown]:
        most = f"≤ {format_percent(max(rest))}".replace("≤ <", "<")
        rows.append((f"{len(rest)} other effect{'s' * (len(rest) > 1)}", UNKNOWN, UNKNOWN, most, UNKNOWN))
    ends = {"no effect at all": diagnosis.probability_none, "another cause": diagnosis.probability_unknown}
    rows += [(name, UNKNOWN, UNKNOWN, format_percent(value), UNKNOWN) for name, value in ends.items()]
    strong = [row for row, cause in enumerate(shown) if cause.effect in diagnosis.selected]
    return [*_tabulate_blocks(diagnosis), *show_table("causes", rows, 3, strong)]


def _tabulate_blocks(diagnosis: Diagnosis) -> list[Table]:
    """Return the table of the shares of the gap that lie in the blocks; its caption names those that are alike."""
    if not (shares := [(share.block, format_percent(share.share)) for share in diagnosis.where]):
        return []
    groups = [group for group in diagnosis.indistinguishable if set(group) & set(diagnosis.selected)]
    alike = {name.partition(".")[0] for group in groups for name in group}
    first = [name for name, _ in shares[:1]]
    lies = join_names([name for name, _ in shares if name in alike] if alike.intersection(first) else first, "or")
    what = "What stays unexplained" if diagnosis.verdict == "unknown" else "The gap"
    return show_table("blocks", shares, 1, [0], what=what, where=lies)


def _show_confusions(diagnosis: Diagnosis) -> list[Block]:
    """Return which effects this recording cannot tell apart, and what would decide."""
    groups = [join_names(group) for group in diagnosis.indistinguishable if len(group) > 1]
    said = "This recording cannot distinguish {}: each explains the gap equally well."
    blocks: list[Block] = [Text(said.format(group)) for group in groups]
    if (found := diagnosis.experiment) is not None:
        row = (found.name.replace("_", " "), found.kind, found.likeness_now, found.likeness_then)
        blocks += [*show_table("experiment", [row], 2), Text(format_sentence(found.reason))]
    names, matrix = diagnosis.evidence.collinearity
    known = ((float(matrix[i][j]), names[i], names[j]) for i in range(len(names)) for j in range(i))
    pairs = sorted(known, reverse=True)
    rows = [(one, other, format_number(value, 2)) for value, one, other in pairs[:_MOST_PAIRS] if value >= _ALIKE]
    return [*blocks, *show_table("alike", rows, 2)]


def _show_forms(diagnosis: Diagnosis) -> list[Table]:
    """Return the table of other forms of the damper, where they were tried."""
    rows = [
        (form.model, join_names(form.beside or ["no effect"]), *map(format_percent, (form.shrink, form.refitted)))
        for form in diagnosis.alternatives
    ]
    return show_table("forms", rows, 2, [0], own=diagnosis.alternatives[0].replaces) if rows else []


def tabulate_diagnosis(diagnosis: Diagnosis) -> list[Table]:
    """Return what a terminal shows of a diagnosis: gaps, likely causes, and other forms of the damper."""
    causes = _show_causes(diagnosis) if diagnosis.verdict != "none" else []
    return [*_tabulate_gaps(diagnosis), *causes, *_show_forms(diagnosis)]


def _tabulate_gaps(diagnosis: Diagnosis) -> list[Table]:
    """Return the gaps by channel on the runs held out, then, where there are several, those of every run."""
    gap, held = diagnosis.gap, ", ".join(diagnosis.held_out) or "all runs"
    # Without effects the gap after them is that of the refit.
    stages = {key: name for key, name in _STAGES.items() if key != "after" or diagnosis.selected}
    rows = [_make_row(gap, name, name.replace("_", " "), stages) for name in ("overall", *gap.before.channels)]
    head = ["channel", *stages.values(), "shrinks by"]
    tables = tabulate(f"Gaps on {held}", head, rows, 1, [0])
    if len(gap.by_run) > 1:
        rows = [_make_row(each, "overall", each.run, stages) for each in gap.by_run]
        strong = [k for k, each in enumerate(gap.by_run) if each.run in diagnosis.held_out]
        tables += tabulate("Gaps of every run, overall; held out in bold", ["run", *head[1:]], rows, 1, strong)
    return tables


def _show_gaps(diagnosis: Diagnosis, figures: Figures) -> list[Block]:
    """Return the gaps, drawn and as tables, and the refitted parameters."""
    lead, rows = Text(f"{_describe_shrink(diagnosis)} {EXPLAINED}".strip()), []
    ranked = sorted(diagnosis.parameters, key=lambda each: not each.at_bound)
    for each in ranked:
        nominal, low, high = map(formatting.format_setting, (each.nominal, *each.bound))
        name = f"{each.name}{' (at its bound)' * each.at_bound}"
        rows.append([name, format_unit(each.unit), nominal, format_number(each.value, 4), f"{low} to {high}"])
    refit = show_table("refit", rows, 2, [k for k, each in enumerate(ranked) if each.at_bound])
    return [lead, *show_pictures(figures, "gaps"), *_tabulate_gaps(diagnosis), *refit]


def _make_row(gaps: Gaps | RunGaps, channel: str, name: str, keys: Iterable[str]) -> list[str]:
    """Return the gaps of a channel, or of all ("overall"), over the signal's standard deviation."""
    figures: dict[str, GapFigures] = {key: getattr(gaps, key) for key in _STAGES}
    sizes = {key: {**each.channels, "overall": each.overall}.get(channel) for key, each in figures.items()}
    before, after = sizes["before"], sizes["after"]
    change = 1 - after / before if after is not None and before else None
    if channel == "overall" and math.isfinite(gaps.shrink):
        change = gaps.shrink
    shown = [formatting.format_noise(sizes[key]) if key == "floor" else format_percent(sizes[key]) for key in keys]
    return [name, *shown, format_percent(change)]


def _describe_shrink(diagnosis: Diagnosis) -> str:
    """Return by how much the gap shrinks on other runs of the kind, where that is known."""
    low, high = diagnosis.gap.shrink_interval
    if not diagnosis.selected or not math.isfinite(low + high):
        return ""
    shrink = format_percent(diagnosis.gap.shrink)
    return f"The gap shrinks by {shrink} (90 % interval: {format_percent(low)} to {format_percent(high)})."


def show_signals(diagnosis: Diagnosis, figures: Figures) -> list[Block]:
    """Return the held-out signals with what is left of them, then every run over time, the held-out one first."""
    gaps, evidence = diagnosis.gap.before.channels, diagnosis.evidence
    known = [trace for trace in map(drop_start, [*evidence.traces, *evidence.other_traces]) if len(trace.time) > 1]
    if not known:
        return []
    named = [replace(each, run=f"{each.run}{' (held out)' * (each.run in diagnosis.held_out)}") for each in known]
    lines = {"measured": ("measured", MEASURED), "nominal": ("nominal", NOMINAL)}
    lines["after"] = (find_last(diagnosis).label, 0 if diagnosis.selected else 2)
    runs = list(dict.fromkeys(trace.run for trace in named))
    ordered = sorted(named, key=lambda trace: (runs.index(trace.run), -gaps.get(trace.channel, 0.0)))
    return [*show_pictures(figures, "signal_"), pack_traces(ordered, lines)]


def show_discrepancy(diagnosis: Diagnosis, figures: Figures) -> list[Block]:
    """Return the signal that would close the gap, described, over time and over what may drive it."""
    found = diagnosis.evidence.discrepancy
    if found is None or len(found.values) < 2:
        return []
    lead = formatting.explain("missing", words=found.words)
    return [*lead, Items(list(map(format_sentence, found.description))), *show_pictures(figures, "discrepancy")]


def _show_comfort(diagnosis: Diagnosis) -> list[Table]:
    """Return comfort and travel on the held-out run, the figures by which seats are assessed."""
    rows = []
    for each in diagnosis.evidence.comfort:
        measured, nominal, after = (format_quantity(x, each.unit) for x in (each.measured, each.nominal, each.after))
        errors = [_format_error(value, each.measured) for value in (each.nominal, each.after)]
        rows.append((each.quantity.replace("_", " "), measured, nominal, errors[0], after, errors[1]))
    return show_table("comfort", rows, last=find_last(diagnosis).label)


def _list_notes(diagnosis: Diagnosis) -> list[str]:
    """Return notes on the data, and the groups of blocks that the recorded channels can tell apart."""
    sentences = list(diagnosis.notes)
    if diagnosis.held_out:
        sentences.append(f"Held out, no part of any fit: {join_names(diagnosis.held_out)}.")
    if groups := [join_names(group, "or") for group in diagnosis.isolable if group]:
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
        return f"{format_number(abs(1e3 * found.value))} ms"
    return format_quantity(abs(found.value), found.unit)
