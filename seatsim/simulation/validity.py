"""What the user of a run is warned of: doubtful values, and a model used outside the range of the data behind it."""

from __future__ import annotations

import numpy as np

from seatsim.rig.plant import USUAL_TRAVEL, Plant
from seatsim.scenario.plausibility import list_doubts
from seatsim.scenario.scenario import Scenario
from seatsim.schema.fields import default_values
from seatsim.schema.registry import name_of, specification_of
from seatsim.simulation.damper_bench import centring
from seatsim.simulation.simulate import History

SHARE = 0.01
"""Share of the run that may lie outside a range before it is worth a warning: a single peak changes no metric."""


def list_warnings(scenario: Scenario, history: History) -> tuple[str, ...]:
    """Return the doubts about a scenario, and a sentence for every range that its run leaves."""
    return (*list_doubts(scenario), *list_ranges_left(scenario, history))


def list_ranges_left(scenario: Scenario, history: History) -> tuple[str, ...]:
    """Return a sentence for every range that a run leaves; those of the damper for more than 1 % of the time."""
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
    found += [f"{model}: {drift}"] if drift else []
    return (*_doubt_travel(scenario.plant, history), *found)


def _doubt_travel(plant: Plant | None, history: History) -> tuple[str, ...]:
    """Return what is to be said where the suspension moves further than any seat does and no end stop is stated."""
    peak = float(np.max(np.abs(history["suspension_displacement"])))
    if plant is None or plant.travel != default_values(Plant)["travel"] or peak <= USUAL_TRAVEL[1]:
        return ()
    return (
        f"the suspension moves {1e3 * peak:.0f} mm from its mid-stroke, and seats have {1e3 * USUAL_TRAVEL[1]:.0f} mm"
        " at most; state plant.travel, and suspension.end_stop under effects",
    )
