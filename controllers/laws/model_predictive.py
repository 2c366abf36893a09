"""Model predictive control without preview: a quadratic programme at every sample, solved by OSQP."""

from __future__ import annotations

import itertools
from typing import Annotated, NamedTuple

import numpy as np
from numba import objmode
from pydantic import Field

from controllers.optimal.kalman import AT_REST, KalmanFilter, Noise, correct, design_kalman_filter, predict
from controllers.optimal.planner import DeliverableForces, Planner
from controllers.optimal.regulator import QuadraticWeights
from seatsim.compilation.jit import jit
from seatsim.rig.coil import Coil
from seatsim.rig.control import Measurement, State, law
from seatsim.rig.plant import Plant
from seatsim.schema.fields import param

# Compiled code can hold no Python object: the law carries a number, under which its planner waits here until the notes.
_planners: dict[int, Planner] = {}
_numbers = itertools.count()


def plan_force(number: int, x: float, v: float, xc: float, vc: float) -> float:
    """Return the force in N that a planner wants in a state."""
    return _planners[number].force(np.array([x, v, xc, vc]))


@jit
def ask_planner(number: int, x: State) -> float:
    """Return the same to compiled code."""
    with objmode(force="float64"):
        force = plan_force(number, x[0], x[1], x[2], x[3])
    return force


class PlannedForce(NamedTuple):
    """Compiled form of the law, which knows its planner by number; its state is the predicted state of the seat."""

    number: int
    kalman_filter: KalmanFilter
    sample_time: float

    def wanted_force(self, y: Measurement, state: State) -> float:
        """Return the wanted damper force in N."""
        return ask_planner(self.number, correct(self.kalman_filter, y, state))

    def update(self, y: Measurement, state: State) -> State:
        """Return the prediction for the next sample."""
        return predict(self.kalman_filter, y, state)

    def notes(self) -> tuple[str, ...]:
        """Return what the run's user is told of the time that the programmes took, and let the planner go."""
        times = 1e3 * np.array(_planners.pop(self.number).times)
        return (
            f"mpc: a sample's programme took {np.median(times):.2f} ms in the median, {np.max(times):.2f} ms at most;"
            f" there are {1e3 * self.sample_time:g} ms between samples",
        )


@law("mpc", initial=AT_REST, source="textbook model predictive control, condensed; semi-active limits derived here")
class ModelPredictive(NamedTuple):
    """MPC: the first of `horizon` forces with the least cost of driver acceleration, travel and force, within limits.

    The forces lie in the `envelope` of the damper at the velocities of a first plan, so that none is driven. The state
    comes from the Kalman filter of `lqg`; the floor's acceleration is predicted to be zero. How long the programmes
    took stands in the run's notes. See `controllers.optimal.planner`.
    """

    horizon: Annotated[int, param("samples", "number of samples that are planned", low=1, high=200)] = 20
    weights: Annotated[QuadraticWeights, Field(description="weights of the cost")] = QuadraticWeights()
    envelope: Annotated[DeliverableForces, Field(description="forces that the damper can deliver")] = (
        DeliverableForces()
    )
    noise: Annotated[Noise, Field(description="what the Kalman filter takes for noise")] = Noise()

    def sampled(self, plant: Plant, coil: Coil, sample_time: float) -> PlannedForce:
        """Return the compiled form for a plant and a sample time."""
        number = next(_numbers)
        _planners[number] = Planner(plant, self.weights, self.envelope, self.horizon, sample_time)
        return PlannedForce(number, design_kalman_filter(plant, self.noise, sample_time), sample_time)
