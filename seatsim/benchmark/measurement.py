"""What a measurement gives, and how times are taken."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import NamedTuple


class Cost(NamedTuple):
    """What something costs, in a unit such as `ns a step`, and its ratio to the cost of something else, `beside`."""

    what: str
    value: float
    unit: str
    ratio: float
    beside: str


Times = dict[str, list[float]]


def time_in_turns(runs: Mapping[str, Callable[[], object]], repeats: int) -> Times:
    """Return the times on the clock in s of each run, taken in turns so that a busy machine slows all alike."""
    times: Times = {name: [] for name in runs}
    for _ in range(repeats):
        for name, run in runs.items():
            start = time.perf_counter()
            run()
            times[name].append(time.perf_counter() - start)
    return times


def compare_least(what: str, times: list[float], unit: str, scale: float, beside: str, others: list[float]) -> Cost:
    """Return a cost by the least of its times, which a busy machine disturbs least; `scale` turns s into its `unit`."""
    return Cost(what, scale * min(times), unit, min(times) / min(others), beside)
