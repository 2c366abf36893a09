"""From a scenario to the performance bounds of its seat, damper and floor, as curves over travel."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from controllers.clairvoyant.bound import TOP, DamperEnvelope, LowerBound, find_lower_bound, fit_envelope
from controllers.clairvoyant.problem import ClairvoyantRun, HeldForceProblem, Transcription, transcribe
from controllers.clairvoyant.recursion import ForceBand
from seatsim.effects.base import ON_DAMPER, ON_SEAT, acts_on
from seatsim.rig.drivers import SINGLE_MASS
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.content import Unwritten, written
from seatsim.schema.errors import InputError
from seatsim.schema.registry import name_of, register

# Most passes. The proximity grows from next to nothing to where no force changes any more, and the search ends.
PASSES = 80
_FIRST_PROXIMITY, _LAST_PROXIMITY, _SETTLED = 1e-13, 1e-7, 1e-7  # of the criterion, 1/N^2


def find_best_run(problem: HeldForceProblem, band: ForceBand, start: Array | None = None) -> ClairvoyantRun:
    """Return a locally best run under forces between the lines, from the law `start`, or from the weakest damper.

    From a run, the law that is best where every interval stays on what sets its force (a line of the damper,
    standstill, or nothing) follows from one Riccati recursion. The seat is then run under what the damper delivers of
    that law: where the wanted force cannot be had, the closest one, which is the best for the cost-to-go. Intervals
    change sides by themselves. Repeated, with a growing proximity term to the last forces where a pass does not
    improve. The idea: control-limited differential dynamic programming, Tassa, Mansard and Todorov 2014 (ICRA), with
    limits here that depend on the state.
    """
    gain = np.zeros((problem.intervals, len(problem.transcription.velocity))) if start is None else start
    best, proximity = problem.simulate(band, gain), 0.0
    for _ in range(PASSES):
        tried = problem.simulate(band, problem.improve_law(band, best, proximity))
        if tried.cost < best.cost * (1 - _SETTLED):
            best, proximity = tried, (0.2 * proximity if proximity > _FIRST_PROXIMITY else 0.0)
        elif proximity > _LAST_PROXIMITY:
            break
        else:
            proximity = max(4 * proximity, _FIRST_PROXIMITY)
    return best


WEIGHTS = tuple(float(w) ** 2 for w in np.geomspace(12.0, 150.0, 7))
"""Weights of the squared travel in 1/s^4, from a soft seat to short travel."""
_HOLD = 0.005
"""s; the force is held so long, as in a controller that samples every 5 ms."""
UNKNOWN = (*ON_DAMPER, *ON_SEAT, "factors", "temperature", "frame_force", "plant")
"""Hooks of effects that change seat, damper or floor: the bounds are of the rig without them."""


@dataclass(frozen=True)
class ClairvoyantBounds:
    """Bounds and runs of an ideal semi-active damper on one seat and floor, one for each weight; shape (K,) each.

    The criterion is J = aw^2 + weight x^2 with the RMS Wk-weighted acceleration of the driver aw in m/s^2 and the RMS
    travel x in m. No force within the damper's envelope has a J below `lower`; that of `force` (K, N), in N, held over
    `step` seconds each, has the `acceleration` and the `travel`.
    """

    weights: Array
    lower: Array
    acceleration: Array
    travel: Array
    force: Unwritten[Array]
    step: Unwritten[float]

    @property
    def reached(self) -> Array:
        """J of the runs, shape (K,)."""
        return np.asarray(self.acceleration**2 + self.weights * self.travel**2)

    @property
    @written()
    def width(self) -> Array:
        """sqrt(J reached / J bound) - 1, shape (K,): what is not known of the best damper."""
        return np.asarray(np.sqrt(self.reached / self.lower) - 1)

    def bound(self, travel: ArrayLike) -> Array:
        """Return the aw in m/s^2 below which no damper comes at an RMS travel in m; the shape of `travel`."""
        x = np.asarray(travel, dtype=np.float64)[..., None]
        return np.asarray(np.sqrt(np.maximum(0.0, np.max(self.lower - self.weights * x**2, axis=-1))))

    def best(self, travel: ArrayLike) -> Array:
        """Return the aw in m/s^2 of the runs at an RMS travel in m, linear between them; NaN short of the shortest."""
        order = np.argsort(self.travel)
        lowest = np.minimum.accumulate(self.acceleration[order])
        return np.asarray(np.interp(np.asarray(travel), self.travel[order], lowest, left=np.nan))


@register("bracket", "clairvoyant", None)
class ClairvoyantMethod:
    """The method by which `seatsim compare --bracket` computes bounds."""

    @staticmethod
    def of(scenario: Scenario, progress: Callable[[str], None]) -> ClairvoyantBounds:
        """Return the performance bounds of a scenario's seat, damper and floor."""
        return clairvoyant(scenario, progress=progress)


