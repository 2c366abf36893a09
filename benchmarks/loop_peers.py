"""A step of the compiled loop beside the same run in C and with `scipy`: `python benchmarks/loop_peers.py`.

60 s at 1 kHz of the seat in `seat_run.py`, with the law sampled every 5 ms. `loop.c` runs seatsim's algorithm and must
agree with it before anything is timed; `lean.c` is a plain Runge-Kutta loop. A method of `solve_ivp`, with its
right-hand side compiled by numba, is timed over 2 s at its loosest tolerance that is at least as accurate as seatsim.
An error is the largest over the channels, rms of the difference to a tight solution over rms of that. Last comes a step
with every damper. A line has the least of several times, taken in turns, and its ratio to that of seatsim.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

import ivp
import numpy as np
from c_loop import native_run
from seat_run import make_floor, make_setup, prepare_run

from seatsim.dampers.base import DAMPERS
from seatsim.kernel.loop_data import CHANNELS
from seatsim.schema.arrays import Array

AGREEMENT = {"loop.c": 1e-7, "lean.c": 1e-2}
"""Largest difference of a channel from seatsim's, over its largest value.

A force that comes close to the wanted one only where it turns is flat there, so that rounding moves the current of
loop.c; lean.c integrates the current numerically.
"""
REFERENCE: tuple[ivp.MethodName, float] = "DOP853", 1e-11
METHODS: dict[ivp.MethodName, tuple[float, ...]] = {
    "RK45": (1e-3, 1e-4, 1e-5, 1e-6, 1e-7),
    "DOP853": (1e-3, 1e-4, 1e-5, 1e-6, 1e-7),
    "LSODA": (1e-5, 1e-6, 1e-7),
}
"""Relative tolerances that are tried of each method, the loosest first."""
DURATION, SOLVED, SAMPLE_EVERY, REPEATS = 60.0, 2.0, 5, 7
"""Simulated seconds of seatsim and of C, those of a general solver, steps between samples of the law, times taken."""
Channels = Mapping[str, Array]


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description="a step of the compiled loop beside peers")
    parser.add_argument("--dampers", nargs="*", choices=DAMPERS.names(), default=DAMPERS.names(), metavar="MODEL")
    options = parser.parse_args()
    acceleration, setup = make_floor(DURATION), make_setup(SAMPLE_EVERY)
    run, history = prepare_run(acceleration, setup)
    with tempfile.TemporaryDirectory() as folder:
        for source, permitted in AGREEMENT.items():
            native, channels = native_run(source, Path(folder), acceleration, setup)
            native()
            check_agreement(channels, history, permitted)
            show(source, native, run, len(acceleration))
    measure_solvers()
    for name in options.dampers:
        show(name, prepare_run(acceleration, make_setup(SAMPLE_EVERY, DAMPERS.find(name)()))[0], run, len(acceleration))


def check_agreement(channels: Channels, history: Array, permitted: float) -> None:
    """Stop where a channel differs from that of seatsim by more than is permitted: nothing is timed then."""
    for name, values in channels.items():
        ours = history[:, CHANNELS.index(name)]
        difference = np.nanmax(np.abs(values - ours)) / max(1e-9, np.nanmax(np.abs(ours)))
        if not difference <= permitted:
            raise SystemExit(f"{name} differs by {difference:.1e} of its largest value; nothing was timed")


def measure_solvers() -> None:
    """Print the line of each method of `solve_ivp`."""
    acceleration = make_floor(SOLVED)
    method, rtol = REFERENCE
    exact = ivp.make_solver(method)(rtol, acceleration, SAMPLE_EVERY)
    run, history = prepare_run(acceleration, make_setup(SAMPLE_EVERY))
    permitted = _error({name: history[::SAMPLE_EVERY, CHANNELS.index(name)] for name in exact}, exact)
    for name, tolerances in METHODS.items():
        for rtol in tolerances:
            solve = partial(ivp.make_solver(name), rtol, acceleration, SAMPLE_EVERY)
            if _error(solve(), exact) <= permitted:
                show(f"{name}, rtol {rtol:.0e}", solve, run, len(acceleration))
                break


def _error(channels: Channels, exact: Channels) -> float:
    """Return the largest ratio of the rms error of a channel to its rms value."""
    return max(float(np.sqrt(np.mean((channels[n] - exact[n]) ** 2) / np.mean(exact[n] ** 2))) for n in exact)


def show(what: str, run: Callable[[], object], beside: Callable[[], object], steps: int) -> None:
    """Print what a step of `run` costs, and its ratio to one of `beside`; both are timed in turns."""
    least = [float("inf")] * 2
    for _ in range(REPEATS):
        for place, each in enumerate((run, beside)):
            start = time.perf_counter()
            each()
            least[place] = min(least[place], time.perf_counter() - start)
    print(f"{what:34} {1e9 * least[0] / steps:10.4g} ns a step {least[0] / least[1]:9.3g} x seatsim", flush=True)


if __name__ == "__main__":
    main()
