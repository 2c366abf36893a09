"""What runs come to, in a sentence: a single one, alternatives under one condition, or several conditions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from seatsim.metrics.motion import ratio
from seatsim.metrics.table import COMFORT, SEAT, TRAVEL, UNWEIGHTED
from seatsim.report.formatting import format_quantity
from seatsim.scenario.scenario import choice_of, group_by_condition, is_passive
from seatsim.schema.printing import format_percent
from seatsim.schema.text import name_some
from seatsim.simulation.naming import distinguish_runs
from seatsim.simulation.result import Run

SAME = 0.01
"""Difference, as a share, up to which figures count as equal: other phases of the same floor change them by more."""
_EQUAL = "as much"
LISTED = 3
"""Conditions beside the worst of which a sentence names the best choice."""


class _Alternatives(NamedTuple):
    """Runs under one condition that can be relied on, the most comfortable first, each with its name."""

    condition: str
    runs: Sequence[Run]
    names: Sequence[str]

    @property
    def leaders(self) -> int:
        """How many of them are the most comfortable: the first, and those that are equal to it."""
        least = _measure_comfort(self.runs[0])
        return sum(_measure_comfort(run) <= (1 + SAME) * least for run in self.runs)


def _list_alternatives(runs: Sequence[Run]) -> list[_Alternatives]:
    """Return the runs that can be relied on in groups of one condition each, the worst condition first.

    Where some have weighted figures, those without are left out: the two cannot be compared.
    """
    found, is_weighted = [], any(COMFORT in run.metrics for run in runs)
    for group in group_by_condition((run.scenario, run) for run in runs):
        condition, names = distinguish_runs(group, runs)
        pairs = zip(group, names, strict=True)
        named = [pair for pair in pairs if np.isfinite(_measure_comfort(pair[0])) and not pair[0].unverified]
        known = [pair for pair in named if COMFORT in pair[0].metrics or not is_weighted]
        known.sort(key=lambda pair: _measure_comfort(pair[0]))
        if known:
            found.append(_Alternatives(condition, *zip(*known, strict=True)))
    return sorted(found, key=lambda group: -_measure_comfort(group.runs[0]))


def find_best(runs: Sequence[Run]) -> list[int]:
    """Return the places of the most comfortable runs of each condition under which several can be relied on.

    Those that are equal to the first are among them, unless all are.
    """
    groups = [group for group in _list_alternatives(runs) if len(group.runs) > group.leaders]
    best = [run for group in groups for run in group.runs[: group.leaders]]
    return [k for k, run in enumerate(runs) if any(run is each for each in best)]


def _measure_comfort(run: Run) -> float:
    """Return the weighted RMS acceleration of the driver in m/s^2; unweighted where the step is too long to weight."""
    return run.read_metric(COMFORT if COMFORT in run.metrics else UNWEIGHTED)


def _state_comfort(run: Run) -> str:
    """Return the comfort of a run with its unit."""
    words = "weighted RMS" if COMFORT in run.metrics else "RMS, not weighted"
    return f"{format_quantity(_measure_comfort(run), 'm/s^2')} ({words})"


def _compare_figures(ratio: float) -> str:
    """Return how much less or more a figure is than another, from their ratio."""
    return _EQUAL if abs(ratio - 1) <= SAME else f"{format_percent(abs(1 - ratio))} {'less' if ratio < 1 else 'more'}"


def _state_best(group: _Alternatives) -> str:
    """Return the comfort of the best run of a condition, and its distance from the best passive one in words.

    Where the best run is passive, the best controlled one stands beside it, and where all or none are passive the next
    run. Every difference in comfort stands with that in travel, for which it could be bought.
    """
    leaders, said = group.leaders, _state_comfort(group.runs[0])
    passive = [is_passive(run.scenario) for run in group.runs]
    first, is_mixed = passive[:leaders], len(set(passive)) > 1
    if is_mixed and all(first):
        k = passive.index(False)
        comfort, travel = _compare_runs(group.runs[k], group.runs[0])
        return f"{said}; control does not make it less: with “{group.names[k]}” it is {comfort}, at {travel}"
    if is_mixed and any(first):
        return f"{said}, and “{group.names[first.index(True)]}” of them is passive"
    if leaders == len(group.runs):
        return said
    k = passive.index(True) if is_mixed else leaders
    comfort, travel = _compare_runs(group.runs[0], group.runs[k])
    base = f"the {'best passive' if is_mixed else 'next'} run, “{group.names[k]}”"
    note = "" if any(passive) else "; no passive run is there to compare with"
    return f"{said}, {comfort} {'as' if comfort == _EQUAL else 'than'} with {base}, at {travel}{note}"


def _compare_runs(run: Run, base: Run) -> tuple[str, str]:
    """Return how the comfort of a run, and how the travel that it takes, compares with those of another."""
    comfort = _compare_figures(_measure_comfort(run) / _measure_comfort(base))
    change = ratio(run.read_metric(TRAVEL), base.read_metric(TRAVEL))
    if math.isnan(change):
        return comfort, "more travel than none"
    travel = _compare_figures(change)
    return comfort, "equal travel" if travel == _EQUAL else f"{travel} travel (RMS)"


def describe_run(run: Run) -> str:
    """Return in a sentence what a run comes to: comfort, and the travel that it takes."""
    seat, travel = run.read_metric(SEAT), run.read_metric("suspension_displacement_peak")
    said = f"{run.scenario.title}: the driver feels {_state_comfort(run)}"
    if np.isfinite(seat):
        change = _compare_figures(seat)
        said += f", {change} {'as' if change == _EQUAL else 'than'} the floor moves"
    said += f"; the suspension travels up to {format_quantity(travel, 'm')} from its rest"
    if np.isfinite(hits := run.read_metric("end_stop_hits")):
        said += f" and meets its end stops {count_times(hits)}" if hits else " and never meets its end stops"
    return f"{said}."


def compare_runs(runs: Sequence[Run]) -> list[str]:
    """Return in sentences the best choice under each condition of some runs, the worst condition first."""
    groups = _list_alternatives(runs)
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


def _state_range(groups: Sequence[_Alternatives]) -> list[str]:
    """Return what runs come to of which no two share a condition, the worst first, so that none is called better."""
    worst, mildest = groups[0], groups[-1]
    low, high = format_quantity(_measure_comfort(mildest.runs[0]), "m/s^2"), _state_comfort(worst.runs[0])
    named = f"the worst is “{_name_alone(worst)}”, the mildest “{_name_alone(mildest)}”"
    said = f"Under {len(groups)} conditions the driver feels {low} to {high}; {named}."
    if len({choice_of(group.runs[0].scenario) for group in groups}) == 1:
        return [said]
    return [said, "No two runs share floor, temperature and driver, so that none is called better than another."]


def _name_alone(group: _Alternatives) -> str:
    return group.condition or group.names[0]


def _state_one(group: _Alternatives) -> str:
    """Return which runs of one condition are the most comfortable, and by how much."""
    count, leaders = len(group.runs), group.leaders
    under = f"{group.condition}: " if group.condition else ""
    names = [f"“{name}”" for name in group.names[:leaders]]
    which = f"{names[0]} is" if leaders == 1 else f"{name_some(names)} are alike and"
    said = f"Of {count} runs {which} the most comfortable"
    if leaders == count:
        said = f"{f'All {count}' if count > 2 else 'Both'} runs are alike in comfort, within {100 * SAME:g} %"
    return f"{under}{said}: the driver feels {_state_best(group)}."


def _state_several(groups: Sequence[_Alternatives]) -> list[str]:
    """Return which choice is the best under all of several conditions, or which is under which."""
    worst, count = groups[0], len(groups)
    leading = [{choice_of(run.scenario) for run in group.runs[: group.leaders]} for group in groups]
    always = set.intersection(*leading)
    for name, run in zip(worst.names, worst.runs, strict=True):
        if choice_of(run.scenario) in always:
            lead = f"“{name}” is the most comfortable under {f'all {count}' if count > 2 else 'both'} conditions."
            return [f"{lead} The worst of them is {worst.condition}: the driver feels {_state_best(worst)}."]
    first, *others = [f"“{group.names[0]}”: the driver feels {_state_best(group)}." for group in groups]
    named = [f"At {group.condition} it is {said}" for group, said in zip(groups[1:], others, strict=True)]
    more = [f"And {len(named) - LISTED} other conditions, which are milder."] if len(named) > LISTED else []
    lead = f"Which run is the most comfortable depends on the condition. At the worst, {worst.condition}, it is"
    return [f"{lead} {first}", *named[:LISTED], *more]
