"""Which of many runs a picture shows, and how each of them looks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from seatsim.metrics.table import COMFORT, UNWEIGHTED
from seatsim.plots.style import GREY, Entry, make_entries
from seatsim.plots.thinning import spread_evenly
from seatsim.scenario.scenario import is_passive
from seatsim.schema.text import join_names
from seatsim.simulation import naming
from seatsim.simulation.result import Run

MOST = 8
"""Most runs that lines of one panel can tell apart."""
_MOST_CLOSE = 3
"""Most runs that can be told apart over time, where a law may switch at every sample."""

_FADED = 0.65
"""How much paler the last of several lines in one colour is than the first."""


class Shown(NamedTuple):
    """Runs that are drawn over each other: what they share, the runs, the look of each, and a note on those left out.

    `scenario` is the name of theirs where there are pictures of others beside, and empty else.
    """

    scenario: str
    title: str
    runs: Sequence[Run]
    looks: Sequence[Entry]
    omission: str


def show_runs(runs: Sequence[Run]) -> list[Shown]:
    """Return the runs that are drawn over each other: all, or those of each scenario where one of several has several.

    A run looks the same in all pictures. Up to eight runs are all drawn. Of more runs, those at the first swept values
    (one for each variant) are drawn, or else eight that are spread evenly over their order, first and last included.
    They are called by what sets them apart from each other.
    """
    parts, looks, found = _divide(runs), choose_looks(runs), []
    for part in parts:
        shown, names, omission = _select_shown(part)
        scenario = part[0].scenario.name if len(parts) > 1 else ""
        own = [looks[id(run)]._replace(label=name) for run, name in zip(shown, names, strict=True)]
        found.append(Shown(scenario, naming.make_title(part), shown, own, omission))
    return found


def choose_extremes(shown: Shown) -> Shown:
    """Return the most and the least comfortable of some runs, and the best passive one; all, where they are few."""
    if len(shown.runs) <= _MOST_CLOSE:
        return shown
    is_weighted = all(np.isfinite(run.read_metric(COMFORT)) for run in shown.runs)
    pairs = list(zip(shown.runs, shown.looks, strict=True))
    ranked = sorted(pairs, key=lambda pair: pair[0].read_metric(COMFORT if is_weighted else UNWEIGHTED))
    known = [("most comfortable", ranked[0]), ("least comfortable", ranked[-1])]
    known += [("best passive", pair) for pair in ranked if is_passive(pair[0].scenario)][:1]
    why = dict[int, list[str]]()
    for words, (run, _) in known:
        why.setdefault(id(run), []).append(words)
    chosen = [pair for pair in pairs if id(pair[0]) in why]
    drawn = join_names([f"“{look.label}” ({join_names(why[id(run)])})" for run, look in chosen])
    omission = f"{shown.omission} Shown: {drawn}. Left out: {len(pairs) - len(chosen)} of {len(pairs)} runs."
    return shown._replace(runs=[run for run, _ in chosen], looks=[look for _, look in chosen], omission=omission)


def choose_looks(runs: Sequence[Run]) -> dict[int, Entry]:
    """Return the look of each run, by its identity, in which every picture of the runs shows it.

    Runs of one variant share its colour, and are the paler the later they come; where no variants differ, each run has
    its own. Those that no picture draws as a line are grey: there are not enough colours for all.
    """
    parts = _divide(runs)
    names = {id(run): name for part in parts for name, run in zip(naming.label_runs(part), part, strict=True)}
    families = names
    if len({run.scenario.label.get("variant") for run in runs}) > 1:
        families = {id(run): _name_variant(run) for run in runs}
    members, drawn = dict[str, list[str]](), [run for part in parts for run in _select_shown(part)[0]]
    for run in [*drawn, *runs]:
        family = members.setdefault(families[id(run)], [])
        family += [names[id(run)]] * (names[id(run)] not in family)
    found, coloured = {}, {families[id(run)] for run in drawn}
    for look in make_entries(list(members)):
        colour = look.colour if look.label in coloured else GREY
        for k, name in enumerate(members[look.label]):
            alpha = 1.0 - _FADED * k / max(1, len(members[look.label]) - 1)
            found[look.label, name] = look._replace(label=name, colour=colour, alpha=alpha)
    return {run: found[families[run], name] for run, name in names.items()}


def explain_grey(looks: Mapping[int, Entry]) -> str:
    """Return a sentence on the runs that no picture draws as a line, where there are some."""
    is_grey = any(look.colour == GREY for look in looks.values())
    return " Grey: runs that pictures over frequency leave out." * is_grey


def _name_variant(run: Run) -> str:
    """Return the variant of a run, or its scenario where it has none."""
    return str(run.scenario.label.get("variant", run.scenario.name))


def _divide(runs: Sequence[Run]) -> list[list[Run]]:
    """Return the runs of each scenario where one of several has several, or else all together."""
    scenarios = dict.fromkeys(run.scenario.name for run in runs)
    if not 1 < len(scenarios) < len(runs):
        return [list(runs)]
    return [[run for run in runs if run.scenario.name == name] for name in scenarios]


def _select_shown(runs: Sequence[Run]) -> tuple[list[Run], list[str], str]:
    """Return the runs that are drawn, what they are called, and how they were chosen where there are more."""
    if len(runs) <= MOST:
        return list(runs), naming.label_runs(runs), ""
    # Lines of the same swept values differ in their variant, which is what a reader compares.
    first = _swept_values(runs[0])
    group = [run for run in runs if _swept_values(run) == first]
    if 1 < len(group) <= MOST:
        at = ", ".join(naming.describe_swept(runs[0].scenario, key, value) for key, value in first.items())
        return group, naming.label_runs(group, without=first), f" {len(group)} of {len(runs)} runs are compared: {at}."
    chosen, omission = spread_evenly(runs, MOST), f" {MOST} of {len(runs)} runs are compared, spread over their order."
    return chosen, naming.label_runs(chosen), omission


def _swept_values(run: Run) -> dict[str, object]:
    return {key: value for key, value in run.scenario.label.items() if key != "variant"}
