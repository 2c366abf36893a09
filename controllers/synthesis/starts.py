"""Where the search sets out from: no gain, projected state feedback, random gains over decades, the single-step LMI.

Random gains are drawn in the user's units and in scaled ones in turn: states and signals in units of a like size make
for short valleys, and no rule tells whose units do.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import count
from typing import NamedTuple

import numpy as np
import scipy.linalg

from controllers.synthesis.plant import GeneralisedPlant
from seatsim.schema.arrays import Array

# Spread of the random gains: shallow basins lie at any of these.
_SPREADS = (1.0, 10.0, 0.1, 100.0)
_SCALED_SPREADS = (1.0, 100.0, 10.0, 1000.0)
_DECADES = (-1.5, 1.5)


class StartingGain(NamedTuple):
    """A gain and the sizes of the first changes from it, (nu, ny) each, in scaled coordinates."""

    gain: Array
    unit: Array


def generate_starting_gains(plants: Sequence[GeneralisedPlant], unit: Array, seed: int) -> Iterator[StartingGain]:
    """Yield starts without end, the same ones for the same seed; `unit` is the user's, in scaled coordinates."""
    free = plants[0].free
    ones = np.ones(free.shape)
    yield StartingGain(np.zeros(free.shape), unit)
    yield from (StartingGain(gain, ones) for gain in map(project_state_feedback, plants) if gain is not None)
    random = np.random.default_rng(seed)
    for k in count():
        for own, spreads in ((unit, _SPREADS), (ones, _SCALED_SPREADS)):
            size = spreads[k % len(spreads)] * own
            yield StartingGain(size * random.standard_normal(free.shape) * free, size)
        # Entries over decades of their own: some valleys join large gains with small ones.
        size = (ones, unit)[k % 2] * 10 ** random.uniform(*_DECADES, free.shape)
        yield StartingGain(random.choice([-1.0, 1.0], free.shape) * size * free, size)


def generate_convex_start(
    plant: GeneralisedPlant, gamma: float, unit: Array, deadline: float
) -> Iterator[StartingGain]:
    """Yield the gain of the single-step LMI, or nothing where it has none; `gamma` is the norm's order of magnitude."""
    from controllers.synthesis.lmi import find_single_step_gain

    gain = find_single_step_gain(plant, gamma, deadline)
    if gain is not None:
        yield StartingGain(gain, unit)


def project_state_feedback(plant: GeneralisedPlant) -> Array | None:
    """Return the output feedback nearest to the linear-quadratic state feedback, K = -B2'P pinv(C2); None without P."""
    identity = np.eye(plant.order)
    try:
        P = scipy.linalg.solve_continuous_are(plant.A, plant.B2, identity, np.eye(plant.control_count))
    except np.linalg.LinAlgError:
        return None
    # u = -B2'P x is the optimum of the full state; the pseudo-inverse reads the state off y as well as y can tell.
    gain: Array = -plant.B2.T @ P @ np.linalg.pinv(plant.C2) * plant.free
    return gain
