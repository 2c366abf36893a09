"""All fault scenarios by name."""

from __future__ import annotations

from seatsim.blind.truth.faults import coil, damper, outside, seat, sensor
from seatsim.blind.truth.faults.scenario import FaultScenario

SCENARIOS: dict[str, FaultScenario] = {
    scenario.name: scenario for module in (damper, coil, seat, sensor, outside) for scenario in module.SCENARIOS
}


def scenarios_of(effect: str) -> list[FaultScenario]:
    """Return the scenarios of an effect of the contract, or of `outside`."""
    return [scenario for scenario in SCENARIOS.values() if scenario.effect == effect]
