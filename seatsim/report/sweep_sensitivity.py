"""Which keys of a sweep matter: shares of the variance, and means at low and high values."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from seatsim.plots.labels import format_unit
from seatsim.report.blocks import Bar, Bars, Block, Text
from seatsim.report.formatting import format_number, format_percent
from seatsim.report.sweep_names import COMFORT, TRAVEL, describe_column, format_level
from seatsim.sweeps.rows import SweepRows
from seatsim.sweeps.sensitivity import Sensitivities, Sensitivity

MOST_KEYS = 14
ENOUGH = 0.8
"""Share of the variance that an expansion must predict before nothing is said about it."""


def choose_metric(found: Sensitivities) -> str:
    """Return comfort where it varies, else the first metric."""
    metrics = dict.fromkeys(row.metric for row in found.rows)
    return COMFORT if COMFORT in metrics else next(iter(metrics))


def show_sensitivity(found: Sensitivities, rows: SweepRows) -> list[Block]:
    """Return the shares of variance and a tornado chart for comfort, travel and each limited metric."""
    if not found.rows:
        return [Text(f"{found.problem[0].upper()}{found.problem[1:]}.")]
    metrics = [name for name in (COMFORT, TRAVEL, *rows.manifest["limits"]) if found.of(name)]
    blocks: list[Block] = []
    for metric in dict.fromkeys(metrics or [choose_metric(found)]):
        here = found.of(metric)
        words = describe_column(metric, rows.units).words
        blocks += [_draw_shares(here, words), _draw_tornado(here, rows)]
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


def _draw_tornado(found: Sequence[Sensitivity], rows: SweepRows) -> Bars:
    """Return from where to where the mean of a metric goes between a low and a high value of each key."""
    shown, strongest = describe_column(found[0].metric, rows.units), found[:MOST_KEYS]
    means = [mean for row in strongest for mean in (row.at_low, row.at_high)]
    least, scale = min(means), 100 / ((max(means) - min(means)) or 1.0)
    bars = []
    for row in strongest:
        start, end = sorted(round(scale * (mean - least), 2) for mean in (row.at_low, row.at_high))
        ends = ((row.low, row.at_low), (row.high, row.at_high))
        texts = [f"{format_number(shown.factor * mean)} at {format_level(level)}" for level, mean in ends]
        unit = format_unit(rows.units.get(row.key, ""))
        bars.append(Bar(row.key, start, end, f"{texts[0]}, {texts[1]} {unit}".rstrip(" -")))
    caption = (
        "Mean where a key is low (its 5 % quantile) and high (its 95 % quantile); of a key whose values are texts, at"
        " the texts with the smallest and the largest mean."
    )
    return Bars(f"How far each key moves the mean {shown.axis}", caption, "key", "mean at the low and high value", bars)


def _known(value: float) -> float:
    return min(1.0, max(0.0, value)) if np.isfinite(value) else 0.0
