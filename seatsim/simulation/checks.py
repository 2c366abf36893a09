"""Whether a run meets the checks of its scenario: its metrics, its sampled loop, and how it comes to rest.

Beside them stands what came of the designs of some runs: gain, norm and margins in words, and what the limits of the
damper cost.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from seatsim.excitations.periodic import Rest
from seatsim.metrics.comfort import weighted_rms
from seatsim.rig.control import LAWS, FloorRecord, ForceLaw
from seatsim.rig.designs import Clipping, SynthesisedLaw
from seatsim.rig.sampled_loop import SampledLoop, build_sampled_loop
from seatsim.scenario.checks import LOOP_FIGURES, STABLE, Check
from seatsim.scenario.scenario import Scenario, Start
from seatsim.schema.arrays import Array
from seatsim.schema.content import Form, Joined, written
from seatsim.schema.errors import InputError
from seatsim.schema.registry import specification_of
from seatsim.simulation.augment import augment_plant
from seatsim.simulation.result import Run
from seatsim.simulation.runs import run_one
from seatsim.simulation.simulate import design_law, record_floors, sample_period, settle_travel, simulate

_RELEASE = Start(displacement=0.02)
"""Where the suspension is released to see whether the controlled seat comes to rest."""
_RELEASE_DURATION = 12.0
"""Time in s from the release to the end of the observation, which is its last two seconds."""
_LARGEST_SPEED = 1e-3
"""Speed of the suspension in m/s below which a released seat has come to rest."""


class _Figure(NamedTuple):
    """A measured figure with its bounds."""

    name: str
    value: float
    unit: str
    low: Annotated[float, Form(key="min")]
    high: Annotated[float, Form(key="max")]

    @property
    @written("pass")
    def is_within(self) -> bool:
        """Whether the figure lies within its bounds; one that has no value does not."""
        return self.low <= self.value <= self.high

    def __str__(self) -> str:
        unit = "" if self.unit == "-" else f" {self.unit}"
        stated = {"at least": self.low, "at most": self.high}
        bounds = [f"{word} {bound:.4g}{unit}" for word, bound in stated.items() if math.isfinite(bound)]
        return f"{self.name} is {self.value:.4g}{unit}; it must be {' and '.join(bounds)}"


class CheckedRun(NamedTuple):
    """A check of a run with the figure that decides it: the first out of bounds, else the first that was measured."""

    run: str
    check: str
    figure: Joined[_Figure]

    def __str__(self) -> str:
        return f"{self.run}, {self.check}: {self.figure}"


def check_run(run: Run) -> Iterator[CheckedRun]:
    """Yield every check that a run has to meet with the figure that decides it, in the order of the file.

    Raises:
        InputError: the loop of a law that is not linear is asked for its margins, or a metric has no value in this run.
    """
    for check in applicable_checks(run.scenario):
        yield CheckedRun(run.scenario.title, check.name, decide_check(run, check))


def applicable_checks(scenario: Scenario) -> list[Check]:
    """Return the checks that a run of this scenario has to meet."""
    return [check for check in scenario.checks if check.is_made_of(scenario.label)]


def decide_check(run: Run, check: Check) -> _Figure:
    """Return the figure that decides a check of a run.

    Raises:
        InputError: as for `check_run`.
    """
    figures = list(_measure(run, check))
    return next((figure for figure in figures if not figure.is_within), figures[0])


def _measure(run: Run, check: Check) -> Iterator[_Figure]:
    scenario, bounds = run.scenario, (check.low, check.high)
    with scenario.placed("checks", check.name):
        if check.name == STABLE:
            yield from _measure_stability(scenario)
        elif check.name in LOOP_FIGURES:
            yield _Figure(check.name, _loop_figure(scenario, check.name), LOOP_FIGURES[check.name], *bounds)
        elif check.name in run.metrics:
            metric = run.metrics[check.name]
            yield _Figure(check.name, metric.value, metric.unit, *bounds)
        else:
            raise InputError(f"the run has no {check.name}: what it is computed from is not stated or not recorded")


def _measure_stability(scenario: Scenario) -> Iterator[_Figure]:
    """Yield the spectral radius of a linear loop, and for every law how fast a released seat still moves at the end."""
    loop = _sampled_loop(scenario)
    if isinstance(loop, SampledLoop):
        # The largest number below 1: a loop with a radius of 1 does not come to rest.
        radius, bound = loop.radius(_delay_samples(scenario, loop)), math.nextafter(1.0, 0.0)
        yield _Figure("spectral radius of the sampled loop", radius, "-", -math.inf, bound)
    released = simulate(_silence_sensors(replace(scenario, excitation=Rest(_RELEASE_DURATION), start=_RELEASE)))
    speed = np.abs(released["suspension_velocity"][-round(2.0 / released.step) :])
    yield _Figure(
        "speed of the suspension 10 to 12 s after a release", float(speed.max()), "m/s", -math.inf, _LARGEST_SPEED
    )


def _silence_sensors(scenario: Scenario) -> Scenario:
    """Return a scenario whose sensors have no noise, which keeps a stable seat in motion as well."""
    control = scenario.control
    if control is None or control.sensors is None:
        return scenario
    sensors = control.sensors._replace(displacement_noise=0.0, acceleration_noise=0.0)
    return replace(scenario, control=replace(control, sensors=sensors))


def describe_sampled_loop(scenario: Scenario) -> str:
    """Return in words whether the sampled loop of a scenario is stable, or why its law has none."""
    loop = _sampled_loop(scenario)
    if not isinstance(loop, SampledLoop):
        return loop
    radius = loop.radius(_delay_samples(scenario, loop))
    verdict = "stable" if radius < 1 else "UNSTABLE"
    return f"{verdict} at {1000 * loop.sample_time:g} ms: spectral radius {radius:.5f}"


def _loop_figure(scenario: Scenario, name: str) -> float:
    loop = _sampled_loop(scenario)
    if not isinstance(loop, SampledLoop):
        raise InputError(f"{loop}; name the variants that have such a loop, as {name}: {{min: x, per: [VARIANT]}}")
    late = _delay_samples(scenario, loop)
    if name == "disk_margin":
        return loop.disk_margin(late)
    return max(0.0, loop.delay_margin() - scenario.coil.delay)


def _delay_samples(scenario: Scenario, loop: SampledLoop) -> int:
    """Return the samples that the delay of the coil takes, rounded up, so that no loop looks better than it is."""
    return math.ceil(round(scenario.coil.delay / loop.sample_time, 6))


def _sampled_loop(scenario: Scenario) -> SampledLoop | str:
    """Return the loop of a law that is linear at small motion, on the seat as its effects change it; else why none."""
    plant, control = scenario.plant, scenario.control
    if plant is None or control is None:
        return "a damper bench has no loop"
    period = sample_period(scenario.solver.step, control)
    law = design_law(scenario, plant, control, period)
    if not isinstance(law, ForceLaw):
        return f"law {LAWS.name_of(type(control.law))} wants a current, not a force, and has no linear loop"
    initial = specification_of(type(control.law)).initial
    augmented = augment_plant(scenario.effects, plant)
    try:
        return build_sampled_loop(law, initial, augmented, scenario.coil, period, control.sensors, scenario.solver.step)
    except InputError as error:
        return f"law {LAWS.name_of(type(control.law))}: {error}"


def describe_designs(scenarios: Iterable[Scenario]) -> list[str]:
    """Return a sentence on every gain that these scenarios synthesise, with the first scenario that has it."""
    found: dict[str, str] = {}
    for scenario in scenarios:
        control, plant = scenario.control, scenario.plant
        if control is None or plant is None:
            continue
        law = settle_travel(scenario, control)
        if isinstance(law, SynthesisedLaw):
            text = law.describe(plant, scenario.coil, partial(record_floors, scenario, control))
            loop = f"{text}; sampled loop {describe_sampled_loop(scenario)}" if text else ""
            found.setdefault(loop, str(scenario.label.get("variant", scenario.title)))
    return [f"{name}: {text}" for text, name in found.items() if text]


def measure_clipping(scenario: Scenario, gain: Array) -> Clipping | None:
    """Return what the limits of the damper cost a gain in a run of a scenario; None where its law promises nothing."""
    control, plant = scenario.control, scenario.plant
    if control is None or plant is None or not isinstance(control.law, SynthesisedLaw):
        return None
    run = run_one(replace(scenario, control=replace(control, law=control.law.with_gain(gain))))
    floor = FloorRecord(run.history.step, run.history["floor_acceleration"])
    promised = control.law.promise(plant, scenario.coil, gain, floor)
    figures = (run.metrics[name].value for name in ("driver_acceleration_weighted", "force_tracking_error_relative"))
    return Clipping(weighted_rms(promised, 1.0 / floor.step), *figures)
