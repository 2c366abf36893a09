"""Bounds on what the best damper could have done on some runs' rigs, from whichever plug-in gives them.

Plug-ins register under the kind `bracket`: a lower bound of the comfort criterion, and a run that comes close to it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple, Protocol, cast

from numpy.typing import ArrayLike

from seatsim.metrics.motion import ratio
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.content import Joined
from seatsim.schema.errors import InputError
from seatsim.schema.registry import find
from seatsim.simulation.result import Result, Run, RunName


class PerformanceBounds(Protocol):
    """Bound and reached comfort of an ideal damper on one rig, by its travel; K runs, one for each weight."""

    @property
    def acceleration(self) -> Array:
        """Wk-weighted RMS acceleration of the driver in the runs in m/s^2, shape (K,)."""

    @property
    def travel(self) -> Array:
        """RMS travel of the runs in m, shape (K,)."""

    @property
    def width(self) -> Array:
        """Relative distance between run and bound, shape (K,)."""

    def bound(self, travel: ArrayLike) -> Array:
        """Return the acceleration in m/s^2 below which no damper comes at an RMS travel in m."""

    def best(self, travel: ArrayLike) -> Array:
        """Return the acceleration in m/s^2 that an ideal damper reaches; NaN where the travel is too short."""


class _BoundsMethod(Protocol):
    """A registered way to compute performance bounds."""

    def of(self, scenario: Scenario, progress: Callable[[str], None]) -> PerformanceBounds:
        """Return the bounds of a scenario's rig; an InputError says why it has none."""


class _Distance(NamedTuple):
    """Where a run stands: Wk-weighted RMS acceleration in m/s^2, RMS travel in m; at that travel both bounds.

    `bound` and `best` are in m/s^2, `above_bound` and `above_best` the run's acceleration over them, less 1. NaN where
    the travel is shorter than that of any run of the ideal damper.
    """

    acceleration: float
    travel: float
    bound: float
    best: float
    above_bound: float
    above_best: float


def measure_distance(run: Run, bounds: PerformanceBounds) -> _Distance:
    """Return how far a run is from the performance bounds of its rig."""
    acceleration = run.metrics["driver_acceleration_weighted"].value
    travel = run.metrics["suspension_displacement_rms"].value
    bound, best = float(bounds.bound(travel)), float(bounds.best(travel))
    return _Distance(acceleration, travel, bound, best, ratio(acceleration, bound) - 1, ratio(acceleration, best) - 1)


class RunStanding(NamedTuple):
    """A run, and how far it is from the performance bounds of its rig."""

    run: Joined[RunName]
    distance: Joined[_Distance]


class RigBounds(NamedTuple):
    """The performance bounds of a rig, and where each of its runs stands."""

    bounds: Joined[PerformanceBounds]
    runs: list[RunStanding]


def place_runs(result: Result) -> list[RigBounds]:
    """Return the bounds of every rig that has some, with its runs."""
    found = []
    for rig, bounds in result.brackets.items():
        runs = [run for run in result.runs if run.scenario.rig == rig]
        found.append(RigBounds(bounds, [RunStanding(run.name, measure_distance(run, bounds)) for run in runs]))
    return found


def explain_runs_below_bound(runs: Sequence[Run], found: Mapping[str, PerformanceBounds]) -> list[str]:
    """Return a sentence for each run below the bound of its rig: the ideal damper has no hysteresis, a real one has."""
    return [
        f"{run.scenario.title} is below its bound, which holds for dampers without hysteresis: in so short strokes the"
        " damper hardly yields"
        for run in runs
        if run.scenario.rig in found and measure_distance(run, found[run.scenario.rig]).above_bound < 0
    ]


def compute_performance_bounds(
    runs: Sequence[Run], progress: Callable[[str], None]
) -> Iterator[tuple[str, PerformanceBounds | InputError]]:
    """Yield the bounds of each rig with its `Scenario.rig`, or the InputError that says why it has none.

    Runs that share seat, damper, temperature, floor and effects share a rig: its bounds are computed once, since laws
    play no part in them.
    """
    method = cast(_BoundsMethod, find("bracket", "clairvoyant"))
    for rig, scenario in {run.scenario.rig: run.scenario for run in runs}.items():
        try:
            yield rig, method.of(scenario, progress)
        except InputError as error:
            yield rig, error
