"""Where the search sets out from: no gain, projected state feedback, and random gains over decades."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import scipy.linalg

from controllers.synthesis.plant import Array, GeneralisedPlant

_DECADES = (-1.5, 1.5)


def starting_gains(plant: GeneralisedPlant, seed: int, count: int) -> Iterator[Array]:
    """Yield up to `count` gains (nu, ny) in scaled coordinates, the same ones for the same seed."""
    yield np.zeros(plant.free.shape)
    projected = projected_state_feedback(plant)
    if projected is not None:
        yield projected
    random = np.random.default_rng(seed)
    for _ in range(count - 2):
        size = 10 ** random.uniform(*_DECADES)
        yield size * random.standard_normal(plant.free.shape) * plant.free


def projected_state_feedback(plant: GeneralisedPlant) -> Array | None:
    """Return the output feedback nearest to the linear-quadratic state feedback: K = -B2' P pinv(C2); None where P does not exist."""
    identity = np.eye(plant.order)
    try:
        P = scipy.linalg.solve_continuous_are(plant.A, plant.B2, identity, np.eye(plant.control_count))
    except np.linalg.LinAlgError:
        return None
    gain: Array = -plant.B2.T @ P @ np.linalg.pinv(plant.C2) * plant.free
    return gain
