"""What runs and swept values are called: on a terminal, in reports and in pictures."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from seatsim.scenario.numbers import find_unit
from seatsim.scenario.scenario import Scenario
from seatsim.schema.printing import LONGEST, format_unit, shorten
from seatsim.schema.validation import is_finite_number
from seatsim.simulation.result import Run


def label_runs(runs: Sequence[Run], without: Collection[str] = ()) -> list[str]:
    """Return the names of runs, with a star behind that of a run whose figures cannot be relied on."""
    return [f"{name}{_star(run)}" for name, run in zip(name_runs(runs, without), runs, strict=True)]


def name_runs(runs: Sequence[Run], without: Collection[str] = ()) -> list[str]:
    """Return what sets each run apart from the others: variant and swept values, less those of some keys.

    Of runs of one scenario its name is left out; names that are alike are numbered.
    """
    several = len({run.scenario.name for run in runs}) > 1
    names = [shorten(_describe(run.scenario, several, without), LONGEST) for run in runs]
    return [
        f"{name}{f' ({names[: k + 1].count(name)})' if not without and names.count(name) > 1 else ''}"
        for k, name in enumerate(names)
    ]


def distinguish_runs(group: Sequence[Run], runs: Sequence[Run]) -> tuple[str, list[str]]:
    """Return what sets some of the runs apart from the others, and what sets each of these apart from the rest."""
    keys = [key for key in group[0].scenario.label if len({str(run.scenario.label.get(key)) for run in group}) == 1]
    several = len({run.scenario.name for run in runs}) > 1
    same = len({run.scenario.name for run in group}) == 1
    first = group[0].scenario
    shared = [describe_swept(first, key, first.label[key]) for key in keys]
    heading = ", ".join([first.name] * (several and same) + shared)
    names = [f"{shorten(_describe(run.scenario, not same, keys), 52)}{_star(run)}" for run in group]
    return shorten(heading, 52), names


def explain_doubt(runs: Sequence[Run], sign: str = "*") -> str:
    """Return a sentence on what a sign of the runs says whose figures cannot be relied on, where there are some."""
    reasons = dict.fromkeys(reason.rpartition(": ")[2] for run in runs for reason in run.unverified)
    return f" {sign} not verified: {'; '.join(reasons).replace('_', ' ')}." if reasons else ""


def _star(run: Run) -> str:
    return " *" * bool(run.unverified)


def make_title(runs: Sequence[Run]) -> str:
    """Return the name of one run with what sets it apart, or the names of the scenarios of several."""
    if len(runs) == 1:
        return f"{shorten(_describe(runs[0].scenario, True), 64)}{_star(runs[0])}"
    return shorten(", ".join(dict.fromkeys(run.scenario.name for run in runs)), 64)


def label_axis(scenario: Scenario, key: str) -> str:
    """Return the label of an axis over the swept key, with its unit."""
    return f"{name_key(key)} [{format_unit(find_unit(scenario, key)) or '-'}]"


def _describe(scenario: Scenario, named: bool, without: Collection[str] = ()) -> str:
    """Return variant and swept values, less those of some keys; `named` puts the scenario's name first."""
    parts = [describe_swept(scenario, key, value) for key, value in scenario.label.items() if key not in without]
    return ", ".join([scenario.name] * named + parts) or scenario.name


def describe_swept(scenario: Scenario, key: str, value: object) -> str:
    """Return a swept value as it is called, with its unit and, where the value alone does not tell it, its key."""
    if key == "variant":
        return str(value)
    if isinstance(value, str):
        # The last word tells enough of a key whose value is a name: class EM2.
        word = name_key(key).rpartition(" ")[2]
        return value if value.startswith(word) else f"{word} {value}"
    text = f"{value:g}" if is_finite_number(value) else str(value)
    unit = format_unit(find_unit(scenario, key)).removesuffix("-")
    return f"{text} {unit}" if key == "temperature" else f"{name_key(key)} {text} {unit}".strip()


def name_key(key: str) -> str:
    """Return what a swept key is called, without the place where it stands."""
    return "damper temperature" if key == "temperature" else key.rpartition(".")[2].replace("_", " ")


def find_swept_number(runs: Sequence[Run]) -> str:
    """Return the key with the most different values among those that are numbers in every run, or nothing."""
    counts = {"": 1}
    for key in runs[0].scenario.label:
        values = [run.scenario.label.get(key) for run in runs]
        if all(map(is_finite_number, values)):
            counts[key] = len(set(values))
    return max(counts, key=lambda key: counts[key])
