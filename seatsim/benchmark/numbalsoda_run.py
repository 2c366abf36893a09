"""The same run with numbalsoda: LSODA in C++ and DOP853 in Fortran, called from compiled code with a compiled model."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba
import numpy as np

from seatsim.benchmark import ivp
from seatsim.benchmark.seat_run import STEP, Array


def make_solver(name: ivp.MethodName) -> ivp.Simulate:
    """Return what simulates the run with the method of this name, as `ivp.make_solver` does."""
    import numbalsoda

    parts = ivp.damper, ivp.rates, ivp.find_root, ivp.invert, ivp.interpolate
    force, rates, root, invert, excite = map(numba.njit, parts)

    # What the right-hand side reads stands in one array: the command, the number of samples, the floor.
    @numba.cfunc(numbalsoda.lsoda_sig)  # type: ignore[untyped-decorator]  # numba has no types
    def slope(t: float, s: Any, ds: Any, data: Any) -> None:
        floor = excite(numba.carray(data, (2 + int(data[1]),))[2:], t)
        found = rates(force, abs, s[0], s[1], s[2], s[3], s[4], s[5], s[6], data[0], floor)
        for k in range(7):
            ds[k] = found[k]

    method, address = {"LSODA": numbalsoda.lsoda, "DOP853": numbalsoda.dop853}[name], slope.address

    @numba.njit  # type: ignore[untyped-decorator]  # numba has no types
    def solve(data: Array, samples: int, sample_every: int, rtol: float) -> Array:
        states = np.zeros(((samples - 1) // sample_every + 1, 7))
        for row in range(1, len(states)):
            before = states[row - 1]
            data[0] = invert(force, root, before[0], before[1], before[4], before[5])
            times = np.array([(row - 1) * sample_every * STEP, row * sample_every * STEP])
            found, _ = method(address, before, times, data, rtol, 1e-3 * rtol)
            states[row] = found[-1]
        return states

    run: Callable[[Array, int, int, float], Array] = solve

    def simulate(rtol: float, acceleration: Array, sample_every: int) -> dict[str, Array]:
        data = np.concatenate(([0.0, len(acceleration)], acceleration))
        return ivp.list_channels(run(data, len(acceleration), sample_every, rtol), acceleration[::sample_every])

    return simulate
