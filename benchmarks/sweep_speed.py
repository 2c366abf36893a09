"""What a sweep costs beside the runs in it: `python benchmarks/sweep_speed.py [RUNS]` (10 000 by default).

Runs of 10 s at 1 kHz of the H-infinity seat of `road-d`, with drawn masses and stiffnesses. Each figure is of a process
of its own: the compiled loop alone, the loop with its set-up, floor and metrics as every run has them, then sweeps on one
and on two threads, with the time on the clock, the time of processors and the largest memory. On a machine that others use
the times of processors are what can be compared.
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
from seatsim.sweeps.engines.threads import ThreadEngine
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
SAMPLE = 1000
"""Runs over which the cost of one is averaged."""


def main() -> None:
    """Measure each in a process of its own."""
    runs = sys.argv[1] if len(sys.argv) > 1 else "10000"
    print(f"{'':28}{'processors':>12}{'clock':>12}{'memory':>12}")
    for what in ("loop", "run", "warm", "sweep-1", "sweep-2", "sweep-1", "sweep-2"):
        subprocess.run([sys.executable, __file__, runs, what], check=True)


def measure(what: str, runs: int) -> None:
    """Measure one thing and print a line."""
    with tempfile.TemporaryDirectory() as name:
        file = Path(name) / "sweep.yaml"
        file.write_text(SWEEP.format(runs=200 if what == "warm" else runs), encoding="utf-8")
        prepared = prepare(file)
        if what in ("loop", "run"):
            runs = min(runs, SAMPLE)
            scenarios = [prepared.plan.scenario(number) for number in range(runs)]
            work = prepare_loops(scenarios) if what == "loop" else lambda: run_all(scenarios)
            run_all(scenarios[:2])
        else:
            jobs = int(what.partition("-")[2] or 1)
            work = lambda: execute(prepared, Path(name) / "out", ThreadEngine(jobs))  # noqa: E731
        clock, processors = time.perf_counter(), time.process_time()
        work()
        clock, processors = time.perf_counter() - clock, time.process_time() - processors
    if what != "warm":
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        print(f"{what + f', {runs} runs':28}{1e3 * processors / runs:9.3f} ms{1e3 * clock / runs:9.3f} ms{memory:8.0f} MiB",
              flush=True)  # fmt: skip


def prepare_loops(scenarios: list[Scenario]) -> Callable[[], object]:
    """Return what calls the compiled loop alone, with all of its arguments at hand."""
    calls: list[tuple[object, ...]] = []
    whole = simulation.compiled

    def record(function: object, parts: object) -> Callable[..., object]:
        loop: Callable[..., object] = whole(run_loop, parts)  # type: ignore[arg-type]
        return lambda *arguments: (calls.append((loop, *arguments)), loop(*arguments))[1]

    simulation.compiled = record  # type: ignore[assignment]
    for scenario in scenarios[:100]:
        simulation.simulate(scenario)
    simulation.compiled = whole
    repeated = [calls[number % len(calls)] for number in range(len(scenarios))]
    return lambda: [loop(*arguments) for loop, *arguments in repeated]  # type: ignore[operator]


def run_all(scenarios: list[Scenario]) -> None:
    """Simulate scenarios on the floor of the first, which all share, and work out their metrics."""
    first = scenarios[0]
    floor = first.excitation.floor(first.solver.step, first.seed)
    for scenario in scenarios:
        history = simulation.simulate(scenario, floor)
        travel = scenario.plant.travel if scenario.plant else None
        summarise(history.channels, history.step, travel=travel, coil_resistance=scenario.coil.resistance)


if __name__ == "__main__":
    if len(sys.argv) > 2:
        measure(sys.argv[2], int(sys.argv[1]))
    else:
        main()
