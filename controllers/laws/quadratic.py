"""Linear-quadratic regulator on true states, without an observer."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from pydantic import Field

from controllers.optimal.regulator import QuadraticWeights, solve_regulator
from seatsim.rig.control import Measurement, State, law
from seatsim.rig.plant import Plant


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
        gain = solve_regulator(plant, self.weights)
        return StateFeedback(gain, plant.driver_mass, plant.cushion_stiffness, plant.cushion_damping)
