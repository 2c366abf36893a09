"""Which keys of a sweep matter: shares of the variance, and means at low and high values."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from seatsim.plots.labels import format_unit
from seatsim.report.blocks import Bar, Bars, Block, Table, Text
from seatsim.report.formatting import format_number, format_percent
from seatsim.report.sweep_names import COMFORT, TRAVEL, describe_column, format_level
from seatsim.sweeps.statistics.inputs import SweepRows
from seatsim.sweeps.statistics.sensitivity import Sensitivities, Sensitivity

MOST_KEYS = 14
ENOUGH = 0.8
"""Share of the variance that an expansion must predict before nothing is said about it."""


def choose_metric(found: Sensitivities) -> str:
    """Return comfort where it varies, else the first metric."""
    metrics = dict.fromkeys(row.metric for row in found.rows)
    return COMFORT if COMFORT in metrics else next(iter(metrics))


def show_sensitivity(found: Sensitivities, rows: SweepRows) -> list[Block]:
    """Return bars and a table for comfort, travel and each limited metric."""
    if not found.rows:
        return [Text(f"{found.problem[0].upper()}{found.problem[1:]}.")]
    metrics = [name for name in (COMFORT, TRAVEL, *rows.manifest["limits"]) if found.of(name)]
    blocks: list[Block] = []
    for metric in dict.fromkeys(metrics or [choose_metric(found)]):
        here = found.of(metric)
        words = describe_column(metric, rows.units).words
        blocks += [_draw_shares(here, words), _list_swings(here, rows)]
        if here[0].explained < ENOUGH:
            known = format_percent(max(0.0, here[0].explained))
            blocks.append(Text(f"The shares rest on a polynomial that predicts {known} of the variance of the {words}"
                               " in runs left out of its fit. The rest is the random road, sensor noise, or"
                               " interactions that it has no terms for."))  # fmt: skip
    return blocks


def _draw_shares(found: Sequence[Sensitivity], words: str) -> Bars:
    bars = [
        Bar(row.key, 0.0, round(100 * _known(row.first), 2),
            f"{format_percent(row.first)} alone, {format_percent(row.total)} with others",
            "chosen" if k == 0 else "plain",
            (round(100 * _known(row.total_low), 2), round(100 * _known(row.total_high), 2)))
        for k, row in enumerate(found[:MOST_KEYS])
    ]  # fmt: skip
    cut = f" The {MOST_KEYS} strongest of {len(found)} keys." if len(found) > MOST_KEYS else ""
    caption = (
        "Bar: share of the variance that the key explains alone. Black line: 95 % interval of its share together with"
        f" its interactions with other keys.{cut}"
    )
    return Bars(f"What determines the {words}", caption, "key", "share of the variance", bars)


class Swing(NamedTuple):
    """A value of a key and the mean of a metric there."""

    level: object
    mean: float


def _list_swings(found: Sequence[Sensitivity], rows: SweepRows) -> Table:
    shown = describe_column(found[0].metric, rows.units)
    lines = []
    for row in found[:MOST_KEYS]:
        ends = (Swing(row.low, row.at_low), Swing(row.high, row.at_high))
        values = [text for end in ends for text in (format_level(end.level), format_number(shown.factor * end.mean))]
        lines.append([row.key, format_unit(rows.units.get(row.key, "")) or "-", *values])
    head = ["key", "unit", "low value", "mean there", "high value", "mean there"]
    caption = (
        f"Mean {shown.axis} where a key is low (its 5 % quantile) and high (its 95 % quantile); of a key whose values"
        " are texts, the texts with the smallest and the largest mean"
    )
    return Table(caption, head, lines, 2)


def _known(value: float) -> float:
    return min(1.0, max(0.0, value)) if np.isfinite(value) else 0.0
