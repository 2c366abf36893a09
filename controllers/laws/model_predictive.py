"""Model predictive control without preview: at every sample OSQP plans forces over a horizon, within the damper's."""

from __future__ import annotations

import itertools
import time
from typing import Annotated, NamedTuple

import numpy as np
from numba import objmode
from pydantic import Field
from scipy.linalg import solve_discrete_are

from controllers.optimal import (
    AT_REST,
    KalmanFilter,
    Noise,
    QuadraticWeights,
    correct,
    design_kalman_filter,
    predict,
    solving,
)
from seatsim.compilation.jit import jit
from seatsim.rig.coil import Coil
from seatsim.rig.control import Measurement, State, law
from seatsim.rig.plant import Plant, state_space, zero_order_hold
from seatsim.schema.arrays import Array
from seatsim.schema.fields import param

SETTINGS = {"verbose": False, "adaptive_rho": False, "eps_abs": 1e-4, "eps_rel": 1e-4, "max_iter": 500}
"""Of OSQP: a fixed penalty, so that an answer does not depend on the machine's timing."""
_UNIT = 100.0
"""N; forces are planned in this unit, which makes the programme's numbers of order one."""
_PASSES = 2


class DeliverableForces(NamedTuple):
    """Forces that a damper can deliver at speed v: `(viscous |v| + yielding min(1, |v| / pre_yield))` in v's direction.

    From the softest to the stiffest setting. The defaults are those of the damper of `laws.yaml`, 0 A and 1 A.
    """

    soft_viscous: Annotated[float, param("N s/m", "softest viscous damping", low=0, high=1e6)] = 250.0
    soft_yield: Annotated[float, param("N", "softest yield force", low=0, high=1e6)] = 45.0
    stiff_viscous: Annotated[float, param("N s/m", "stiffest viscous damping", low=0, high=1e6)] = 600.0
    stiff_yield: Annotated[float, param("N", "stiffest yield force", low=0, high=1e6)] = 665.0
    pre_yield: Annotated[float, param("m/s", "speed at which the damper yields", above=0, high=1)] = 0.005

    def limits(self, v: Array) -> tuple[Array, Array]:
        """Return the least and the largest force in N at damper velocities, shape (N,) each."""
        size, share = np.abs(v), np.minimum(1.0, np.abs(v) / self.pre_yield)
        soft = np.sign(v) * (self.soft_viscous * size + self.soft_yield * share)
        stiff = np.sign(v) * (self.stiff_viscous * size + self.stiff_yield * share)
        return np.minimum(soft, stiff), np.maximum(soft, stiff)


class Planner:
    """Plans N forces for the sampled seat over a floor without acceleration.

        min over F   sum_j (acceleration zc''_j)^2 + (travel x_j)^2 + (force F_j)^2  + cost to go of the LQR
        subject to   F_j within the envelope at the velocity v_j of the plan before

    The first plan is the LQR's; each of `_PASSES` takes the velocities of the one before. It has no memory: the same
    state gives the same force. `times` collects the seconds that each answer took.
    """

    def __init__(
        self, plant: Plant, weights: QuadraticWeights, envelope: DeliverableForces, horizon: int, sample_time: float
    ) -> None:
        """Set up the programme for a horizon of N samples; matrices and factorisation are kept.

        Raises:
            SynthesisError: the weights are so far apart that the cost beyond the horizon is not found.
        """
        import osqp
        from scipy.sparse import csc_matrix, eye

        s = state_space(plant)
        transition, input_gain = zero_order_hold(s.A, s.B2, sample_time)
        z = s.C1 * [[weights.travel], [weights.acceleration]]
        effort = weights.force**2
        with solving("planner"):
            to_go = solve_discrete_are(transition, input_gain, z.T @ z, np.array([[effort]]))
            gain = -np.linalg.solve(input_gain.T @ to_go @ input_gain + effort, input_gain.T @ to_go @ transition)
        closed = [np.linalg.matrix_power(transition + input_gain @ gain, j) for j in range(horizon)]
        self.first = np.vstack([gain @ power for power in closed])
        self.ratio, self.envelope = plant.damper_ratio, envelope
        self.free, self.forced = _condensed(transition, input_gain, horizon)
        cost = np.kron(np.eye(horizon), z.T @ z)
        cost[-4:, -4:] = to_go
        hessian = _UNIT**2 * (self.forced.T @ cost @ self.forced + effort * np.eye(horizon))
        self.linear = _UNIT * self.forced.T @ cost @ self.free
        self.times: list[float] = []
        self.solver, wide = osqp.OSQP(), np.full(horizon, 1e6)
        upper, identity = csc_matrix(np.triu(hessian)), eye(horizon, format="csc")
        self.solver.setup(upper, np.zeros(horizon), identity, -wide, wide, **SETTINGS)

    def force(self, state: Array) -> float:
        """Return the first force in N of the plan from (x, v, zc - zs, its rate), shape (4,), and count its time."""
        begin = time.perf_counter()
        forces = self.plan(state)
        self.times.append(time.perf_counter() - begin)
        return float(forces[0])

    def plan(self, state: Array, passes: int = _PASSES) -> Array:
        """Return the planned forces in N, shape (N,)."""
        forces: Array = self.first @ state
        for _ in range(passes):
            low, high = self.limits(state, forces)
            self.solver.update(q=self.linear @ state, l=low / _UNIT, u=high / _UNIT)
            self.solver.warm_start(x=forces / _UNIT, y=np.zeros(len(forces)))
            forces = np.clip(_UNIT * self.solver.solve(raise_error=False).x, low, high)
        return forces

    def limits(self, state: Array, forces: Array) -> tuple[Array, Array]:
        """Return the least and the largest forces in N at the velocities under a plan, shape (N,) each."""
        planned: Array = self.free[1::4] @ state + self.forced[1::4] @ forces
        return self.envelope.limits(self.ratio * np.concatenate([state[1:2], planned[:-1]]))


def _condensed(transition: Array, input_gain: Array, horizon: int) -> tuple[Array, Array]:
    """Return the maps (4 N, 4) and (4 N, N) from the state and from the forces to the states at samples 1..N."""
    powers = list(itertools.accumulate([transition] * horizon, lambda power, step: step @ power, initial=np.eye(4)))
    answers, forced = np.vstack([power @ input_gain for power in powers]), np.zeros((4 * horizon, horizon))
    for k in range(horizon):
        forced[4 * k :, k] = answers[: 4 * (horizon - k), 0]
    return np.vstack(powers[1:]), forced


# Compiled code can hold no Python object: the law carries a number, under which its planner waits here until the notes.
_planners: dict[int, Planner] = {}
_numbers = itertools.count()


def _plan_force(number: int, x: float, v: float, xc: float, vc: float) -> float:
    """Return the force in N that a planner wants in a state."""
    return _planners[number].force(np.array([x, v, xc, vc]))


@jit
def ask_planner(number: int, x: State) -> float:
    """Return the same to compiled code."""
    with objmode(force="float64"):
        force = _plan_force(number, x[0], x[1], x[2], x[3])
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
    took stands in the run's notes.
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
