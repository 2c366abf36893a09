"""The brackets of some runs' rigs, from whichever plug-in gives them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from seatsim.metrics.arrays import ratio
from seatsim.schema.errors import InputError
from seatsim.schema.registry import find
from seatsim.simulation.result import Run


class Distance(NamedTuple):
    """Where a run stands: Wk-weighted RMS acceleration in m/s^2, RMS travel in m; at that travel the bracket's ends.

    `bound` and `best` are in m/s^2, `above_bound` and `above_best` the run's acceleration over them, less 1. NaN where
    the travel is shorter than that of any run of the bracket.
    """

    acceleration: float
    travel: float
    bound: float
    best: float
    above_bound: float
    above_best: float


def distance(run: Run, bracket: Any) -> Distance:
    """Return how far a run is from the bracket of its rig."""
    acceleration = run.metrics["driver_acceleration_weighted"].value
    travel = run.metrics["suspension_displacement_rms"].value
    bound, best = float(bracket.bound(travel)), float(bracket.best(travel))
    return Distance(acceleration, travel, bound, best, ratio(acceleration, bound) - 1, ratio(acceleration, best) - 1)


def beaten(runs: Sequence[Run], found: Mapping[str, Any]) -> list[str]:
    """Return a sentence for each run below the bound of its rig: the bracket's damper has no memory."""
    below = [
        run for run in runs if run.scenario.rig in found and distance(run, found[run.scenario.rig]).above_bound < 0
    ]
    return [
        f"{run.scenario.title} is below its bound, which holds for dampers without memory: in so short strokes the"
        " damper hardly yields"
        for run in below
    ]


def brackets(runs: Sequence[Run], progress: Callable[[str], None]) -> Iterator[tuple[str, Any]]:
    """Yield the bracket of each rig with its `Scenario.rig`, or the InputError that says why it has none."""
    kind: Any = find("bracket", "clairvoyant")
    for rig, scenario in {run.scenario.rig: run.scenario for run in runs}.items():
        try:
            yield rig, kind.of(scenario, progress)
        except InputError as error:
            yield rig, error
