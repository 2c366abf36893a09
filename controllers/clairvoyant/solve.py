"""From a scenario to its bracket."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from controllers.clairvoyant import Array, ClairvoyantBounds
from controllers.clairvoyant.bound import LowerBound, find_lower_bound
from controllers.clairvoyant.envelope import TOP, DamperEnvelope, fit_envelope
from controllers.clairvoyant.feasible import find_best_run
from controllers.clairvoyant.problem import ClairvoyantRun, HeldForceProblem
from controllers.clairvoyant.transcription import Transcription, transcribe
from seatsim.effects.base import ON_DAMPER, ON_SEAT, acts_on
from seatsim.scenario.scenario import Scenario
from seatsim.schema.errors import InputError
from seatsim.schema.registry import name_of

UNKNOWN = (*ON_DAMPER, *ON_SEAT, "factors", "temperature", "push", "plant")
"""Hooks of effects that change what the bracket is of."""


def solve(scenario: Scenario, weights: Array, hold: float, progress: Callable[[str], None]) -> ClairvoyantBounds:
    """Return the bracket, from the middle weight outwards: each bound starts from its neighbour's multipliers."""
    if weights.ndim != 1 or not len(weights) or not (np.isfinite(weights) & (weights > 0)).all():
        raise InputError("the weights of a bracket are one or more numbers above 0, in 1/s^4")
    transcription, band = _pose(scenario, hold)
    middle, order = len(weights) // 2, np.argsort(weights)
    found: dict[int, tuple[LowerBound, ClairvoyantRun]] = {}
    for place in sorted(range(len(weights)), key=lambda place: abs(place - middle)):
        progress(f"{scenario.title}: bracket, weight {len(found) + 1} of {len(weights)}")
        problem = HeldForceProblem(transcription, float(weights[order[place]]))
        near = found.get(place - 1 if place > middle else place + 1)
        found[place] = _find_both_ends(problem, band, near[0].logarithms if near else None)
    ends = [found[place] for place in np.argsort(order)]
    _check_speed([run for _, run in ends])
    return ClairvoyantBounds(
        weights, np.array([bound.value for bound, _ in ends]), np.sqrt([run.acceleration for _, run in ends]),
        np.sqrt([run.travel for _, run in ends]), np.array([run.force for _, run in ends]), transcription.step,
    )  # fmt: skip


def _find_both_ends(
    problem: HeldForceProblem, band: DamperEnvelope, start: Array | None
) -> tuple[LowerBound, ClairvoyantRun]:
    """Return the bound and the better of two runs: that from the weakest damper, and that from the bound's law."""
    weakest = find_best_run(problem, band.inner)
    bound = find_lower_bound(problem, band.outer, weakest.cost, start)
    led = find_best_run(problem, band.inner, bound.gain)
    return bound, min(weakest, led, key=lambda run: run.cost)


def _pose(scenario: Scenario, hold: float) -> tuple[Transcription, DamperEnvelope]:
    if scenario.plant is None:
        raise InputError(f"{scenario.name}: a damper bench has no seat, so it has no bracket")
    for effect in scenario.effects:
        if acts_on(type(effect), UNKNOWN):
            name = name_of("effect", type(effect))
            raise InputError(
                f"{scenario.name}: the bracket is of the seat without effects; leave out '{name}' (--set effects=[])"
            )
    if not isinstance(scenario.temperature, float | int):
        raise InputError(f"{scenario.title}: the bracket needs a damper of one temperature; state it as a number")
    step = scenario.solver.step
    every = round(hold / step)
    if every < 1 or abs(every * step - hold) > 1e-9:
        raise InputError(
            f"hold {hold:g} s is not a multiple of solver.step {step:g} s; choose {max(1, every) * step:g} s"
        )
    floor = scenario.excitation.floor(step, scenario.seed)
    if len(floor.acceleration) <= every:
        raise InputError(f"{scenario.title}: the floor's record is shorter than the time over which a force is held")
    if not floor.acceleration.any() and not any(scenario.start):
        raise InputError(f"{scenario.title}: nothing moves, so there is nothing to bracket")
    with scenario.placed("damper"):
        band = fit_envelope(scenario.damper, scenario.coil.max_current, float(scenario.temperature))
    return transcribe(scenario.plant, floor.acceleration, step, every, scenario.start), band


def _check_speed(runs: list[ClairvoyantRun]) -> None:
    top = max(float(np.max(np.abs(run.velocity))) for run in runs)
    if top > TOP:
        raise InputError(f"the damper moves at {top:.3g} m/s; the bracket's envelope holds to {TOP:g} m/s")
