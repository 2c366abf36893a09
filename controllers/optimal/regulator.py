"""Linear-quadratic regulator: full state feedback that trades the driver's acceleration against travel and force.

A Riccati equation that has no solution in double precision is one clear error.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated, NamedTuple

import numpy as np

from seatsim.rig.control import State
from seatsim.rig.plant import Plant, state_space
from seatsim.schema.errors import SynthesisError
from seatsim.schema.fields import param


@contextmanager
def solving(what: str) -> Iterator[None]:
    """Raise SynthesisError where the equation of `what`, which is solved meanwhile, has no solution in numbers.

    Its weights, or its noise, then lie so many orders of magnitude apart that an eigenvalue is lost in rounding.
    """
    try:
        yield
    except (np.linalg.LinAlgError, ValueError) as error:
        raise SynthesisError(
            f"the Riccati equation of the {what} has no solution in numbers ({error}); choose values of its weights or"
            " of its noise that are less far apart"
        ) from error


class QuadraticWeights(NamedTuple):
    """Weights of `J = integral of (acceleration zc'')^2 + (travel x)^2 + (force Fd)^2 dt`."""

    travel: Annotated[float, param("1/s^2", "weight of the suspension displacement", above=0, high=1e6)] = 20.0
    acceleration: Annotated[float, param("-", "weight of the driver's acceleration", low=0, high=1e6)] = 1.0
    force: Annotated[float, param("1/kg", "weight of the damper force", above=0, high=1e3)] = 7e-3


def solve_regulator(plant: Plant, weights: QuadraticWeights) -> State:
    """Return the gain k of `Fd = k . (x, v, zc - zs, its rate)` that minimises the cost, from the Riccati equation.

    Raises:
        SynthesisError: the weights are so far apart that it has no solution in numbers.
    """
    import control

    s = state_space(plant)
    z = s.C1 * [[weights.travel], [weights.acceleration]]
    with solving("regulator"):
        gain, _, _ = control.lqr(s.A, s.B2, z.T @ z, np.array([[weights.force**2]]))
    return tuple(-float(value) for value in gain[0])
