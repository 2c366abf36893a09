"""From a scenario to the design of its control law, and the report on it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from seatsim.scenario.scenario import Scenario
from seatsim.schema.errors import InputError
from seatsim.schema.registry import name_of


def design_for(scenario: Scenario, progress: Callable[[str], object] = lambda text: None) -> Any:
    """Return the design of a law that has a synthesis, for the scenario's plant.

    Raises:
        InputError: the scenario has no seat, or its law is not synthesised.
        SynthesisError: there is no such design.
    """
    with scenario.placed("controller"):
        if scenario.plant is None or scenario.control is None:
            raise InputError("a damper bench has no controller to synthesise")
        law = scenario.control.law
        if not hasattr(law, "synthesis"):
            name = name_of("law", type(law))
            raise InputError(f"law '{name}' is not synthesised; use 'law: static_output_feedback' with 'weights'")
        return law.synthesis(scenario.plant, progress)
