"""The rows of a sweep as its statistics take them; quantiles of every metric, and how often it exceeds a limit.

Both stand apart for each combination of the varied keys that are texts, such as variants and models.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from seatsim.metrics.exposure import ACTION
from seatsim.metrics.table import METRICS
from seatsim.sweeps.axes import DISTRIBUTIONS
from seatsim.sweeps.folder import read_manifest
from seatsim.sweeps.outcome import DONE
from seatsim.sweeps.parts import LEADING, read_sweep

if TYPE_CHECKING:
    import pandas as pd


class SweepRows(NamedTuple):
    """The rows of a sweep: `usable` without those of failed and unverified runs; `keys` that have more than one value.

    `drawn` are the keys whose values come from a distribution. `metrics` are those that some run has.
    """

    folder: Path
    manifest: Mapping[str, Any]
    every: pd.DataFrame
    usable: pd.DataFrame
    keys: list[str]
    drawn: list[str]
    metrics: list[str]
    units: Mapping[str, str]

    @property
    def texts(self) -> list[str]:
        """The varied keys whose values are no numbers."""
        return [key for key in self.keys if not is_number(self.usable[key])]

    @property
    def is_random(self) -> bool:
        """Whether points are drawn, so that shares of runs estimate probabilities."""
        return bool(self.drawn)


def read_rows(folder: Path) -> SweepRows:
    """Return the rows of a sweep.

    Raises:
        InputError: the folder holds no sweep, or none of its runs has ended.
    """
    manifest, frame = read_manifest(folder), read_sweep(folder)
    usable = frame[frame.state == DONE]
    named = [name for name in frame.columns if name not in (*LEADING, *METRICS)]
    vary = manifest["configuration"].get("vary", {})
    return SweepRows(
        folder=folder,
        manifest=manifest,
        every=frame,
        usable=usable,
        keys=[key for key in named if frame[key].nunique() > 1],
        drawn=[key for key, stated in vary.items() if isinstance(stated, dict) and set(DISTRIBUTIONS) & set(stated)],
        metrics=[name for name in METRICS if usable[name].notna().any()],
        units=frame.attrs["units"],
    )


def is_number(column: pd.Series) -> bool:
    """Tell whether a column holds numbers, truth values not among them."""
    return column.dtype.kind in "if"


_MOST_GROUPS = 60
"""Combinations of texts up to which each has rows of its own; of more, all runs are taken together."""
_SHARES = (0.05, 0.25, 0.5, 0.75, 0.95)
NAMES = ("p05", "p25", "median", "p75", "p95")


def _group_rows(rows: SweepRows) -> Iterator[tuple[dict[str, object], pd.DataFrame]]:
    """Yield each combination of the texts that were varied with its runs; all runs where there is none, or too many."""
    texts = rows.texts
    if not texts or len(rows.usable.groupby(texts)) > _MOST_GROUPS:
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
    for group, runs in _group_rows(rows):
        for metric in rows.metrics:
            values = runs[metric].dropna()
            if values.empty:
                continue
            quantiles = dict(zip(NAMES, values.quantile(list(_SHARES)), strict=True))
            figures = {"mean": values.mean(), "std": values.std(), "min": values.min()}
            figures |= {**quantiles, "max": values.max()}
            found.append({**group, "metric": metric, "unit": rows.units[metric], "runs": len(values), **figures})
    return pd.DataFrame(found)


_DEFAULT_LIMITS: Mapping[str, float] = {"driver_acceleration_weighted": ACTION.a8, "end_stop_hits": 0.0}
"""Where a sweep states none: the action value of 2002/44/EC for a day of eight hours of this vibration, and any hit."""


class Exceedance(NamedTuple):
    """How many of some runs exceed a limit: the share with its Wilson interval of 95 %."""

    group: Mapping[str, object]
    metric: str
    unit: str
    limit: float
    exceeding: int
    runs: int
    share: float
    low: float
    high: float


def count_exceedances(rows: SweepRows) -> list[Exceedance]:
    """Return how often each limit of the sweep is exceeded, by group; a run without the metric does not count."""
    from scipy.stats import binomtest

    limits = rows.manifest["limits"] or _DEFAULT_LIMITS
    found = []
    for group, runs in _group_rows(rows):
        for metric, limit in limits.items():
            values = runs[metric].dropna()
            if values.empty:
                continue
            exceeding = int((values > limit).sum())
            interval = binomtest(exceeding, len(values)).proportion_ci(0.95, method="wilson")
            share = exceeding / len(values)
            found.append(Exceedance(group, metric, rows.units[metric], limit, exceeding, len(values), share, *interval))
    return found
