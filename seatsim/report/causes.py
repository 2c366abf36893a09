"""Causes of the gap: the parameters of the likely effects, what looks alike, and other forms of the damper."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from seatsim.diagnosis.result import Cause, Diagnosis
from seatsim.plots.labels import UNKNOWN, format_number, format_percent
from seatsim.report.blocks import Block, Text, show_pictures, tabulate
from seatsim.report.formatting import describe_effect, format_estimate, format_sentence
from seatsim.schema.text import join_names

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LIKELY = 0.05
"""Probability from which on the parameters of a cause are printed."""
_ALIKE, _MOST_PAIRS = 0.5, 12
"""Collinearity from which on two effects are named as similar, and the most pairs that are."""


def show_causes(diagnosis: Diagnosis, figures: Mapping[str, Figure]) -> list[Block]:
    """Return where the gap lies, which effects may cause it, and their parameters."""
    shown = [each for each in diagnosis.causes if each.probability >= LIKELY or each.effect in diagnosis.selected]
    rows = [
        [cause.effect, format_sentence(describe_effect(cause.effect)) or UNKNOWN, _list_parameters(cause),
         format_percent(cause.probability), format_percent(cause.shrink)]
        for cause in shown
    ]  # fmt: skip
    strong = [row for row, cause in enumerate(shown) if cause.effect in diagnosis.selected]
    head = "effect, what it is, parameters, probability, alone takes off the refitted gap"
    table = tabulate("The likely effects, their parameters ± one standard deviation", head, rows, 3, strong)
    return [*show_pictures(figures, "location", "ranking"), *table]


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
        head = "what would decide, kind, likeness now, likeness then"
        blocks += tabulate("Likeness: 1 is alike, 0 has nothing in common", head, [row], 2)
        blocks.append(Text(format_sentence(found.reason)))
    names, matrix = diagnosis.evidence.collinearity
    pairs = sorted(
        ((float(matrix[i][j]), names[i], names[j]) for i in range(len(names)) for j in range(i)), reverse=True
    )
    rows = [(one, other, format_number(value, 2)) for value, one, other in pairs[:_MOST_PAIRS] if value >= _ALIKE]
    caption = "Effects whose signs in these channels are alike: 1 cannot be told apart, 0 has nothing in common"
    return [*blocks, *tabulate(caption, "effect, and, likeness", rows, 2)]


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
    return tabulate(lead, f"model, together with, shrinks the gap by, {own} fitted as freely", rows, 2, [0])


def _list_parameters(cause: Cause) -> str:
    return "; ".join(f"{name} {format_estimate(value)}" for name, value in cause.parameters.items()) or UNKNOWN
