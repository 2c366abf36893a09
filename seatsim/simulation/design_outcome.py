"""What came of the designs of some runs: gain, norm and margins in words, and what the limits of the damper cost."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import partial

from seatsim.metrics.comfort import weighted_rms
from seatsim.rig.control import FloorRecord
from seatsim.rig.designs import CheckedLaw, Clipping, DescribedLaw
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array
from seatsim.simulation.checks import describe_sampled_loop
from seatsim.simulation.design import record_floors, settle_travel
from seatsim.simulation.runs import run_one
from seatsim.simulation.simulate import measure_peak_travel


def describe_designs(scenarios: Iterable[Scenario]) -> list[str]:
    """Return a sentence on every gain that these scenarios synthesise, with the first scenario that has it."""
    found: dict[str, str] = {}
    for scenario in scenarios:
        control, plant = scenario.control, scenario.plant
        if control is None or plant is None:
            continue
        law = settle_travel(scenario, control, measure_peak_travel)
        if isinstance(law, DescribedLaw):
            text = law.describe(plant, scenario.coil, partial(record_floors, scenario, control))
            loop = f"{text}; sampled loop {describe_sampled_loop(scenario)}" if text else ""
            found.setdefault(loop, str(scenario.label.get("variant", scenario.title)))
    return [f"{name}: {text}" for text, name in found.items() if text]


def measure_clipping(scenario: Scenario, gain: Array) -> Clipping | None:
    """Return what the limits of the damper cost a gain in a run of a scenario; None where its law promises nothing."""
    control, plant = scenario.control, scenario.plant
    if control is None or plant is None or not isinstance(control.law, CheckedLaw):
        return None
    run = run_one(replace(scenario, control=replace(control, law=control.law.with_gain(gain))))
    floor = FloorRecord(run.history.step, run.history["floor_acceleration"])
    promised = control.law.promise(plant, scenario.coil, gain, floor)
    figures = (run.metrics[name].value for name in ("driver_acceleration_weighted", "force_tracking_error_relative"))
    return Clipping(weighted_rms(promised, 1.0 / floor.step), *figures)
