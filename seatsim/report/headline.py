"""What runs come to, in a sentence: a single one, alternatives under one condition, or several conditions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from seatsim.report.alternatives import (
    EQUAL,
    SAME,
    Alternatives,
    compare_figures,
    list_alternatives,
    measure_comfort,
    read_metric,
    state_best,
    state_comfort,
)
from seatsim.report.formatting import format_quantity
from seatsim.scenario.scenario import choice_of
from seatsim.schema.text import name_some
from seatsim.simulation.result import Run

LISTED = 3
"""Conditions beside the worst of which a sentence names the best choice."""


def describe_run(run: Run) -> str:
    """Return in a sentence what a run comes to: comfort, and the travel that it takes."""
    seat, travel = read_metric(run, "seat_factor"), read_metric(run, "suspension_displacement_peak")
    said = f"{run.scenario.title}: the driver feels {state_comfort(run)}"
    if np.isfinite(seat):
        change = compare_figures(seat)
        said += f", {change} {'as' if change == EQUAL else 'than'} the floor moves"
    said += f"; the suspension travels up to {format_quantity(travel, 'm')} from its rest"
    hits = read_metric(run, "end_stop_hits")
    if np.isfinite(hits):
        said += f" and meets its end stops {count_times(hits)}" if hits else " and never meets its end stops"
    return f"{said}."


def compare_runs(runs: Sequence[Run]) -> list[str]:
    """Return in sentences the best choice under each condition of some runs, the worst condition first."""
    groups = list_alternatives(runs)
    compared = [group for group in groups if len(group.runs) > 1]
    if sum(len(group.runs) for group in groups) < 2:
        return [f"{len(runs)} runs were simulated; too few of them have figures that can be relied on to be compared."]
    if not compared:
        return _state_range(groups)
    alone = [f"“{_name_alone(group)}”" for group in groups if len(group.runs) == 1]
    left = [f"No other run shares the condition of {name_some(alone, last='or')}."] if alone else []
    return [*([_state_one(compared[0])] if len(compared) == 1 else _state_several(compared)), *left]


def count_times(hits: float) -> str:
    """Return how often something happens, in words."""
    return "once" if hits == 1 else f"{hits:.0f} times"


def _state_range(groups: Sequence[Alternatives]) -> list[str]:
    """Return what runs come to of which no two share a condition, the worst first, so that none is called better."""
    worst, mildest = groups[0], groups[-1]
    low, high = measure_comfort(mildest.runs[0]), measure_comfort(worst.runs[0])
    lead = f"Under {len(groups)} conditions the driver feels"
    if high <= (1 + SAME) * low:
        said = f"{lead} the same, {state_comfort(worst.runs[0])}."
    else:
        said = (
            f"{lead} {format_quantity(low, 'm/s^2')} to {state_comfort(worst.runs[0])}; the worst is"
            f" “{_name_alone(worst)}”, the mildest “{_name_alone(mildest)}”."
        )
    if len({choice_of(group.runs[0].scenario) for group in groups}) == 1:
        return [said]
    return [said, "No two runs share floor, temperature and driver, so that none is called better than another."]


def _name_alone(group: Alternatives) -> str:
    return group.condition or group.names[0]


def _state_one(group: Alternatives) -> str:
    """Return which runs of one condition are the most comfortable, and by how much."""
    count, leaders = len(group.runs), group.leaders
    under = f"{group.condition}: " if group.condition else ""
    if leaders == count:
        every = f"All {count}" if count > 2 else "Both"
        return (
            f"{under}{every} runs are alike in comfort, within {100 * SAME:g} %: the driver feels {state_best(group)}."
        )
    names = [f"“{name}”" for name in group.names[:leaders]]
    which = f"{names[0]} is" if leaders == 1 else f"{name_some(names)} are alike and"
    return f"{under}Of {count} runs {which} the most comfortable: the driver feels {state_best(group)}."


def _state_several(groups: Sequence[Alternatives]) -> list[str]:
    """Return which choice is the best under all of several conditions, or which is under which."""
    worst, count = groups[0], len(groups)
    leading = [{choice_of(run.scenario) for run in group.runs[: group.leaders]} for group in groups]
    always = set.intersection(*leading)
    for name, run in zip(worst.names, worst.runs, strict=True):
        if choice_of(run.scenario) in always:
            every = f"all {count}" if count > 2 else "both"
            return [
                f"“{name}” is the most comfortable under {every} conditions. The worst of them is {worst.condition}:"
                f" the driver feels {state_best(worst)}."
            ]
    first, *others = [f"“{group.names[0]}”: the driver feels {state_best(group)}." for group in groups]
    named = [f"At {group.condition} it is {said}" for group, said in zip(groups[1:], others, strict=True)]
    more = [f"And {len(named) - LISTED} other conditions, which are milder."] if len(named) > LISTED else []
    lead = f"Which run is the most comfortable depends on the condition. At the worst, {worst.condition}, it is"
    return [f"{lead} {first}", *named[:LISTED], *more]
