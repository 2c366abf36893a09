"""Linear-quadratic regulator: full state feedback that trades the driver's acceleration against travel and force."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from pydantic import Field

from seatsim.rig.control import Measurement, law
from seatsim.rig.plant import Plant, state_space
from seatsim.schema.fields import param

State = tuple[float, ...]


class QuadraticWeights(NamedTuple):
    """Weights of `J = integral of (acceleration zc'')^2 + (travel x)^2 + (force Fd)^2 dt`."""

    travel: Annotated[float, param("1/s^2", "weight of the suspension displacement", above=0, high=1e6)] = 20.0
    acceleration: Annotated[float, param("-", "weight of the driver's acceleration", low=0, high=1e6)] = 1.0
    force: Annotated[float, param("1/kg", "weight of the damper force", above=0, high=1e3)] = 7e-3


def state_feedback(plant: Plant, weights: QuadraticWeights) -> State:
    """Return the gain k of `Fd = k . (x, v, zc - zs, its rate)` that minimises the cost, from the Riccati equation."""
    import control

    s = state_space(plant)
    z = s.C1 * [[weights.travel], [weights.acceleration]]
    gain, _, _ = control.lqr(s.A, s.B2, z.T @ z, np.array([[weights.force**2]]))
    return tuple(-float(value) for value in gain[0])


class StateFeedback(NamedTuple):
    """Compiled form of the law: the cushion's strain comes from the force that accelerates the driver."""

    gain: State
    driver_mass: float
    cushion_stiffness: float
    cushion_damping: float

    def wanted_force(self, y: Measurement, state: State) -> float:
        """Return the wanted damper force in N."""
        k, vc = self.gain, y.driver_velocity - y.frame_velocity
        xc = -(self.driver_mass * y.driver_acceleration + self.cushion_damping * vc) / self.cushion_stiffness
        return k[0] * y.displacement + k[1] * y.velocity + k[2] * xc + k[3] * vc


@law("lqr", source="textbook linear-quadratic regulator; solved by python-control")
class Lqr(NamedTuple):
    """LQR: wanted force `Fd = k . (x, v, xc, vc)` with the gain that minimises `weights`' cost on the linear seat.

    No observer: `vc = zc' - zs'`, and `xc = -(m zc'' + cc vc) / kc` by the driver's equation of motion.
    """

    weights: Annotated[QuadraticWeights, Field(description="weights of the cost")] = QuadraticWeights()

    def prepared(self, plant: Plant) -> StateFeedback:
        """Return the compiled form for a plant."""
        gain = state_feedback(plant, self.weights)
        return StateFeedback(gain, plant.driver_mass, plant.cushion_stiffness, plant.cushion_damping)
