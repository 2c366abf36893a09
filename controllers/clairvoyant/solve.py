"""From a scenario to its bracket."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from controllers.clairvoyant import Array, Bracket
from controllers.clairvoyant.bound import lower_bound
from controllers.clairvoyant.envelope import TOP, Envelope, envelope
from controllers.clairvoyant.feasible import best_run
from controllers.clairvoyant.problem import Problem, Run
from controllers.clairvoyant.recursion import Lines
from controllers.clairvoyant.transcription import Transcription, transcribe
from seatsim.effects.base import ON_DAMPER, ON_SEAT, acts_on
from seatsim.errors import InputError
from seatsim.registry import name_of
from seatsim.scenario import Scenario

UNKNOWN = (*ON_DAMPER, *ON_SEAT, "factors", "temperature", "push", "plant")
"""Hooks of effects that change what the bracket is of."""


def solve(scenario: Scenario, weights: Array, hold: float, tell: Callable[[str], None]) -> Bracket:
    """Return the bracket, from the largest weight to the smallest: each bound starts from the last one's multipliers."""
    if weights.ndim != 1 or not len(weights) or not (np.isfinite(weights) & (weights > 0)).all():
        raise InputError("the weights of a bracket are one or more numbers above 0, in 1/s^4")
    problem, band = _posed(scenario, hold)
    order = np.argsort(-weights)
    lower, runs, start = np.empty(len(weights)), [], None
    for place, index in enumerate(order):
        tell(f"{scenario.title}: weight {place + 1} of {len(order)}")
        at = Problem(problem, float(weights[index]))
        run = best_run(at, band.inner)
        lower[index], start = lower_bound(at, band.outer, run.cost, start)
        runs.append(run)
    _check_speed(runs)
    back = np.argsort(order)
    return Bracket(
        weights, lower,
        np.array([np.sqrt(runs[k].acceleration) for k in back]), np.array([np.sqrt(runs[k].travel) for k in back]),
        np.array([runs[k].force for k in back]), problem.step,
    )  # fmt: skip


def _posed(scenario: Scenario, hold: float) -> tuple[Transcription, Envelope]:
    if scenario.plant is None:
        raise InputError(f"{scenario.name}: a damper bench has no seat, so it has no bracket")
    for effect in scenario.effects:
        if acts_on(type(effect), UNKNOWN):
            name = name_of("effect", type(effect))
            raise InputError(f"{scenario.title}: the bracket is of the seat without effects; leave out '{name}'")
    if not isinstance(scenario.temperature, float | int):
        raise InputError(f"{scenario.title}: the bracket needs a damper of one temperature; state it as a number")
    step = scenario.solver.step
    every = round(hold / step)
    if every < 1 or abs(every * step - hold) > 1e-9:
        raise InputError(f"hold {hold:g} s is not a multiple of solver.step {step:g} s; choose {max(1, every) * step:g} s")
    floor = scenario.excitation.floor(step, scenario.seed)
    if len(floor.acceleration) <= every:
        raise InputError(f"{scenario.title}: the floor's record is shorter than the time over which a force is held")
    with scenario.placed("damper"):
        band = envelope(scenario.damper, scenario.coil.max_current, float(scenario.temperature))
    return transcribe(scenario.plant, floor.acceleration, step, every, scenario.start), band


def _check_speed(runs: list[Run]) -> None:
    top = max(float(np.max(np.abs(run.velocity))) for run in runs)
    if top > TOP:
        raise InputError(f"the damper moves at {top:.3g} m/s; the bracket's envelope holds to {TOP:g} m/s")
