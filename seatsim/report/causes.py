"""Causes of the gap: the blocks it lies in, effects with their probabilities and parameters, and what looks alike."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from seatsim.diagnosis.result import Cause, Diagnosis
from seatsim.report.blocks import Bar, Bars, Block, Matrix, Table, Text
from seatsim.report.formatting import (
    UNKNOWN,
    describe_effect,
    format_estimate,
    format_number,
    format_percent,
    format_sentence,
)
from seatsim.report.gap import shade_share
from seatsim.schema.text import join_names

MOST = 10
"""Effects that are shown."""
LIKELY = 0.05
"""Probability from which on the parameters of a cause are printed."""


def show_causes(diagnosis: Diagnosis) -> list[Block]:
    """Return where the gap lies, which effects may cause it, and their parameters."""
    blocks: list[Block] = []
    if diagnosis.where:
        blocks.append(_draw_location(diagnosis))
    if diagnosis.causes:
        blocks.append(_draw_ranking(diagnosis))
    shown = list(_select_causes(diagnosis))
    if shown:
        rows = [
            [cause.effect, format_sentence(describe_effect(cause.effect)) or UNKNOWN, _list_parameters(cause),
             format_percent(cause.shrink)]
            for cause in shown
        ]  # fmt: skip
        strong = [row for row, cause in enumerate(shown) if cause.effect in diagnosis.selected]
        head = ["effect", "what it is", "parameters", "shrink of the refitted gap by this effect alone"]
        blocks.append(Table("Parameters of the likely effects, ± one standard deviation", head, rows, 3, strong))
    return blocks


def show_confusions(diagnosis: Diagnosis) -> list[Block]:
    """Return which effects this recording cannot tell apart, and what would decide."""
    blocks: list[Block] = [
        Text(f"This recording cannot distinguish {join_names(group)}: each explains the gap equally well.")
        for group in diagnosis.indistinguishable
        if len(group) > 1
    ]
    found = diagnosis.experiment
    if found is not None:
        rows = [[found.name.replace("_", " "), found.kind, format_number(found.likeness_now),
                 format_number(found.likeness_then)]]  # fmt: skip
        head = ["what would decide", "kind", "likeness now", "likeness then"]
        table = Table("Likeness: 1 is alike, 0 has nothing in common", head, rows, 2)
        blocks += [table, Text(format_sentence(found.reason))]
    matrix = _draw_collinearity(diagnosis)
    return [*blocks, matrix] if matrix else blocks


def show_forms(diagnosis: Diagnosis) -> list[Block]:
    """Return the table of other forms of the damper, where they were tried."""
    forms = diagnosis.alternatives
    if not forms:
        return []
    own = forms[0].replaces
    lead = (
        f"Other models of the damper in the place of {own}, fitted to the damper force without the held-out run, free"
        f" of the tolerance. Shares are of the refitted gap on that run; the last column is {own}, fitted as freely."
    )
    rows = [
        [form.model, join_names(form.beside or ["no effect"]), format_percent(form.shrink),
         format_percent(form.refitted)]
        for form in forms
    ]  # fmt: skip
    head = ["model", "together with", "shrinks the gap by", f"{own}, fitted as freely"]
    return [Table(lead, head, rows, 2, [0])]


def _draw_location(diagnosis: Diagnosis) -> Bars:
    first = diagnosis.where[0]
    groups = [group for group in diagnosis.indistinguishable if set(group) & set(diagnosis.selected)]
    alike = {name.partition(".")[0] for group in groups for name in group}
    bars = [
        Bar(each.block, 0.0, round(100 * each.share, 2), format_percent(each.share),
            "chosen" if k == 0 else "alike" if each.block in alike else "plain")
        for k, each in enumerate(diagnosis.where)
    ]  # fmt: skip
    blocks = [share.block for share in diagnosis.where if share.block in alike]
    if diagnosis.verdict == "unknown":
        title = f"What stays unexplained lies in the {first.block}"
    elif first.block in alike and len(blocks) > 1:
        title = f"The gap lies in the {' or the '.join(blocks)}"
    else:
        title = f"{format_percent(first.share)} of the gap lies in the {first.block}"
    caption = "How the gap divides among the parts of the rig; the shares add up to 100 %."
    return Bars(title, caption, "part", "share of the gap", bars)


def _draw_ranking(diagnosis: Diagnosis) -> Bars:
    alike = {name for group in diagnosis.indistinguishable for name in group}
    bars = [
        Bar(cause.effect, 0.0, round(100 * cause.probability, 2), format_percent(cause.probability),
            "chosen" if cause.effect in diagnosis.selected else "alike" if cause.effect in alike else "plain")
        for cause in diagnosis.causes[:MOST]
    ]  # fmt: skip
    ends = (("no effect at all", diagnosis.probability_none), ("another cause", diagnosis.probability_unknown))
    bars += [Bar(name, 0.0, round(100 * value, 2), format_percent(value)) for name, value in ends]
    caption = (
        "Each figure is the probability that this effect is at work. Several can be at work together, so that the"
        " figures need not add up to 100 %. In bold are the effects that the diagnosis names; another cause is one"
        " that the library lacks."
    )
    return Bars("Which effects are at work", caption, "effect", "probability", bars)


def _select_causes(diagnosis: Diagnosis) -> Iterator[Cause]:
    """Yield the causes that are selected, in a group that cannot be told apart, or not improbable."""
    named = {*diagnosis.selected, *(name for group in diagnosis.indistinguishable for name in group)}
    for rank, cause in enumerate(diagnosis.causes):
        if cause.parameters and (cause.effect in named or (cause.probability >= LIKELY and rank < MOST)):
            yield cause


def _list_parameters(cause: Cause) -> str:
    return "; ".join(f"{name.replace('_', ' ')} {format_estimate(value)}" for name, value in cause.parameters.items())


def _draw_collinearity(diagnosis: Diagnosis) -> Matrix | None:
    """Return how alike the likeliest effects look with each other, the cosine between their sensitivities."""
    names, matrix = diagnosis.evidence.collinearity
    wanted = [*diagnosis.selected, *(name for group in diagnosis.indistinguishable for name in group)]
    wanted += [cause.effect for cause in diagnosis.causes[:3]]
    chosen = list(dict.fromkeys(names.index(name) for name in wanted if name in names))
    rest = [k for k in range(len(names)) if k not in chosen]
    if chosen:
        rest.sort(key=lambda k: -float(np.max(np.abs(matrix[k, chosen]))))
    chosen = [*chosen, *rest][: MOST - 2]
    if len(chosen) < 2:
        return None
    rows = []
    for place, k in enumerate(chosen[1:], start=1):
        values = [float(abs(matrix[k, other])) for other in chosen[:place]]
        cells = [(f"{value:.2f}", shade_share(value)) if math.isfinite(value) else ("", 0) for value in values]
        rows.append((f"{place + 1} {names[k]}", [*cells, *[("", 0)] * (len(chosen) - 1 - place)]))
    columns = [f"{place + 1}" for place in range(len(chosen) - 1)]
    caption = (
        f"1 is {names[chosen[0]]}. 0: nothing in common, 1: the same sensitivity in these channels, once the parameters"
        " within their tolerance are taken out."
    )
    return Matrix("How alike the effects look in this recording", caption, "effect", columns, rows)
