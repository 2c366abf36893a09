"""The same run with heyoka: a Taylor method that is compiled for the model, for one run or for several side by side.

The floor has a kink every `STEP` seconds and the command a jump at each sample of the law. A Taylor method has to start
again there, so that every call from Python spans one step.
"""

from __future__ import annotations

from functools import cache, partial
from typing import Any

import numpy as np

from seatsim.benchmark import ivp
from seatsim.benchmark.seat_run import STEP, Array

STATES = ("x", "v", "xc", "vc", "y", "z", "i")
COMMAND, FLOOR, SLOPE = range(3)
"""Parameters of the model: the command in A, and offset and slope of the straight line of the floor in a step."""
SMALLER = 0.02
"""By how much the floor of each run is smaller than that of the one beside it, so that no two are the same."""


def make_solver(lanes: int) -> ivp.Simulate:
    """Return what simulates so many runs side by side, and returns the channels of the first."""
    inverse, make_integrator = ivp.compiled_model().inverse, cache(partial(_make_integrator, lanes))

    def simulate(rtol: float, acceleration: Array, sample_every: int) -> dict[str, Array]:
        integrator = make_integrator(rtol)
        _rest(integrator)
        state, given = (array.reshape(-1, lanes) for array in (integrator.state, integrator.pars))
        floors = acceleration[:, None] * (1.0 - SMALLER * np.arange(lanes))
        slopes, states = np.diff(floors, axis=0) / STEP, [np.zeros(len(STATES))]
        for step, slope in enumerate(slopes):
            if step % sample_every == 0:
                given[COMMAND] = [inverse(x, v, y, z) for x, v, _, _, y, z, _ in state.T.tolist()]
            given[FLOOR], given[SLOPE] = floors[step] - slope * step * STEP, slope
            integrator.propagate_until((step + 1) * STEP)
            if (step + 1) % sample_every == 0:
                states.append(state[:, 0].copy())
        return ivp.list_channels(np.array(states), acceleration[::sample_every])

    return simulate


def count_lanes() -> int:
    """Return how many numbers this processor calculates with at once."""
    import heyoka

    lanes: int = heyoka.recommended_simd_size()
    return lanes


def _rest(integrator: Any) -> None:
    """Set an integrator back to rest at the time 0."""
    integrator.state[:] = 0.0
    if hasattr(integrator, "set_time"):
        integrator.set_time(0.0)
    else:
        integrator.time = 0.0


def _make_integrator(lanes: int, tolerance: float) -> Any:
    """Return an integrator of the model at rest, compiled for so many runs side by side."""
    import heyoka

    def size(value: Any) -> Any:
        return heyoka.select(heyoka.gt(value, 0.0), value, -value)

    state: Any = heyoka.make_vars(*STATES)
    floor = heyoka.par[FLOOR] + heyoka.par[SLOPE] * heyoka.time
    rates: Any = ivp.rates  # its floats are expressions here
    slopes = rates(ivp.damper, size, *state, heyoka.par[COMMAND], floor)
    system = list(zip(state, slopes, strict=True))
    if lanes == 1:
        return heyoka.taylor_adaptive(system, [0.0] * len(STATES), pars=[0.0] * 3, tol=tolerance)
    return heyoka.taylor_adaptive_batch(
        system, np.zeros((len(STATES), lanes)), pars=np.zeros((3, lanes)), tol=tolerance
    )
