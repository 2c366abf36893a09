"""What is refused before anything runs: draws that no scenario permits."""

from __future__ import annotations

from collections.abc import Iterator

from seatsim.excitations.base import Excitation
from seatsim.scenario.plausibility import list_doubts
from seatsim.schema.errors import InputError, list_sentences, raise_all
from seatsim.sweeps.plan import Plan

MOST_FLOORS = 40
"""Floors that are made to see whether they can be; more would take longer than the message is worth."""
MOST_LEVELS = 1000
"""Different numbers of a key from which on only the least and the greatest are looked at."""


def check_plan(plan: Plan) -> list[str]:
    """Build the scenarios of those runs in which a value could be out of place.

    Bounds are intervals: in each combination of texts and mappings (models, classes) the least and the greatest number
    of each key is looked at, besides the first run with each of up to a thousand different numbers.

    Returns:
        What is doubtful about the values though they are permitted, a sentence each.

    Raises:
        InputError: a value is not permitted; the message has its place, the number of its run, and what is permitted.
    """
    floors: set[tuple[type[Excitation], str]] = set()
    doubts: dict[str, None] = {}
    for run in sorted(set(_list_telling_runs(plan))):
        try:
            scenario = plan.scenario(run)
            asked = (type(scenario.excitation), repr((scenario.excitation, scenario.solver.step)))
            if scenario.excitation is not None and asked not in floors and len(floors) < MOST_FLOORS:
                floors.add(asked)
                with scenario.placed("excitation"):
                    scenario.excitation.floor(scenario.solver.step, scenario.seed)
        except InputError as error:
            raise_all([InputError(f"{said} (run {run} of {plan.runs})") for said in list_sentences(error)])
        doubts |= dict.fromkeys(list_doubts(scenario))
    return list(doubts)


def _list_telling_runs(plan: Plan) -> Iterator[int]:
    per_point = len(plan.bases)
    numbers = {key: [float(str(value)) for value in values] for key, values in plan.columns.items()
               if all(_is_number(value) for value in values)}  # fmt: skip
    others = [values for key, values in plan.columns.items() if key not in numbers]
    combinations: dict[str, list[int]] = {}
    for point in range(plan.points):
        combinations.setdefault(repr([values[point] for values in others]), []).append(point)
    points = {found[0] for found in combinations.values()}
    for values in numbers.values():
        for found in combinations.values():
            points |= {min(found, key=lambda point: values[point]), max(found, key=lambda point: values[point])}
        first: dict[float, int] = {}
        for point, value in enumerate(values):
            first.setdefault(value, point)
        points |= set(first.values()) if len(first) <= MOST_LEVELS else set()
    for point in points:
        yield from range(point * per_point, (point + 1) * per_point)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
