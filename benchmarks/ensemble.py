"""Cost of a step in lanes and in single runs, of every damper: `python benchmarks/ensemble.py [DAMPER ...]`.

Runs of 10 s at 1 kHz of a seat on a road of class C under static output feedback, sampled every 5 ms, with inverse and
coil; mass, road and temperature differ. Of each damper at its defaults are printed: the compiled loops alone, per step
of a lane and of a single run; the processor time of a whole run with its metrics; and the largest relative difference
of a metric. Where that is above 1e-9 a single run differs as much from one whose mass has another last digit.
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from seatsim.dampers.base import DAMPERS
from seatsim.kernel.lane_records import LANES
from seatsim.metrics import Metric
from seatsim.scenario.loading import load
from seatsim.scenario.scenario import Scenario
from seatsim.schema.errors import RunError
from seatsim.simulation import ensemble, simulate
from seatsim.simulation.runs import run_one

RUNS, STEPS = 4 * LANES, 10_000
SEAT = """
plant: {frame_mass: 20.0, driver_mass: 80.0, suspension_stiffness: 4600.0, suspension_damping: 150.0,
        cushion_stiffness: 60000.0, cushion_damping: 1500.0, travel: [-0.05, 0.05]}
damper: {model: modified_bouc_wen}
actuator: {rate: 130.0, max_current: 1.0}
temperature: 20.0
controller: {law: static_output_feedback, gain: [2.0, 2147.6], sample_time: 0.005}
excitation: {kind: road, road_class: C, speed: 36.0, duration: 10.0}
"""


def main() -> None:
    """Measure and print a line for every damper."""
    spent: list[float] = []
    for module in (ensemble, simulate):
        timed: Any = module
        timed.compiled = _timed(timed.compiled, spent)
    for name in sys.argv[1:] or DAMPERS.names():
        scenarios = _vary(DAMPERS.find(name))
        rows, of_lanes, lane_run = _measure(ensemble.simulate_ensemble, scenarios, spent)
        alone, of_steps, single_run = _measure(_run_all, scenarios, spent)
        lane, step = of_lanes / LANES / STEPS * 1e9, of_steps / STEPS * 1e9
        print(
            f"{name:30} lane {lane:7.1f} ns, single {step:7.1f} ns, ratio {lane / step:.2f};"
            f" run {lane_run * 1e3:5.2f} ms, single {single_run * 1e3:5.2f} ms, ratio {lane_run / single_run:.2f};"
            f" largest difference {_difference(rows, alone):.0e}",
            flush=True,
        )


def _timed(compiled: Callable[..., Callable[..., object]], spent: list[float]) -> Callable[..., Callable[..., object]]:
    """Return `compiled` such that what it returns adds the processor time of each call to `spent`."""

    def timed(function: Callable[..., object], parts: Sequence[type]) -> Callable[..., object]:
        run = compiled(function, parts)

        def call(*arguments: object) -> object:
            start = time.process_time()
            result = run(*arguments)
            spent.append(time.process_time() - start)
            return result

        return call

    return timed


def _vary(damper: type) -> list[Scenario]:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "seat.yaml"
        path.write_text(SEAT)
        nominal = load(path)[0]
    nominal = replace(nominal, damper=replace(nominal.damper, record=damper()))
    assert nominal.plant is not None
    rng = np.random.default_rng(1)
    return [
        replace(
            nominal,
            seed=seed,
            plant=nominal.plant._replace(driver_mass=float(rng.uniform(50.0, 110.0))),
            temperature=float(rng.uniform(10.0, 70.0)),
        )
        for seed in range(RUNS)
    ]


def _run_all(scenarios: Sequence[Scenario]) -> list[ensemble.Row]:
    return [run_one(scenario).metrics for scenario in scenarios]


def _measure(
    run: Callable[[Sequence[Scenario]], list[ensemble.Row]], scenarios: Sequence[Scenario], spent: list[float]
) -> tuple[list[ensemble.Row], float, float]:
    """Return the rows, the least processor time of a call of the compiled loop and that of a whole run in s."""
    run(scenarios)  # compiles
    spent.clear()
    start = time.process_time()
    rows = run(scenarios)
    return rows, min(spent), (time.process_time() - start) / len(scenarios)


def _difference(rows: Sequence[ensemble.Row], others: Sequence[ensemble.Row]) -> float:
    """Return the largest relative difference of a metric; residuals of the energy are differences already."""
    return max(
        abs(one[name].value - other[name].value) / max(abs(other[name].value), 1e-30)
        for one, other in zip(map(_metrics, rows), map(_metrics, others), strict=True)
        for name in other
        if name != "energy_residual"
    )


def _metrics(row: ensemble.Row) -> dict[str, Metric]:
    if isinstance(row, RunError):
        raise SystemExit(str(row))
    return row


if __name__ == "__main__":
    main()
