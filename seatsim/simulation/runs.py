"""Run scenarios: one, or many side by side."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from seatsim.metrics import summarise
from seatsim.scenario.loading import load
from seatsim.scenario.scenario import Scenario
from seatsim.schema.errors import RunError, SynthesisError
from seatsim.simulation.result import Result, Run
from seatsim.simulation.simulate import simulate
from seatsim.simulation.validity import list_warnings


def run(scenario: str | Path | Scenario, settings: Mapping[str, object] | None = None) -> Result:
    """Run a scenario, or the file of one with all its variants and sweeps.

    Raises:
        InputError: the file is wrong. RunError: a run could not be carried to its end.
    """
    scenarios = [scenario] if isinstance(scenario, Scenario) else load(scenario, settings)
    return Result([run_one(one) for one in scenarios])


def compare(paths: Iterable[str | Path], settings: Mapping[str, object] | None = None) -> Result:
    """Run several files and return one result over all of them."""
    return Result([run_one(one) for path in paths for one in load(path, settings)])


def run_one(scenario: Scenario) -> Run:
    """Simulate one scenario and work out its metrics."""
    history = simulate(scenario)
    plant = scenario.plant
    metrics = summarise(
        history.channels,
        history.step,
        travel=plant.travel if plant else None,
        coil_resistance=scenario.coil.resistance,
    )
    return Run(scenario, history, metrics, list_warnings(scenario, history))


def run_many(
    scenarios: list[Scenario], done: Callable[[Scenario], None]
) -> Iterator[tuple[Scenario, Run | RunError | SynthesisError]]:
    """Run scenarios on all processors and yield each with its run or its failure, in order; `done` is called with each.

    Raises:
        InputError: a scenario turned out to be wrong.
    """

    def attempt(scenario: Scenario) -> Run | RunError | SynthesisError:
        try:
            return run_one(scenario)
        except (RunError, SynthesisError) as error:
            return error
        finally:
            done(scenario)

    pool = ThreadPoolExecutor(max_workers=os.cpu_count())
    try:
        yield from zip(scenarios, pool.map(attempt, scenarios), strict=True)
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
