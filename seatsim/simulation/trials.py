"""Runs that are made again with one thing changed: half and twice of a number."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from typing import NamedTuple

from seatsim.excitations.base import Floor
from seatsim.metrics.table import Metric
from seatsim.scenario.numbers import LAW, is_permitted, list_numbers, set_number
from seatsim.scenario.scenario import Scenario
from seatsim.schema.errors import InputError, RunError
from seatsim.simulation.runs import measure_run
from seatsim.simulation.simulate import simulate

STRETCH = 20.0
"""Seconds from the start that are simulated."""
_FACTORS = (0.5, 2.0)
_DAMPING = "plant.suspension_damping"


class _Trial(NamedTuple):
    """A number that was changed, by its dotted key, its value, and the metrics of the run with it."""

    key: str
    value: float
    metrics: dict[str, Metric]


def try_changes(scenario: Scenario, carry_all_effects: bool | None) -> list[_Trial]:
    """Return the first stretch of a run as it is, under no key, then with each change that is permitted and possible.

    `carry_all_effects` is that of the run, whose compiled loop serves again.

    Raises:
        RunError: the run as it is cannot be carried to its end.
    """
    floor = _begin(scenario.excitation.floor(scenario.solver.step, scenario.seed))

    def measure(tried: Scenario) -> dict[str, Metric]:
        return measure_run(tried, simulate(tried, floor, carry_all_effects=carry_all_effects))

    found = [_Trial("", 0.0, measure(scenario))]
    for key, value in _list_changes(scenario):
        with suppress(InputError, RunError):
            found.append(_Trial(key, value, measure(set_number(scenario, key, value))))
    return found


def _list_changes(scenario: Scenario) -> Iterator[tuple[str, float]]:
    for key, value in list_numbers(scenario).items():
        if value and (key == _DAMPING or key.startswith(f"{LAW}.")):
            yield from ((key, f * value) for f in _FACTORS if is_permitted(scenario, key, f * value))


def _begin(floor: Floor) -> Floor:
    count = round(STRETCH / floor.step) + 1
    motion = floor._asdict()
    del motion["step"]
    return Floor(floor.step, **{name: part[:count] for name, part in motion.items() if part is not None})
