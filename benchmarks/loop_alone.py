"""The compiled loop of a run with all of its arguments at hand, so that it can be timed alone."""

from __future__ import annotations

from collections.abc import Callable

from seatsim.scenario.scenario import Scenario
from seatsim.simulation import simulate as simulation


def loop_of(scenario: Scenario, carry_all_effects: bool | None = None) -> Callable[[], object]:
    """Simulate a scenario, and return what calls its compiled loop again."""
    calls: list[Callable[[], object]] = []
    compiled = simulation.__dict__["compiled"]

    def record(function: object, parts: object) -> Callable[..., object]:
        loop = compiled(function, parts)

        def call(*arguments: object) -> object:
            calls.append(lambda: loop(*arguments))
            return loop(*arguments)

        return call

    simulation.__dict__["compiled"] = record
    try:
        simulation.simulate(scenario, carry_all_effects=carry_all_effects)
    finally:
        simulation.__dict__["compiled"] = compiled
    return calls[0]
