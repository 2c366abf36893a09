"""Linear-quadratic laws: LQR on true states, LQG on estimated ones, clipped-optimal control."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from pydantic import Field

from controllers.optimal import (
    AT_REST,
    KalmanFilter,
    Noise,
    QuadraticWeights,
    correct,
    design_kalman_filter,
    dot,
    predict,
    solve_regulator,
)
from seatsim.rig.coil import Coil
from seatsim.rig.control import Measurement, State, law
from seatsim.rig.plant import Plant
from seatsim.schema.fields import param


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


class EstimateFeedback(NamedTuple):
    """Compiled form of LQG; its state is the predicted state of the seat."""

    gain: State
    kalman_filter: KalmanFilter

    def wanted_force(self, y: Measurement, state: State) -> float:
        """Return the wanted damper force in N."""
        return dot(self.gain, correct(self.kalman_filter, y, state))

    def update(self, y: Measurement, state: State) -> State:
        """Return the prediction for the next sample."""
        return predict(self.kalman_filter, y, state)


@law("lqg", initial=AT_REST, source="textbook linear-quadratic-Gaussian control; solved by python-control and scipy")
class Lqg(NamedTuple):
    """LQG: the LQR's gain on the state that a Kalman filter estimates from x, zc'' and the damper force."""

    weights: Annotated[QuadraticWeights, Field(description="weights of the cost")] = QuadraticWeights()
    noise: Annotated[Noise, Field(description="what the Kalman filter takes for noise")] = Noise()

    def sampled(self, plant: Plant, coil: Coil, sample_time: float) -> EstimateFeedback:
        """Return the compiled form for a plant and a sample time."""
        return EstimateFeedback(
            solve_regulator(plant, self.weights), design_kalman_filter(plant, self.noise, sample_time)
        )


class SwitchedFeedback(NamedTuple):
    """Compiled form of clipped-optimal control; its state is the predicted state of the seat."""

    gain: State
    kalman_filter: KalmanFilter
    on: float

    def wanted_current(self, y: Measurement, state: State) -> float:
        """Return the commanded current in A."""
        wanted = dot(self.gain, correct(self.kalman_filter, y, state))
        return self.on if (wanted - y.damper_force) * y.damper_force > 0.0 else 0.0

    def update(self, y: Measurement, state: State) -> State:
        """Return the prediction for the next sample."""
        return predict(self.kalman_filter, y, state)


@law("clipped_optimal", initial=AT_REST, source="Dyke, Spencer, Sain and Carlson 1996, Smart Mater. Struct. 5:565")
class ClippedOptimal(NamedTuple):
    """Clipped-optimal control: `i_cmd = on` where `(Fd* - Fd) Fd > 0`, else 0, with the LQG's force Fd*.

    The current rises while the measured force Fd has the wanted one's sign and falls short of it; no damper model is
    needed for it.
    """

    weights: Annotated[QuadraticWeights, Field(description="weights of the cost")] = QuadraticWeights()
    noise: Annotated[Noise, Field(description="what the Kalman filter takes for noise")] = Noise()
    on: Annotated[float, param("A", "current that is switched", low=0, high=100)] = 1.0

    def sampled(self, plant: Plant, coil: Coil, sample_time: float) -> SwitchedFeedback:
        """Return the compiled form for a plant and a sample time."""
        gain = solve_regulator(plant, self.weights)
        return SwitchedFeedback(gain, design_kalman_filter(plant, self.noise, sample_time), self.on)
