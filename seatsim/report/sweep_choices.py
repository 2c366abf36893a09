"""Conditions and choices among the keys of a sweep: advice on each, and the best choice under each condition."""

from __future__ import annotations

from collections.abc import Sequence

from seatsim.plots.labels import format_number, format_percent
from seatsim.plots.sweeps import COMFORT, describe_column, format_level
from seatsim.report.blocks import Block, tabulate
from seatsim.scenario.scenario import is_condition
from seatsim.sweeps.rows import SweepRows
from seatsim.sweeps.sensitivity import Sensitivity, choose_key

MOST_LINES = 60
"""Conditions in the table."""
_MATTERS = 0.1
"""Share of the variance from which on a key is worth a step."""


def choose_choice(found: Sequence[Sensitivity], rows: SweepRows) -> Sensitivity | None:
    """Return which of the keys that a designer chooses matters most to a metric."""
    return choose_key([row for row in found if not is_condition(row.key)], rows)


def advise_on_keys(found: Sequence[Sensitivity], rows: SweepRows) -> list[str]:
    """Return what to do about the strongest choice, and where the strongest condition is the worst."""
    texts = []
    choice = choose_choice(found, rows)
    if choice is not None:
        share = f"explains the most of the variance, {format_percent(choice.total)}"
        what = "tolerance" if choice.key in rows.drawn else "key"
        verb = "Tighten the tolerance of" if what == "tolerance" else "Settle"
        if choice.total < _MATTERS:
            texts.append(f"No {what} that a designer chooses matters much: of them {choice.key} {share}.")
        else:
            texts.append(f"{verb} {choice.key} first: of all choices it {share}.")
    condition = choose_key([row for row in found if is_condition(row.key)], rows)
    if condition is not None:
        shown = describe_column(condition.metric, rows.units)
        worst, level = max(
            (condition.at_low, condition.low), (condition.at_high, condition.high), key=lambda end: end[0]
        )
        unit = describe_column(condition.key, rows.units).unit
        at = f"{format_level(level)} {unit}".removesuffix(" -")
        mean = f"{format_number(shown.factor * worst)} {shown.unit}".removesuffix(" -")
        texts.append(f"Judge every choice at {condition.key} {at}: there the mean {shown.words} is largest, {mean}.")
    return texts


def tabulate_best(rows: SweepRows) -> list[Block]:
    """Return the most comfortable choice under each condition, the worst condition first; nothing of random points.

    Figures are means over seeds. Only a design with every choice under every condition can be compared so.
    """
    conditions = [key for key in rows.keys if is_condition(key)]
    choices = [key for key in rows.keys if key not in conditions]
    if not conditions or not choices or rows.is_random or COMFORT not in rows.metrics:
        return []
    means = rows.usable.groupby([*conditions, *choices], as_index=False)[COMFORT].mean()
    counts = means.groupby(conditions)[COMFORT].size()
    if counts.min() < 2:
        return []
    best = means.loc[means.groupby(conditions)[COMFORT].idxmin()].sort_values(COMFORT, ascending=False)
    lines = [
        [*(format_level(value) for value in line[:-1]), format_number(float(line[-1]))]
        for line in best.head(MOST_LINES).itertuples(index=False, name=None)
    ]
    left = len(best) - len(lines)
    others = f"; and {left} other conditions" if left else ""
    shown = describe_column(COMFORT, rows.units)
    caption = f"Most comfortable choice under each condition, the worst condition first{others}"
    return tabulate(caption, [*conditions, *choices, shown.axis], lines, len(conditions) + len(choices))
