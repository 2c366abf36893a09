"""How the cost of a run grows with its length, and falls with more processors and on a cluster."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path

from seatsim.benchmark.measurement import Cost, compare_least, time_in_turns
from seatsim.scenario.loading import load
from seatsim.scenario.scenario import Scenario
from seatsim.schema.leftovers import temporary_folder
from seatsim.simulation.runs import run_one
from seatsim.sweeps.engines.choice import open_engine
from seatsim.sweeps.execute import execute, prepare

LENGTHS, REPEATS = (1.0, 10.0, 100.0), 5
RUNS = 1000
"""Points of the sweep on several processors: enough that the start of a process does not count."""
SWEEP = """\
scenario: em5
design: lhs
runs: {runs}
vary:
  excitation.duration: [10.0]
  plant.driver_mass: {{uniform: [50, 110]}}
"""


def measure_lengths() -> Iterator[Cost]:
    """Yield what a step costs in runs of several lengths, floor and metrics included, beside the shortest run."""
    scenarios = {f"run of {length:g} s": load_seat(length) for length in LENGTHS}
    for scenario in scenarios.values():
        run_one(scenario)
    times = time_in_turns({name: partial(run_one, scenario) for name, scenario in scenarios.items()}, REPEATS)
    steps = {name: [t / length for t in times[name]] for name, length in zip(times, LENGTHS, strict=True)}
    first = next(iter(steps))
    for name, series in steps.items():
        yield compare_least(name, series, "ns a step", 1e6, f"a step of a {first}", steps[first])


def measure_cores() -> Iterator[Cost]:
    """Yield what a run of a sweep costs on one processor and on all, beside one."""
    one = time_sweep("local", 1)
    for jobs in (1, os.cpu_count() or 1):
        each = one if jobs == 1 else time_sweep("local", jobs)
        yield Cost(f"{jobs} at once", each, "ms a run", each / one, "one at once")


def measure_dask() -> Iterator[Cost]:
    """Yield what a run of a sweep costs on an embedded cluster of all processors, beside the local engine."""
    jobs = os.cpu_count() or 1
    local = time_sweep("local", jobs)
    each = time_sweep("dask", jobs)
    yield Cost("dask", each, "ms a run", each / local, f"engine local, {jobs} at once")


def load_seat(duration: float) -> Scenario:
    """Return the seat of the example `em5` under output feedback, for a run of so many seconds."""
    return load("em5", {"excitation.duration": duration})[0]


def time_sweep(engine: str, jobs: int) -> float:
    """Return the time on the clock for each run of a sweep in ms, once the engine is there."""
    with temporary_folder() as name:
        file = Path(name) / "sweep.yaml"
        file.write_text(SWEEP.format(runs=RUNS), encoding="utf-8")
        prepared = prepare(file)
        with open_engine(engine, jobs, None) as carry_out:
            start = time.perf_counter()
            execute(prepared, Path(name) / "out", carry_out)
            return 1e3 * (time.perf_counter() - start) / prepared.plan.runs
