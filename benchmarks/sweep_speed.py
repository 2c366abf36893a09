"""What a sweep costs beside the runs in it, and how that grows.

    python benchmarks/sweep_speed.py [RUNS] [--growth]

Runs of 10 s at 1 kHz of the H-infinity seat of `road-d` and its two passive variants, with drawn masses and
stiffnesses. Measured are, in one process, three times, runs without an engine, from their drawn values to their
metrics, a sweep of RUNS runs (10 000 by default), one at once, and the runs again; then two at once.
Given are the time of processors and on the clock for each run, and the largest memory of all processes together. What a
sweep adds is the median of the three, since a machine that others use is now faster, now slower.

With `--growth` are measured instead sweeps of 100, 300, 1000, ... up to RUNS runs, two at once, and their reports. The
times of the sweeps are fitted by `start + runs * each`.
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
from collections.abc import Callable
from functools import partial
from pathlib import Path
from statistics import median
from typing import NamedTuple

import numpy as np

from seatsim.cli.outputs.simulated import write_sweep_report
from seatsim.sweeps.engines import LocalEngine, simulate_one
from seatsim.sweeps.execute import execute, prepare
from seatsim.sweeps.plan import Plan

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
SIZES = (100, 300, 1000, 3000, 10_000, 30_000, 100_000)
SAMPLE, ROUNDS = 2400, 3
"""Runs over which the cost of one is averaged, and how often a sweep is compared with its runs."""


class Cost(NamedTuple):
    """Times of processors and on the clock in s of so many runs, and the largest memory in MiB."""

    runs: int
    processors: float
    clock: float
    memory: float


def main() -> None:
    """Measure each in a process of its own, and compare."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("runs", nargs="?", type=int, default=10_000)
    parser.add_argument("--growth", action="store_true", help="measure how time and memory grow instead")
    parser.add_argument("--measure", help=argparse.SUPPRESS)
    parser.add_argument("--folder", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.measure:
        costs = measure(options.measure, options.runs, options.folder)
        print(json.dumps({name: cost._asdict() for name, cost in costs.items()}))
        return
    print(f"{'':28}{'processors':>12}{'clock':>12}{'memory':>12}")
    if options.growth:
        show_growth(options.runs)
    else:
        compare_parts(options.runs)


def compare_parts(runs: int) -> None:
    """Print what a sweep adds to its runs, and what a second processor gives."""
    added = []
    for _ in range(ROUNDS):
        before, one, after = show("runs-and-sweep", runs)
        alone = 0.5 * (before.processors / before.runs + after.processors / after.runs)
        added.append(100 * (one.processors / one.runs / alone - 1))
    (two,) = show("sweep-2", runs)
    print(f"a sweep adds {median(added):.1f} % to its runs ({', '.join(f'{share:.1f}' for share in added)});"
          f" two at once do {one.clock / two.clock:.2f} times as many as one")  # fmt: skip


def show_growth(runs: int) -> None:
    """Print what sweeps of more and more runs cost, and a line through their times."""
    sweeps = []
    for size in [size for size in SIZES if size < runs] + [runs]:
        with tempfile.TemporaryDirectory() as folder:
            sweeps += show("sweep-2", size, folder)
            show("report", size, folder)
    sizes, clocks = np.array([cost.runs for cost in sweeps]), np.array([cost.clock for cost in sweeps])
    each, start = np.polyfit(sizes, clocks, 1, w=1 / clocks)
    worst = np.max(np.abs(start + each * sizes - clocks) / clocks)
    print(f"clock: {start:.2f} s + {1e3 * each:.3f} ms a run, within {100 * worst:.0f} % of each sweep")


def show(what: str, runs: int, folder: str | None = None) -> list[Cost]:
    """Measure in a process of its own, print a line for each part, and return their costs."""
    command = [sys.executable, __file__, str(runs), "--measure", what, *(["--folder", folder] if folder else [])]
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
    costs = {name: Cost(**cost) for name, cost in json.loads(done.stdout).items()}
    for name, cost in costs.items():
        times = f"{1e3 * cost.processors / cost.runs:9.3f} ms{1e3 * cost.clock / cost.runs:9.3f} ms"
        print(f"{name + f', {cost.runs} runs':28}{times}{cost.memory:8.0f} MiB", flush=True)
    return list(costs.values())


def measure(what: str, runs: int, folder: Path | None) -> dict[str, Cost]:
    """Measure parts in this process and those that it starts; a folder keeps the sweep for its report."""
    with tempfile.TemporaryDirectory() as name:
        file, out = Path(name) / "sweep.yaml", (folder or Path(name)) / "out"
        file.write_text(SWEEP.format(runs=-(-runs // VARIANTS)), encoding="utf-8")
        prepared = prepare(file)
        runs, few = prepared.plan.runs, min(prepared.plan.runs, SAMPLE)
        if what == "report":
            return {what: cost_of(runs, partial(write_sweep_report, out, out))}
        # What loads what is compiled is left out, as it is the same for any number of runs.
        run_all(prepared.plan, VARIANTS)
        if what == "sweep-2":
            return {what: cost_of(runs, partial(execute, prepared, out, LocalEngine(2)))}
        return {
            "runs": cost_of(few, partial(run_all, prepared.plan, few)),
            "sweep-1": cost_of(runs, partial(execute, prepared, out, LocalEngine(1))),
            "runs again": cost_of(few, partial(run_all, prepared.plan, few)),
        }


def cost_of(runs: int, work: Callable[[], object]) -> Cost:
    """Carry out work and return what it costs; processors of processes that have ended count."""
    clock, processors = time.perf_counter(), sum(os.times()[:4])
    work()
    clock, processors = time.perf_counter() - clock, sum(os.times()[:4]) - processors
    usages = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return Cost(runs, processors, clock, sum(usage.ru_maxrss for usage in usages) / 1024)


def run_all(plan: Plan, runs: int) -> None:
    """Carry out the first runs of a plan one after the other, from their values to their outcomes."""
    for number in range(runs):
        simulate_one(plan, number, number, None)


if __name__ == "__main__":
    main()
