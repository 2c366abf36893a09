"""Quantiles of every metric over the runs, apart for each combination of texts such as variants and models."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from seatsim.sweeps.statistics.inputs import SweepRows

if TYPE_CHECKING:
    import pandas as pd

MOST_GROUPS = 60
"""Combinations of texts up to which each has rows of its own; of more, all runs are taken together."""
SHARES = (0.05, 0.25, 0.5, 0.75, 0.95)
NAMES = ("p05", "p25", "median", "p75", "p95")


def group_rows(rows: SweepRows) -> Iterator[tuple[dict[str, object], pd.DataFrame]]:
    """Yield each combination of the texts that were varied with its runs; all runs where there is none, or too many."""
    texts = rows.texts
    if not texts or len(rows.usable.groupby(texts)) > MOST_GROUPS:
        yield dict.fromkeys(texts, "all"), rows.usable
        return
    for values, runs in rows.usable.groupby(texts, sort=False):
        yield dict(zip(texts, values, strict=True)), runs


def tabulate_quantiles(rows: SweepRows) -> pd.DataFrame:
    """Return a row for each group and metric: how many runs, mean, standard deviation, least, quantiles, greatest.

    Quantiles are interpolated linearly between the runs. A metric that a group lacks has no row.
    """
    import pandas as pd

    found = []
    for group, runs in group_rows(rows):
        for metric in rows.metrics:
            values = runs[metric].dropna()
            if values.empty:
                continue
            quantiles = dict(zip(NAMES, values.quantile(list(SHARES)), strict=True))
            found.append(
                {**group, "metric": metric, "unit": rows.units[metric], "runs": len(values), "mean": values.mean(),
                 "std": values.std(), "min": values.min(), **quantiles, "max": values.max()}
            )  # fmt: skip
    return pd.DataFrame(found)
