"""What a sweep costs beside the runs in it, and how it grows: `python benchmarks/sweep_speed.py [RUNS] [--plot FILE]`.

Runs of 10 s at 1 kHz of the H-infinity seat of `road-d` and its two passive variants, with drawn masses and
stiffnesses. Each line is of a process of its own: the compiled loop alone; every run with its set-up and metrics on a
floor that is at hand; a sweep of RUNS runs (10 000 by default), one at once; sweeps of 100, 300, 1000, ... up to RUNS
runs, two at once. Given are the time of processors and on the clock for each run, and the largest memory of all
processes together. The time of the latter is then fitted by `start + runs * each`. On a machine that others use the
times of processors are what can be compared.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from seatsim.kernel.loop import run_loop
from seatsim.metrics import summarise
from seatsim.scenario.scenario import Scenario
from seatsim.simulation import simulate as simulation
from seatsim.simulation.validity import list_ranges_left
from seatsim.sweeps.engines.base import KEEP_FREED_MEMORY
from seatsim.sweeps.engines.local import LocalEngine
from seatsim.sweeps.execute import execute, prepare

SWEEP = """\
scenario: road-d
design: lhs
runs: {runs}
vary:
  excitation.duration: [10.0]
  plant.driver_mass: {{normal: [80, 12], low: 50, high: 120}}
  plant.suspension_stiffness: {{uniform: [4000, 5200]}}
"""
VARIANTS = 3
SIZES = (100, 300, 1000, 3000, 10_000, 30_000)
SAMPLE, LOOPS = 900, 90
"""Runs over which the cost of one is averaged, and runs whose arguments are kept for calls of the loop alone."""


class Cost(NamedTuple):
    """Times of processors and on the clock in s of so many runs, and the largest memory in MiB."""

    runs: int
    processors: float
    clock: float
    memory: float


def main() -> None:
    """Measure each in a process of its own, and fit a line to the sweeps."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("runs", nargs="?", type=int, default=10_000)
    parser.add_argument("--plot", type=Path, help="draw the time and memory of the sweeps over their runs")
    parser.add_argument("--measure", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.measure:
        print(json.dumps(measure(options.measure, options.runs)._asdict()))
        return
    print(f"{'':28}{'processors':>12}{'clock':>12}{'memory':>12}")
    for what in ("loop", "run", "sweep-1"):
        show(what, options.runs)
    sizes = [size for size in SIZES if size < options.runs] + [options.runs]
    costs = [show("sweep-2", size) for size in sizes]
    spent = np.array([cost.processors for cost in costs])
    each, start = np.polyfit(sizes, spent, 1, w=1 / spent)
    worst = np.max(np.abs(start + each * np.array(sizes) - spent) / spent)
    print(f"processors: {start:.2f} s + {1e3 * each:.3f} ms a run, within {100 * worst:.0f} % of each sweep")
    if options.plot:
        plot(costs, start, each, options.plot)


def show(what: str, runs: int) -> Cost:
    """Measure one thing in a process of its own, print a line, and return its cost."""
    command = [sys.executable, __file__, str(runs), "--measure", what]
    # What the runs alone would cost without this is another matter than what a sweep adds.
    environment = os.environ | KEEP_FREED_MEMORY
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, env=environment)
    cost = Cost(**json.loads(done.stdout))
    times = f"{1e3 * cost.processors / cost.runs:9.3f} ms{1e3 * cost.clock / cost.runs:9.3f} ms"
    print(f"{what + f', {cost.runs} runs':28}{times}{cost.memory:8.0f} MiB", flush=True)
    return cost


def measure(what: str, runs: int) -> Cost:
    """Measure one thing in this process and those that it starts."""
    with tempfile.TemporaryDirectory() as name:
        file = Path(name) / "sweep.yaml"
        file.write_text(SWEEP.format(runs=-(-runs // VARIANTS)), encoding="utf-8")
        prepared = prepare(file)
        if what in ("loop", "run"):
            runs = min(prepared.plan.runs, SAMPLE)
            scenarios = [prepared.plan.scenario(number) for number in range(runs)]
            work = prepare_loops(scenarios) if what == "loop" else lambda: run_all(scenarios)
            run_all(scenarios[:VARIANTS])
        else:
            runs, jobs = prepared.plan.runs, int(what.partition("-")[2])
            work = partial(execute, prepared, Path(name) / "out", LocalEngine(jobs))
        clock, processors = time.perf_counter(), time_of_processors()
        work()
        clock, processors = time.perf_counter() - clock, time_of_processors() - processors
    usages = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return Cost(runs, processors, clock, sum(usage.ru_maxrss for usage in usages) / 1024)


def time_of_processors() -> float:
    """Return the time of processors of this process and of those that have ended, in s."""
    times = os.times()
    return sum(times[:4])


def plot(costs: Sequence[Cost], start: float, each: float, file: Path) -> None:
    """Draw time of processors and memory over runs, with the fitted line."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7, 6), layout="constrained")
    time_axes, memory_axes = figure.subplots(2, 1, sharex=True)
    runs = [cost.runs for cost in costs]
    time_axes.loglog(runs, [cost.processors for cost in costs], "o", label="measured")
    time_axes.loglog(runs, [start + each * count for count in runs], label=f"{start:.2f} s + {1e3 * each:.3f} ms a run")
    time_axes.set_ylabel("time of processors [s]")
    time_axes.legend()
    memory_axes.semilogx(runs, [cost.memory for cost in costs], "o-")
    memory_axes.set(xlabel="runs", ylabel="memory [MiB]", ylim=(0, None))
    figure.savefig(file)


def prepare_loops(scenarios: list[Scenario]) -> Callable[[], object]:
    """Return what calls the compiled loop alone, with all of its arguments at hand."""
    calls: list[Callable[[], object]] = []
    compiled = simulation.__dict__["compiled"]

    def record(function: object, parts: object) -> Callable[..., object]:
        loop = compiled(run_loop, parts)

        def call(*arguments: object) -> object:
            calls.append(lambda: loop(*arguments))
            return loop(*arguments)

        return call

    simulation.__dict__["compiled"] = record
    for scenario in scenarios[:LOOPS]:
        simulation.simulate(scenario)
    simulation.__dict__["compiled"] = compiled
    return lambda: [calls[number % LOOPS]() for number in range(len(scenarios))]


def run_all(scenarios: list[Scenario]) -> None:
    """Simulate scenarios on the floor of the first, which all share, and work out their metrics."""
    first = scenarios[0]
    floor = first.excitation.floor(first.solver.step, first.seed)
    for scenario in scenarios:
        history = simulation.simulate(scenario, floor)
        travel = scenario.plant.travel if scenario.plant else None
        summarise(history.channels, history.step, travel=travel, coil_resistance=scenario.coil.resistance)
        list_ranges_left(scenario, history)


if __name__ == "__main__":
    main()
