"""From a scenario to the design of its control law, and the report on it."""

from __future__ import annotations

from seatsim.rig.designs import Progress, SynthesisedDesign, SynthesisedLaw
from seatsim.scenario.scenario import Scenario
from seatsim.schema.errors import InputError
from seatsim.schema.registry import name_of


def synthesise_design(scenario: Scenario, progress: Progress = lambda text: None) -> SynthesisedDesign:
    """Return the design of a law that has a synthesis, for the scenario's plant.

    Args:
        scenario: its controller names the law with its weights.
        progress: is called with what the search does.

    Raises:
        InputError: the scenario has no seat, or its law is not synthesised.
        SynthesisError: there is no such design.
    """
    with scenario.placed("controller"):
        if scenario.plant is None or scenario.control is None:
            raise InputError("a damper bench has no controller to synthesise")
        law = scenario.control.law
        if not isinstance(law, SynthesisedLaw):
            name = name_of("law", type(law))
            raise InputError(f"law '{name}' is not synthesised; use 'law: static_output_feedback' with 'weights'")
        return law.synthesis(scenario.plant, progress)
