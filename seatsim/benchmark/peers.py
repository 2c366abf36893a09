"""A run beside the same run in C and with general solvers of differential equations.

60 s at 1 kHz of the seat in `seat_run.py`, with the law sampled every 5 ms. `loop.c` runs seatsim's algorithm and must
agree with it before anything is timed; `lean.c` is a plain Runge-Kutta loop. An error is the largest over the channels,
rms of the difference to a tight solution over rms of that.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path

import numpy as np

from seatsim.benchmark import ivp
from seatsim.benchmark.measurement import Cost, compare_least, time_in_turns
from seatsim.benchmark.native import native_run
from seatsim.benchmark.seat_run import Array, make_floor, make_setup, prepare_run
from seatsim.kernel.channels import CHANNELS
from seatsim.schema.errors import RunError
from seatsim.schema.leftovers import temporary_folder

AGREEMENT = {"loop.c": 1e-7, "lean.c": 1e-2}
"""Largest difference of a channel from seatsim's, over its largest value.

A force that comes close to the wanted one only where it turns is flat there, so that rounding moves the current of
loop.c; lean.c integrates the current numerically.
"""
REFERENCE: tuple[ivp.MethodName, float] = "DOP853", 1e-11
METHODS: dict[str, tuple[float, ...]] = {
    "RK45": (1e-3, 1e-4, 1e-5, 1e-6, 1e-7),
    "DOP853": (1e-3, 1e-4, 1e-5, 1e-6, 1e-7),
    "LSODA": (1e-5, 1e-6, 1e-7),
    "Taylor": (1e-3, 1e-4, 1e-5, 1e-6, 1e-7),
}
"""Relative tolerances that are tried of each method, the loosest first."""
DURATION, SOLVED, SAMPLE_EVERY = 60.0, 2.0, 5
"""Simulated seconds of a run of seatsim and of C, those of a general solver, and steps between samples of the law."""
Channels = Mapping[str, Array]


def measure_c() -> Iterator[Cost]:
    """Yield what a step costs in C, beside a step of seatsim.

    Raises:
        RunError: C and seatsim disagree, so that nothing is timed.
    """
    acceleration, setup = make_floor(DURATION), make_setup(SAMPLE_EVERY)
    run, history = prepare_run(acceleration, setup)
    runs = {"seatsim": run}
    with temporary_folder() as folder:
        for source, permitted in AGREEMENT.items():
            runs[source], channels = native_run(source, Path(folder), acceleration, setup)
            runs[source]()
            _check_agreement(source, channels, history, permitted)
        times = time_in_turns(runs, 11)
    for name in AGREEMENT:
        yield _compare(name, times[name], times["seatsim"], acceleration)


def _check_agreement(source: str, channels: Channels, history: Array, permitted: float) -> None:
    for name, values in channels.items():
        ours = history[:, CHANNELS.index(name)]
        difference = np.nanmax(np.abs(values - ours)) / max(1e-9, np.nanmax(np.abs(ours)))
        if not difference <= permitted:
            raise RunError(f"{source}: {name} differs by {difference:.1e} of its largest value; nothing was timed")


def measure_scipy() -> Iterator[Cost]:
    """Yield what `scipy.integrate.solve_ivp` costs with a right-hand side in numba, beside seatsim."""
    yield from _measure_solver({name: ivp.make_solver(name) for name in ("RK45", "DOP853", "LSODA")})


def measure_numbalsoda() -> Iterator[Cost]:
    """Yield what numbalsoda costs, beside seatsim."""
    from seatsim.benchmark.numbalsoda_run import make_solver

    yield from _measure_solver({name: make_solver(name) for name in ("LSODA", "DOP853")})


def measure_heyoka() -> Iterator[Cost]:
    """Yield what heyoka costs for one run, and for each of as many as the processor calculates at once."""
    from seatsim.benchmark.heyoka_run import count_lanes, make_solver

    for lanes in (1, count_lanes()):
        yield from _measure_solver({"Taylor": make_solver(lanes)}, lanes)


def _measure_solver(solver: Mapping[str, ivp.Simulate], at_once: int = 1) -> Iterator[Cost]:
    """Yield what each method costs at its loosest tolerance that is at least as accurate as seatsim's default step.

    The costs are those of one of the runs that are simulated `at_once`.
    """
    acceleration = make_floor(SOLVED)
    exact = solve_tightly(acceleration)
    run, history = prepare_run(acceleration, make_setup(SAMPLE_EVERY))
    permitted = _error({name: history[::SAMPLE_EVERY, CHANNELS.index(name)] for name in exact}, exact)
    for name, simulate in solver.items():
        for rtol in METHODS[name]:
            solve = partial(simulate, rtol, acceleration, SAMPLE_EVERY)
            if _error(solve(), exact) <= permitted:
                times = time_in_turns({"solver": solve, "seatsim": run}, 3)
                what = f"{name}, rtol {rtol:.0e}" + (f", {at_once} at once" if at_once > 1 else "")
                each = [t / at_once for t in times["solver"]]
                yield _compare(what, each, times["seatsim"], acceleration)
                break


def solve_tightly(acceleration: Array) -> dict[str, Array]:
    """Return the channels of a solution that is far more accurate than any that is timed."""
    method, rtol = REFERENCE
    return ivp.make_solver(method)(rtol, acceleration, SAMPLE_EVERY)


def _compare(what: str, times: list[float], ours: list[float], acceleration: Array) -> Cost:
    return compare_least(what, times, "ns a step", 1e9 / len(acceleration), "a step of seatsim", ours)


def _error(channels: Channels, exact: Channels) -> float:
    """Return the largest ratio of the rms error of a channel to its rms value."""
    return max(float(np.sqrt(np.mean((channels[n] - exact[n]) ** 2) / np.mean(exact[n] ** 2))) for n in exact)
