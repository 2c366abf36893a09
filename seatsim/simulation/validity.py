"""What the user of a run is warned of: a model used outside the range of the data behind it."""

from __future__ import annotations

import numpy as np

from seatsim.scenario.scenario import Scenario
from seatsim.schema.registry import name_of, specification_of
from seatsim.simulation.damper_bench import centring
from seatsim.simulation.simulate import History

SHARE = 0.01
"""Share of the run that may lie outside a range before it is worth a warning: a single peak changes no metric."""


def list_warnings(scenario: Scenario, history: History) -> tuple[str, ...]:
    """Return a sentence for every range of the damper that the run leaves for more than 1 % of its time."""
    cls = type(scenario.damper.record)
    specification, model = specification_of(cls), name_of("damper", cls)
    ratio = scenario.plant.damper_ratio if scenario.plant else 1.0
    speed = ratio * np.abs(history["suspension_velocity"])
    checks = [
        (
            speed > specification.max_speed,
            f"faster than {specification.max_speed:g} m/s",
            "the force there is an extrapolation",
        ),
        (
            history["coil_current"] > specification.max_current * (1 + 1e-9),
            f"above {specification.max_current:g} A",
            "its laws end there",
        ),
    ]
    found = [
        f"{model}: more than {SHARE:.0%} of a run is {what}, beyond the data behind the model; {consequence}"
        for outside, what, consequence in checks
        if np.mean(outside) > SHARE
    ]
    drift = (
        centring(history["suspension_displacement"], history["suspension_velocity"]) if specification.centred else ""
    )
    return (*found, f"{model}: {drift}") if drift else tuple(found)