def clairvoyant(
    scenario: Scenario,
    weights: ArrayLike = WEIGHTS,
    hold: float = _HOLD,
    progress: Callable[[str], None] = lambda text: None,
) -> ClairvoyantBounds:
    """Return the performance bounds of a scenario's seat, damper and floor; docs/bracket.md has method and validity.

    Args:
        scenario: its law, coil rate and sample times play no part.
        weights: of the squared travel in 1/s^4, above 0.
        hold: time in s over which a force is held, a multiple of `solver.step`.
        progress: is called with what is being done.

    Raises:
        InputError: the scenario has no seat or one that is not linear, its damper is not dissipative, or a number is
            out of its range.
    """
    chosen = np.asarray(weights, dtype=np.float64)
    if chosen.ndim != 1 or not len(chosen) or not (np.isfinite(chosen) & (chosen > 0)).all():
        raise InputError("the weights of a bracket are one or more numbers above 0, in 1/s^4")
    transcription, band = _pose(scenario, hold)
    rising = np.argsort(chosen)
    found = _solve_outwards(
        [HeldForceProblem(transcription, float(weight)) for weight in chosen[rising]],
        band,
        lambda done: progress(f"{scenario.title}: bracket, weight {done} of {len(chosen)}"),
    )
    bounds, runs = zip(*(found[place] for place in np.argsort(rising)), strict=True)
    top = max(float(np.max(np.abs(run.velocity))) for run in runs)
    if top > TOP:
        raise InputError(f"the damper moves at {top:.3g} m/s; the bracket's envelope holds to {TOP:g} m/s")
    acceleration, travel = np.sqrt([(run.acceleration, run.travel) for run in runs]).T
    lower, force = np.array([bound.value for bound in bounds]), np.array([run.force for run in runs])
    return ClairvoyantBounds(chosen, lower, acceleration, travel, force, transcription.step)


Ends = tuple[LowerBound, ClairvoyantRun]


def _solve_outwards(
    problems: Sequence[HeldForceProblem], band: DamperEnvelope, progress: Callable[[int], None]
) -> dict[int, Ends]:
    """Return both ends by the place of their problem, solved from the middle weight outwards.

    Each bound starts from its neighbour's multipliers, which differ least between neighbouring weights.
    """
    middle = len(problems) // 2
    found: dict[int, Ends] = {}
    for place in sorted(range(len(problems)), key=lambda place: abs(place - middle)):
        progress(len(found) + 1)
        near = found.get(place - 1 if place > middle else place + 1)
        found[place] = _find_both_ends(problems[place], band, near[0].logarithms if near else None)
    return found


def _find_both_ends(problem: HeldForceProblem, band: DamperEnvelope, start: Array | None) -> Ends:
    """Return the bound and the better of two runs: that from the weakest damper, and that from the bound's law."""
    weakest = find_best_run(problem, band.inner)
    bound = find_lower_bound(problem, band.outer, weakest.cost, start)
    led = find_best_run(problem, band.inner, bound.gain)
    return bound, min(weakest, led, key=lambda run: run.cost)


def _pose(scenario: Scenario, hold: float) -> tuple[Transcription, DamperEnvelope]:
    """Return the linear-quadratic problem of a scenario and the forces of its damper."""
    if scenario.plant is None:
        raise InputError(f"{scenario.name}: a damper bench has no seat, so it has no bracket")
    temperature = _require_plain_rig(scenario)
    step = scenario.solver.step
    every = round(hold / step)
    if every < 1 or abs(every * step - hold) > 1e-9:
        problem = f"hold {hold:g} s is not a multiple of solver.step {step:g} s; choose {max(1, every) * step:g} s"
        raise InputError(problem)
    floor = scenario.excitation.floor(step, scenario.seed)
    if len(floor.acceleration) <= every:
        raise InputError(f"{scenario.title}: the floor's record is shorter than the time over which a force is held")
    if not floor.acceleration.any() and not any(scenario.start):
        raise InputError(f"{scenario.title}: nothing moves, so there is nothing to bracket")
    with scenario.placed("damper"):
        band = fit_envelope(scenario.damper, scenario.coil.max_current, temperature)
    return transcribe(scenario.plant, floor.acceleration, step, every, scenario.start), band


def _require_plain_rig(scenario: Scenario) -> float:
    """Return the damper's temperature in degC where seat, damper and floor are those that the bounds hold for."""
    if scenario.driver.model != SINGLE_MASS:
        raise InputError(
            f"{scenario.name}: the bracket is of a driver of one mass; run it with --set driver.model={SINGLE_MASS}"
        )
    for effect in scenario.effects:
        if acts_on(type(effect), UNKNOWN):
            name = name_of("effect", type(effect))
            raise InputError(
                f"{scenario.name}: the bracket is of the seat without effects; leave out '{name}' (--set effects=[])"
            )
    if not isinstance(scenario.temperature, float | int):
        raise InputError(f"{scenario.title}: the bracket needs a damper of one temperature; state it as a number")
    return float(scenario.temperature)
