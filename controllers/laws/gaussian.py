"""Laws on estimated states: LQG, and the clipped-optimal control that switches the current by the measured force."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from pydantic import Field

from controllers.optimal.kalman import AT_REST, KalmanFilter, Noise, correct, design_kalman_filter, dot, predict
from controllers.optimal.regulator import QuadraticWeights, solve_regulator
from seatsim.rig.coil import Coil
from seatsim.rig.control import Measurement, State, law
from seatsim.rig.plant import Plant
from seatsim.schema.fields import param


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
