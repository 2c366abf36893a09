"""The tests of a bench on a damper model: sines over a grid of settings, and steps of the commanded current."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import numpy as np

from seatsim.characterisation.response import Response, StepEnsemble, estimate_response, find_crossing
from seatsim.characterisation.rows import summarise_loops
from seatsim.characterisation.settings import SweepSettings
from seatsim.characterisation.specimen import DamperSpecimen
from seatsim.characterisation.summary import Characterisation
from seatsim.rig.coil import relax
from seatsim.simulation.damper_bench import bench_force, sine_test

SETTLED = 3.0
"""Seconds a sine runs at least before its last cycle is taken: models forget their start in that time."""
STEP = 1e-4
"""Seconds of a step of current between two values of the force."""
BEFORE = 0.2
"""Seconds of constant speed before the step."""
TIME_CONSTANTS = 12.0
"""Time constants of the coil after the step."""


def characterise_model(tested: DamperSpecimen, chosen: SweepSettings) -> Characterisation:
    """Return what a bench would show of a model: sine tests at all settings, and steps of the command.

    Raises:
        RunError: the damper's state ran away in one of the tests.
    """
    rows = []
    for x, f, warm, i in itertools.product(chosen.amplitudes, chosen.frequencies, chosen.temperatures, chosen.currents):
        cycles = max(3, math.ceil(SETTLED * f) + 1)
        test = sine_test(tested.damper, x, f, i, warm, tested.factors, cycles)
        test = test._replace(time=test.time - test.time[0])
        row = summarise_loops([test], f"{1e3 * x:g} mm, {f:g} Hz, {i:g} A, {warm:g} degC", "", i, warm)
        # One cycle is like the other.
        rows.append(row._replace(cycle_values=None))
    speed = 0.5 * min(max(row.peak_speed for row in rows), tested.specification.max_speed)
    answers = list(_responses(tested, chosen, speed))
    return Characterisation(
        tested.name, f"{tested.name}: {tested.damper}", False, rows, answers, list(_notes(tested, chosen))
    )


def _responses(tested: DamperSpecimen, chosen: SweepSettings, speed: float) -> Iterator[Response]:
    currents = [i for i in chosen.currents if i <= tested.coil.max_current] or [0.0]
    low = min(currents)
    for pair in itertools.chain(((low, i) for i in currents if i > low), ((i, low) for i in currents if i > low)):
        yield step_response(tested, *pair, speed, chosen.temperatures[0])


def step_response(tested: DamperSpecimen, before: float, after: float, speed: float, temperature: float) -> Response:
    """Return the response of a model to a step of the command in A at a constant speed in m/s, through its coil.

    The force is counted between those of the same motion at either current (`estimate_response`), so that a spring or a
    slow state leaves no trace.

    Raises:
        RunError: the damper's state ran away.
    """
    coil = tested.coil
    slowest = min(rate for rate in (coil.rate, coil.rate_fall) if rate > 0.0)
    lead, rows = round(BEFORE / STEP), round((coil.delay + TIME_CONSTANTS / slowest) / STEP)
    time = np.asarray(0.5 * STEP * np.arange(-2 * lead, 2 * rows + 1), dtype=float)
    late = np.maximum(time - coil.delay, 0.0)
    current = np.array([relax(coil, before, after, t) for t in late])
    motion = speed * time, np.full(len(time), speed)
    step, off, on = (
        bench_force(tested.damper, *motion, i, temperature, STEP, tested.factors) for i in (current, before, after)
    )
    share = (current[::2] - before) / (after - before)
    blank = Response("", before, after, 1, "simulated", speed=speed, current_t95=find_crossing(time[::2], share, 0.95))
    # The first half of the lead only brings the damper's state to this speed.
    kept = slice(lead // 2, None)
    if float(np.max(np.abs(on - off)[kept])) <= 1e-9 * float(np.max(np.abs(on))):
        return blank._replace(method="", note="the force does not depend on the current")
    step, off, on = (force[None, kept] for force in (step, off, on))
    return estimate_response(StepEnsemble(step, off, on, np.zeros(1), lead - lead // 2, 1.0 / STEP), blank)


def _notes(tested: DamperSpecimen, chosen: SweepSettings) -> Iterator[str]:
    """Yield what the user has to know of the settings."""
    specification = tested.specification
    if specification.complete and not tested.stated:
        yield f"{tested.name} is a form without a parameter set of its own; shown are the values of its record"
    speed = 2.0 * math.pi * max(chosen.frequencies) * max(chosen.amplitudes)
    if speed > 1.01 * specification.max_speed:
        yield f"speeds reach {speed:.3g} m/s; the model holds up to {specification.max_speed:g} m/s"
    if max(chosen.currents) > specification.max_current:
        yield f"currents reach {max(chosen.currents):g} A; the model holds up to {specification.max_current:g} A"
    if max(chosen.currents) > tested.coil.max_current:
        yield f"the coil carries {tested.coil.max_current:g} A at most: no response to a larger current is stated"
    low, high = specification.temperatures
    if any(tested.factors[:3]) and not low <= min(chosen.temperatures) <= max(chosen.temperatures) <= high:
        yield f"the model's temperatures are {low:g} to {high:g} degC"
    if len(chosen.temperatures) > 1 and not any(tested.factors[:3]):
        yield "temperature plays no part: state temperature_factors in a file for --parameters"
