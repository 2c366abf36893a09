"""Which of many runs a picture shows, and how each of them looks."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from seatsim.plots.style import COLOURS, DASHES, GREY, Entry, make_entries
from seatsim.plots.thinning import spread_evenly
from seatsim.scenario.scenario import is_passive
from seatsim.schema.text import join_names
from seatsim.simulation import naming
from seatsim.simulation.result import Run, rank_runs

MOST = 8
"""Most runs that lines of one panel can tell apart."""
_MOST_CLOSE = 3
"""Most runs that can be told apart over time, where a law may switch at every sample."""
_ROLES = ("most comfortable", "least comfortable", "best passive")
_FADED = 0.65
"""How much paler the last of several lines in one colour is than the first."""


class Shown(NamedTuple):
    """Runs that are drawn over each other: what they share, the runs, the look of each, and a note on them.

    `scenario` is the name of theirs where there are pictures of others beside, and empty else. The note says which runs
    are left out, and which cannot be relied on; `among` says of how many they were chosen.
    """

    scenario: str
    title: str
    runs: Sequence[Run]
    looks: Sequence[Entry]
    omission: str
    among: str = ""


def show_runs(runs: Sequence[Run]) -> list[Shown]:
    """Return the runs that are drawn over each other: all, or those of each scenario where one of several has several.

    A run looks the same in all pictures. Up to eight runs are all drawn. Of more runs, those at the first swept values
    (one for each variant) are drawn, or else the most and the least comfortable, the best passive one, and others
    between. They are called by what sets them apart from each other.
    """
    parts, looks, found = _divide(runs), choose_looks(runs), []
    for part in parts:
        shown, names, among, omission = _select_shown(part)
        scenario = part[0].scenario.name if len(parts) > 1 else ""
        own = [looks[id(run)]._replace(label=name) for run, name in zip(shown, names, strict=True)]
        omission += naming.explain_doubt(shown)
        found.append(Shown(scenario, naming.make_title(part), shown, own, omission, among))
    return found


def choose_extremes(shown: Shown) -> Shown:
    """Return the most and the least comfortable of some runs, and the best passive one; all, where they are few.

    The run whose current changes the most comes first, so that the others lie upon it.
    """
    pairs, omission = list(zip(shown.runs, shown.looks, strict=True)), shown.omission
    pairs.sort(key=lambda pair: -float(np.sum(np.abs(np.diff(pair[0].history["coil_current"])))))
    if len(pairs) > _MOST_CLOSE:
        ranked, drawn = rank_runs(shown.runs), list[str]()
        ends = (ranked[:1], ranked[-1:], [run for run in ranked if is_passive(run.scenario)][:1])
        roles = [(id(run), role) for role, found in zip(_ROLES, ends, strict=True) for run in found]
        pairs = [pair for pair in pairs if id(pair[0]) in dict(roles)] or spread_evenly(pairs, _MOST_CLOSE)
        for run, look in pairs:
            own = [role for each, role in roles if each == id(run)]
            drawn.append(f"“{look.label}”{f' ({join_names(own)})' if own else ''}")
        omission = f" Shown of {shown.among}: {join_names(drawn)}.{naming.explain_doubt([run for run, _ in pairs])}"
    return shown._replace(runs=[run for run, _ in pairs], looks=[look for _, look in pairs], omission=omission)


def choose_looks(runs: Sequence[Run]) -> dict[int, Entry]:
    """Return the look of each run, by its identity, in which every picture of the runs shows it.

    Runs of one variant share its colour, and are the paler the later they come; where no variants differ, each run has
    its own. Those that no picture draws as a line are grey: there are not enough colours for all.
    """
    parts = _divide(runs)
    names = {id(run): name for part in parts for name, run in zip(naming.label_runs(part), part, strict=True)}
    families = names
    if len({run.scenario.label.get("variant") for run in runs}) > 1:
        families = {id(run): str(run.scenario.label.get("variant", run.scenario.name)) for run in runs}
    members, drawn = dict[str, list[str]](), [_select_shown(part)[0] for part in parts]
    for run in [*(run for part in drawn for run in part), *runs]:
        own = members.setdefault(families[id(run)], [])
        own += [names[id(run)]] * (names[id(run)] not in own)
    pictures = [{families[id(run)] for run in part} for part in drawn]
    palette, looks, found = make_entries(COLOURS * len(DASHES)), dict[str, Entry](), dict[tuple[str, str], Entry]()
    for family, own in members.items():
        # In no picture two families share a colour needlessly.
        beside = [looks[each] for group in pictures if family in group for each in group if each in looks]
        used, is_drawn = Counter(look.colour for look in beside), any(family in group for group in pictures)
        look = looks[family] = min(palette, key=lambda free: (used[free.colour], free in beside))
        for k, name in enumerate(own):
            alpha = 1.0 - _FADED * k / max(1, len(own) - 1)
            found[family, name] = look._replace(label=name, colour=look.colour if is_drawn else GREY, alpha=alpha)
    return {run: found[families[run], name] for run, name in names.items()}


def _divide(runs: Sequence[Run]) -> list[list[Run]]:
    """Return the runs of each scenario where one of several has several, or else all together."""
    scenarios = dict.fromkeys(run.scenario.name for run in runs)
    if not 1 < len(scenarios) < len(runs):
        return [list(runs)]
    return [[run for run in runs if run.scenario.name == name] for name in scenarios]


def _select_shown(runs: Sequence[Run]) -> tuple[list[Run], list[str], str, str]:
    """Return the runs that are drawn, their names, of how many they are, and how they were chosen of more."""
    among = f"{len(runs)} runs"
    if len(runs) <= MOST:
        return list(runs), naming.label_runs(runs), among, ""
    # Lines of the same swept values differ in their variant, which is what a reader compares.
    first = _swept_values(runs[0])
    group = [run for run in runs if _swept_values(run) == first]
    if 1 < len(group) <= MOST:
        at = ", ".join(naming.describe_swept(runs[0].scenario, key, value) for key, value in first.items())
        omission = f" {len(group)} of {among} are compared: {at}."
        return group, naming.label_runs(group, first), f"{len(group)} runs ({at})", omission
    ranked = rank_runs(runs)
    passive = [run for run in ranked if is_passive(run.scenario)][:1]
    kept = {id(run) for run in [*spread_evenly(ranked or runs, MOST - len(passive)), *passive]}
    chosen = [run for run in runs if id(run) in kept]
    which = ["the most and the least comfortable", *["the best passive"] * len(passive), "some between"]
    omission = f" {len(chosen)} of {among} are drawn{f': {join_names(which)}' if ranked else ''}."
    return chosen, naming.label_runs(chosen), among, omission


def _swept_values(run: Run) -> dict[str, object]:
    return {key: value for key, value in run.scenario.label.items() if key != "variant"}
