"""The predictive law: the regulator where nothing limits it, the true optimum under limits, its time counted."""

import numpy as np
from scipy.linalg import solve_discrete_are
from scipy.optimize import lsq_linear

import seatsim
from controllers.laws.model_predictive import DeliverableForces, Planner
from controllers.optimal import QuadraticWeights
from seatsim.rig.plant import state_space, zero_order_hold

from .records import SEAT

SAMPLE_TIME, HORIZON = 0.005, 20
STATES = np.random.default_rng(5).standard_normal((40, 4)) * [0.02, 0.2, 0.003, 0.1]


def planner(**envelope):
    return Planner(SEAT, QuadraticWeights(), DeliverableForces(**envelope), HORIZON, SAMPLE_TIME)


def regulator():
    s, w = state_space(SEAT), QuadraticWeights()
    flow, push = zero_order_hold(s.A, s.B2, SAMPLE_TIME)
    z = s.C1 * [[w.travel], [w.acceleration]]
    p = solve_discrete_are(flow, push, z.T @ z, [[w.force**2]])
    gain = -np.linalg.solve(push.T @ p @ push + w.force**2, push.T @ p @ flow)[0]
    return flow, push, z, p, gain


def test_without_limits_it_is_the_discrete_regulator(conform):
    free = planner(soft_viscous=-1e6, soft_yield=-1e6, stiff_viscous=1e6, stiff_yield=1e6, pre_yield=1e-9)
    gain = regulator()[-1]
    deviation = max(abs(free.force(state) - gain @ state) / max(abs(gain @ state), 500.0) for state in STATES)
    claim = "predictive law without limits, greatest relative deviation of the force"
    conform(claim, "scipy, discrete Riccati equation", deviation, tolerance=1e-3)


def test_a_plan_is_optimal_within_the_limits_of_its_last_pass():
    made, (_, _, z, p, _) = planner(), regulator()
    root = np.kron(np.eye(HORIZON), np.vstack([z, np.zeros((2, 4))]))
    root[-4:, -4:] = np.linalg.cholesky(p).T
    effort = QuadraticWeights().force
    for state in STATES[:8]:
        first = made.plan(state)
        low, high = made.limits(state, made.plan(state, passes=1))
        a = np.vstack([root @ made.forced, effort * np.eye(HORIZON)])
        b = -np.concatenate([root @ made.free @ state, np.zeros(HORIZON)])
        best = lsq_linear(a, b, (low, high + 1e-9), tol=1e-12).x
        cost = [float(np.sum((a @ forces - b) ** 2)) for forces in (first, best)]
        assert cost[0] <= cost[1] * (1 + 1e-3) + 1e-9


def test_the_compiled_loop_calls_the_solver_on_sensors_and_counts_its_time(kept_seat_file):
    settings = {
        "controller": {"law": "mpc", "sample_time": 0.005, "sensors": {"acceleration_noise": 0.05}},
        "excitation": {"kind": "road", "road_class": "D", "speed": 12.0, "duration": 2.0},
    }
    run, again = (seatsim.run(kept_seat_file, settings).runs[0] for _ in range(2))
    assert np.nanmax(np.abs(run["wanted_force"])) > 1.0
    np.testing.assert_array_equal(run["driver_acceleration"], again["driver_acceleration"])
    (note,) = run.history.notes
    assert "in the median" in note and "5 ms between samples" in note
