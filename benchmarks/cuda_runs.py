"""Runs on a CUDA device: `python benchmarks/cuda_runs.py [RUNS] [--duration S] [--damper NAME ...] [--compile]`.

A million runs of 10 s at 1 kHz of the seat of `ensemble.py` on a few floors, unless stated otherwise; mass, floor and
temperature differ. Of each damper are printed the seconds that the device took for all runs with their metrics, those
that it took to make scenarios, and the largest relative difference of a metric from that of a single run on the
processor, over a few of them. With `NUMBA_ENABLE_CUDASIM=1` numba simulates the device, a millisecond and more for
every step: take few runs of 0.2 s.

`--compile` needs no card: it compiles the kernels for compute capability 9.0 and prints what ptxas says of them.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import tempfile
import time
from collections.abc import Sequence
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from ensemble import SEAT
from numba import cuda

from seatsim.dampers.base import DAMPERS
from seatsim.excitations.base import Floor
from seatsim.kernel.cuda_lanes import SIGNATURE, has_device, make_kernel
from seatsim.kernel.lane_records import template_of
from seatsim.scenario.loading import load
from seatsim.scenario.scenario import Scenario
from seatsim.simulation.device import LaneRow, simulate_on_device
from seatsim.simulation.device_lanes import as_device_lane
from seatsim.simulation.runs import run_one
from seatsim.sweeps.outcome import floor_of

FLOORS, AT_ONCE, COMPARED = 8, 32_768, 16
"""Different floors; runs that are made ready together, as by the engine of a sweep; runs that are compared."""
CAPABILITY = (9, 0)


def main() -> None:
    """Measure, or compile, and print a line for every damper."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("runs", type=int, nargs="?", default=1_000_000)
    parser.add_argument("--duration", type=float, default=10.0)
    parser.add_argument("--damper", nargs="+", default=["modified_bouc_wen"], choices=DAMPERS.names(), metavar="NAME")
    parser.add_argument("--compile", action="store_true", help="compile only")
    options = parser.parse_args()
    if not options.compile and not has_device():
        parser.exit(2, "no card: there is no CUDA device that numba can use here; --compile needs none\n")
    if options.compile and not find_spec("numba_cuda"):
        parser.exit(2, 'no compiler: pip install "seatsim[cuda]"\n')
    for name in options.damper:
        if options.compile:
            _compile(name)
        else:
            _measure(name, options.runs, options.duration)


def _compile(name: str) -> None:
    """Print how long a kernel takes to compile, its registers and its local memory."""
    from cuda.pathfinder import find_nvidia_binary_utility
    from numba.cuda import dispatcher

    # Functions that a kernel calls ask for the card that they are compiled for.
    dispatcher.get_current_device = lambda: SimpleNamespace(compute_capability=CAPABILITY)
    lane = as_device_lane(0, _nominal(name, 10.0))
    assert lane is not None
    since = time.perf_counter()
    code, _ = cuda.compile_ptx(make_kernel(template_of([lane.start])), SIGNATURE, cc=CAPABILITY)
    took = time.perf_counter() - since
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "kernel.ptx"
        path.write_text(code)
        command = [find_nvidia_binary_utility("ptxas"), "-v", "-arch=sm_90", path, "-o", Path(folder) / "kernel.cubin"]
        said = subprocess.run(command, capture_output=True, text=True, check=True).stderr
    registers, stack = re.search(r"Used (\d+) registers", said), re.search(r"(\d+) bytes stack frame", said)
    assert registers and stack
    print(f"{name:34} {took:5.1f} s, {registers[1]} registers, {stack[1]} bytes of local memory", flush=True)


def _measure(name: str, runs: int, duration: float) -> None:
    nominal, rng = _nominal(name, duration), np.random.default_rng(1)
    since = time.perf_counter()
    dict(simulate_on_device([nominal], _floor))
    compiled_in, ready, device = time.perf_counter() - since, 0.0, 0.0
    worst, ended = 0.0, 0
    for first in range(0, runs, AT_ONCE):
        since = time.perf_counter()
        scenarios = [_vary(nominal, run, rng) for run in range(first, min(first + AT_ONCE, runs))]
        ready += time.perf_counter() - since
        since = time.perf_counter()
        rows = dict(simulate_on_device(scenarios, _floor))
        device += time.perf_counter() - since
        ended += len(rows)
        if first == 0:
            worst = _compare(scenarios[:COMPARED], rows)
    print(
        f"{name:34} {runs} runs of {duration:g} s, {ended} to their end: {device:.2f} s with metrics,"
        f" {ready:.2f} s to make scenarios, {compiled_in:.1f} s for the first; largest difference {worst:.0e}",
        flush=True,
    )


def _nominal(name: str, duration: float) -> Scenario:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "seat.yaml"
        path.write_text(SEAT.replace("duration: 10.0", f"duration: {duration}"))
        nominal = load(path)[0]
    return replace(nominal, damper=replace(nominal.damper, record=DAMPERS.find(name)()))


def _vary(nominal: Scenario, run: int, rng: np.random.Generator) -> Scenario:
    assert nominal.plant is not None
    plant = nominal.plant._replace(driver_mass=float(rng.uniform(50.0, 110.0)))
    return replace(nominal, seed=run % FLOORS, plant=plant, temperature=float(rng.uniform(10.0, 70.0)))


def _floor(scenario: Scenario) -> Floor:
    floor = floor_of(scenario)
    assert floor is not None
    return floor


def _compare(scenarios: Sequence[Scenario], rows: dict[int, LaneRow]) -> float:
    """Return the largest relative difference of a metric from that of a run by itself; the residual is rounding."""
    worst = 0.0
    for place, scenario in enumerate(scenarios):
        if place in rows:
            alone, found = run_one(scenario).metrics, rows[place].metrics
            assert alone.keys() == found.keys()
            differences = [
                abs(found[name].value - alone[name].value) / max(abs(alone[name].value), 1e-30)
                for name in alone
                if name != "energy_residual"
            ]
            worst = max(worst, *differences)
    return worst


if __name__ == "__main__":
    main()
