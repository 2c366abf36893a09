"""Where the search sets out from: no gain, projected state feedback, random gains over decades, the single-step LMI."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import cycle

import numpy as np
import scipy.linalg

from controllers.synthesis.plant import Array, GeneralisedPlant

# Spread of the random gains in scaled coordinates: shallow basins lie at any of these.
_SPREADS = (1.0, 100.0, 10.0, 1000.0)
_DECADES = (-1.5, 1.5)


def starting_gains(plants: Sequence[GeneralisedPlant], seed: int) -> Iterator[Array]:
    """Yield gains (nu, ny) in scaled coordinates without end, the same ones for the same seed."""
    free = plants[0].free
    yield np.zeros(free.shape)
    yield from (gain for gain in map(projected_state_feedback, plants) if gain is not None)
    random = np.random.default_rng(seed)
    for spread in cycle(_SPREADS):
        yield spread * random.standard_normal(free.shape) * free
        # Entries over decades of their own: some valleys join large gains with small ones.
        yield random.choice([-1.0, 1.0], free.shape) * 10 ** random.uniform(*_DECADES, free.shape) * free


def convex_start(plant: GeneralisedPlant, gamma: float, deadline: float) -> Iterator[Array]:
    """Yield the gain of the single-step LMI, or nothing where it has none; `gamma` is the norm's order of magnitude."""
    from controllers.synthesis.lmi import single_step_gain

    gain = single_step_gain(plant, gamma, deadline)
    if gain is not None:
        yield gain


def projected_state_feedback(plant: GeneralisedPlant) -> Array | None:
    """Return the output feedback nearest to the linear-quadratic state feedback, K = -B2'P pinv(C2); None without P."""
    identity = np.eye(plant.order)
    try:
        P = scipy.linalg.solve_continuous_are(plant.A, plant.B2, identity, np.eye(plant.control_count))
    except np.linalg.LinAlgError:
        return None
    gain: Array = -plant.B2.T @ P @ np.linalg.pinv(plant.C2) * plant.free
    return gain
