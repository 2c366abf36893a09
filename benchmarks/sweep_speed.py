"""What a sweep costs beside the runs in it: `python benchmarks/sweep_speed.py [RUNS]` (10 000 by default).

Runs of 10 s at 1 kHz of the H-infinity seat of `road-d` and its two passive variants, with drawn masses and
stiffnesses. Each line is of a process of its own: the compiled loop alone; every run with its set-up and metrics on a
floor that is at hand; sweeps on one and on two threads. Given are the time of processors and on the clock for each run,
and the largest memory. On a machine that others use the times of processors are what can be compared.
"""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from seatsim.kernel.loop import run_loop
from seatsim.metrics import summarise
from seatsim.scenario.scenario import Scenario
from seatsim.simulation import simulate as simulation
from seatsim.simulation.validity import list_ranges_left
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
SAMPLE, LOOPS = 900, 90
"""Runs over which the cost of one is averaged, and runs whose arguments are kept for calls of the loop alone."""


def main() -> None:
    """Measure each in a process of its own."""
    runs = sys.argv[1] if len(sys.argv) > 1 else "10000"
    print(f"{'':28}{'processors':>12}{'clock':>12}{'memory':>12}")
    for what in ("loop", "run", "sweep-1", "sweep-2"):
        subprocess.run([sys.executable, __file__, runs, what], check=True)


def measure(what: str, runs: int) -> None:
    """Measure one thing and print a line."""
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
            work = lambda: execute(prepared, Path(name) / "out", LocalEngine(jobs))  # noqa: E731
        clock, processors = time.perf_counter(), time.process_time()
        work()
        clock, processors = time.perf_counter() - clock, time.process_time() - processors
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    times = f"{1e3 * processors / runs:9.3f} ms{1e3 * clock / runs:9.3f} ms"
    print(f"{what + f', {runs} runs':28}{times}{memory:8.0f} MiB", flush=True)


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
    if len(sys.argv) > 2:
        measure(sys.argv[2], int(sys.argv[1]))
    else:
        main()
