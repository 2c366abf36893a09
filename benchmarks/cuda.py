"""Runs on a CUDA device: `python benchmarks/cuda.py RUNS [--duration S] [--damper NAME ...]`.

Runs at 1 kHz of the seat of `ensemble.py` on a few floors; mass, floor and temperature differ. Of each damper are
printed the seconds that the device took for all runs with their metrics, those that it took to make them ready, and the
largest relative difference of a metric from that of a single run on the processor, over a few of them. With
`NUMBA_ENABLE_CUDASIM=1` numba simulates the device, some milliseconds for every step: take few runs of 0.2 s.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from ensemble import SEAT

from seatsim.dampers.base import DAMPERS
from seatsim.excitations.base import Floor
from seatsim.scenario.loading import load
from seatsim.scenario.scenario import Scenario
from seatsim.simulation.device import LaneRow, simulate_on_device
from seatsim.simulation.runs import run_one
from seatsim.sweeps.outcome import floor_of

FLOORS, AT_ONCE, COMPARED = 8, 100_000, 16
"""Different floors; runs that are made ready together, as by the engine of a sweep; runs that are compared."""


def main() -> None:
    """Measure and print a line for every damper."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("runs", type=int)
    parser.add_argument("--duration", type=float, default=10.0)
    parser.add_argument("--damper", nargs="+", default=["modified_bouc_wen"], choices=DAMPERS.names(), metavar="NAME")
    options = parser.parse_args()
    for name in options.damper:
        _measure(name, options.runs, options.duration)


def _measure(name: str, runs: int, duration: float) -> None:
    nominal, rng = _nominal(name, duration), np.random.default_rng(1)
    since = time.perf_counter()
    if not dict(simulate_on_device([nominal], _floor)):
        print(f"{name:30} is not simulated on the device")
        return
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
        f"{name:30} {runs} runs of {duration:g} s, {ended} to their end: {device:.2f} s with metrics,"
        f" {ready:.2f} s to make scenarios, {compiled_in:.1f} s to compile; largest difference {worst:.0e}",
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
