"""How often a metric exceeds a limit, with the Wilson interval of a share."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from seatsim.metrics.exposure import ACTION
from seatsim.sweeps.statistics.inputs import SweepRows
from seatsim.sweeps.statistics.quantiles import group_rows

DEFAULT_LIMITS: Mapping[str, float] = {"driver_acceleration_weighted": ACTION.a8, "end_stop_hits": 0.0}
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

    limits = rows.manifest["limits"] or DEFAULT_LIMITS
    found = []
    for group, runs in group_rows(rows):
        for metric, limit in limits.items():
            values = runs[metric].dropna()
            if values.empty:
                continue
            exceeding = int((values > limit).sum())
            interval = binomtest(exceeding, len(values)).proportion_ci(0.95, method="wilson")
            share = exceeding / len(values)
            found.append(Exceedance(group, metric, rows.units[metric], limit, exceeding, len(values), share, *interval))
    return found
