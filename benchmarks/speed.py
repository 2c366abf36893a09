"""Speed of a run beside hand-written C and `scipy.integrate.solve_ivp`: `python benchmarks/speed.py`.

60 s at 1 kHz of the seat in `seat_run.py`, with the law sampled every 1 ms and every 5 ms. Repeats are
interleaved, so that a busy machine slows all alike; ratios are of medians, those in brackets of minima. Beside C
a ratio above 1 means that seatsim is the slower one; beside `solve_ivp` it says how many times faster seatsim is.
loop.c runs seatsim's algorithm and must agree with it before anything is timed; lean.c is a plain Runge-Kutta
loop. An error is the largest over the channels, rms of the difference to a tight solution over rms of that.
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
from native import available, native_run
from seat_run import STEP, floor, seatsim_run, setup

from seatsim.kernel.channels import CHANNELS

AGREEMENT = {"loop.c": 1e-9, "lean.c": 1e-2}
"""Largest difference of a channel from seatsim's, over its largest value; lean.c integrates the current numerically."""
REFERENCE = ivp.IntegrationMethod("DOP853", 1e-11)
METHODS: dict[ivp.MethodName, tuple[float, ...]] = {
    "RK23": (1e-4, 1e-5, 1e-6),
    "RK45": (1e-3, 1e-4, 1e-5, 1e-6, 1e-7),
    "DOP853": (1e-3, 1e-4, 1e-5, 1e-6, 1e-7),
    "LSODA": (1e-5, 1e-6, 1e-7),
    "Radau": (1e-4, 1e-5, 1e-6),
}
"""Relative tolerances that are tried of each method, the loosest first."""
Times = dict[str, list[float]]


def main() -> None:
    """Measure and print both tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--repeats", type=int, default=31, help="interleaved repeats of seatsim and C")
    parser.add_argument("--duration", type=float, default=3.0, help="simulated seconds of a solve_ivp run")
    options = parser.parse_args()
    if available():
        for sample_every in (1, 5):
            beside_c(sample_every, options.repeats)
    else:
        print("no gcc on this machine: the comparison with C is left out")
    for sample_every in (1, 5):
        beside_scipy(sample_every, options.duration)


def beside_c(sample_every: int, repeats: int) -> None:
    """Print what a step costs in seatsim and in C."""
    acceleration, parts = floor(60.0), setup(sample_every)
    run, history = seatsim_run(acceleration, parts)
    run()
    runs = {"seatsim": run}
    with tempfile.TemporaryDirectory() as folder:
        for source, permitted in AGREEMENT.items():
            runs[source], channels = native_run(source, Path(folder), acceleration, parts)
            runs[source]()
            agree(source, channels, history, permitted)
        times = interleaved(runs, repeats)
    seatsim = times.pop("seatsim")
    print(f"law every {sample_every} ms, {repeats} repeats: seatsim {cost(seatsim, acceleration):.1f} ns a step")
    for name, series in times.items():
        print(f"  {name} {cost(series, acceleration):.1f} ns a step, seatsim / {name} {ratio(seatsim, series)}")


def agree(source: str, channels: Mapping[str, np.ndarray], history: np.ndarray, permitted: float) -> None:
    """Print the largest difference between C and seatsim, and stop where it is not permitted."""
    worst = 0.0
    for name, values in channels.items():
        ours = history[:, CHANNELS.index(name)]
        worst = max(worst, float(np.nanmax(np.abs(values - ours)) / max(1e-9, np.nanmax(np.abs(ours)))))
    print(f"{source} agrees with seatsim within {worst:.1e} of each channel's largest value")
    if not worst <= permitted:
        raise SystemExit(f"{source} must agree within {permitted:g}: nothing was timed")


def interleaved(runs: Mapping[str, Callable[[], object]], repeats: int) -> Times:
    """Return the wall-clock times in s of each run, taken in turns."""
    times: Times = {name: [] for name in runs}
    for _ in range(repeats):
        for name, run in runs.items():
            start = time.perf_counter()
            run()
            times[name].append(time.perf_counter() - start)
    return times


def cost(series: list[float], acceleration: np.ndarray) -> float:
    """Return the median cost of a step in ns."""
    return float(np.median(series)) / len(acceleration) * 1e9


def ratio(above: list[float], below: list[float]) -> str:
    """Return the ratio of medians, and that of minima in brackets."""
    return f"{np.median(above) / np.median(below):.2f} ({min(above) / min(below):.2f})"


def beside_scipy(sample_every: int, duration: float) -> None:
    """Print how many times longer `solve_ivp` takes where it is as accurate as seatsim's default step.

    seatsim is timed on 60 s, `solve_ivp` on the first `duration` seconds; both count per simulated second.
    """
    acceleration = floor(duration)
    compiled, plain = ivp.compiled_model(), ivp.plain_model()
    ivp.simulate(compiled, REFERENCE, acceleration[:11], sample_every)
    exact = ivp.simulate(compiled, REFERENCE, acceleration, sample_every)
    run, history = seatsim_run(acceleration, setup(sample_every))
    run()
    ours = error({name: history[::sample_every, CHANNELS.index(name)] for name in exact}, exact)
    full = floor(60.0)
    runs: dict[str, Callable[[], object]] = {"seatsim": seatsim_run(full, setup(sample_every))[0]}
    for method, reached in accurate(compiled, acceleration, sample_every, exact, ours):
        for kind, model in (("numba", compiled), ("Python", plain)):
            label = f"{method.name} rtol {method.rtol:.0e}, right-hand side in {kind}, error {reached:.1e}"
            runs[label] = partial(ivp.simulate, model, method, acceleration, sample_every)
    times = interleaved(runs, 3)
    seatsim = np.median(times.pop("seatsim")) / (STEP * (len(full) - 1))
    print(f"law every {sample_every} ms: seatsim {seatsim:.6f} s a simulated second, error {ours:.1e}")
    for label, series in sorted(times.items(), key=lambda item: min(item[1])):
        each = np.median(series) / duration
        print(f"  {each:6.3f} s a simulated second, {each / seatsim:6.0f} x seatsim: {label}")


def accurate(
    model: ivp.Model, acceleration: np.ndarray, sample_every: int, exact: Mapping[str, np.ndarray], permitted: float
) -> list[tuple[ivp.IntegrationMethod, float]]:
    """Return the loosest setting of each method that is at least as accurate as permitted, with its error."""
    found = []
    for name, tolerances in METHODS.items():
        for rtol in tolerances:
            method = ivp.IntegrationMethod(name, rtol)
            reached = error(ivp.simulate(model, method, acceleration, sample_every), exact)
            if reached <= permitted:
                found.append((method, reached))
                break
    return found


def error(channels: Mapping[str, np.ndarray], exact: Mapping[str, np.ndarray]) -> float:
    """Return the largest ratio of the rms error of a channel to its rms value."""
    return max(float(np.sqrt(np.mean((channels[n] - exact[n]) ** 2) / np.mean(exact[n] ** 2))) for n in exact)


if __name__ == "__main__":
    main()
