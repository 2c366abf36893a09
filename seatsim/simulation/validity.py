"""Why the figures of a run cannot be relied on: a model outside its range, an open balance, a figure without value."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from seatsim.cosimulation.damper import FmuDamper
from seatsim.metrics.table import Metric
from seatsim.metrics.weighting import least_rate
from seatsim.rig.plant import USUAL_TRAVEL
from seatsim.scenario.scenario import Scenario
from seatsim.schema.registry import name_of, specification_of
from seatsim.simulation.augment import augment_plant
from seatsim.simulation.damper_bench import centring
from seatsim.simulation.simulate import History

SHARE = 0.01
"""Share of the run that may lie outside a range before it is worth a warning: a single peak changes no metric."""
LARGEST_RESIDUAL = 1e-3
"""Share of the energy that may be unaccounted for before the figures of a run cannot be relied on."""


def list_reasons(scenario: Scenario, history: History, metrics: Mapping[str, Metric]) -> tuple[str, ...]:
    """Return why the figures of a run are unverified; nothing where they can be relied on.

    A model was used outside the range of its data, a figure has no value, or more than `LARGEST_RESIDUAL` of the energy
    is unaccounted for. A driver of several masses has no energy balance, which is no reason by itself.
    """
    found = list(list_ranges_left(scenario, history))
    found += [f"{name} has no finite value" for name, metric in metrics.items() if not math.isfinite(metric.value)]
    residual = metrics.get("energy_residual")
    if residual is not None and residual.value > LARGEST_RESIDUAL:
        found.append(f"{residual.value:.2g} of the energy is unaccounted for; choose a smaller solver.step")
    return tuple(found)


def explain_unweighted(step: float, metrics: Mapping[str, Metric]) -> tuple[str, ...]:
    """Return why the figures of a run that the weighting by Wk needs are left out; nothing where they are there."""
    if "driver_acceleration_weighted" in metrics or "driver_acceleration_rms" not in metrics:
        return ()
    return (
        f"weighted figures (Wk RMS, VDV, SEAT factor) are left out: with solver.step {1e3 * step:g} ms there are"
        f" {1 / step:.4g} samples a second, and Wk needs {least_rate():g}; choose a step of"
        f" {1e3 / least_rate():g} ms or less",
    )


def list_ranges_left(scenario: Scenario, history: History) -> tuple[str, ...]:
    """Return a sentence for every range that a run leaves; those of the damper for more than 1 % of the time."""
    displacement, velocity = history["suspension_displacement"], history["suspension_velocity"]
    doubts = _doubt_travel(scenario, float(np.max(np.abs(displacement))))
    record: object = scenario.damper.record
    if isinstance(record, FmuDamper):  # which states no ranges
        return doubts
    specification, model = specification_of(type(record)), name_of("damper", type(record))
    ratio = scenario.plant.damper_ratio if scenario.plant else 1.0
    temperature, (coldest, hottest) = history["damper_temperature"], specification.temperatures
    # A command at the end of the laws may exceed it by rounding.
    fast = ratio * np.abs(velocity) > specification.max_speed
    strong = history["coil_current"] > specification.max_current * (1 + 1e-9)
    foreign = (temperature < coldest) | (temperature > hottest)
    degrees = f"not at {coldest:g} degC" if coldest == hottest else f"outside {coldest:g} to {hottest:g} degC"
    extrapolated = "the force there is an extrapolation"
    checks = (
        (fast, f"faster than {specification.max_speed:g} m/s", extrapolated),
        (strong, f"above {specification.max_current:g} A", "its laws end there"),
        (foreign, degrees, extrapolated),
    )
    found = [
        f"{model}: more than {SHARE:.0%} of a run is {what}, beyond the data behind the model; {consequence}"
        for outside, what, consequence in checks
        if np.mean(outside) > SHARE
    ]
    drift = centring(displacement, velocity) if specification.centred else ""
    return (*doubts, *found, *([f"{model}: {drift}"] if drift else []))


def _doubt_travel(scenario: Scenario, peak: float) -> tuple[str, ...]:
    """Return what is to be said where the suspension moves further than any seat does and no end stop is stated."""
    plant = scenario.plant
    if plant is None or augment_plant(scenario.effects, plant).end_stops or peak <= USUAL_TRAVEL[1]:
        return ()
    return (
        f"the suspension moves {1e3 * peak:.0f} mm from its mid-stroke, and seats have {1e3 * USUAL_TRAVEL[1]:.0f} mm"
        " at most; state plant.travel, and suspension.end_stop under effects",
    )
