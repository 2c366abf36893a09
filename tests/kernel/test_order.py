"""Observed order of convergence on a smooth rig."""

import numpy as np
from scipy.integrate import solve_ivp

from seatsim.dampers.bingham import Bingham

from .references import seat
from .rigs import driven, refined, rough

COARSE = 4e-3
DAMPER = Bingham(v_ref=0.2)
CURRENT = 0.3


def exact(rows):
    """Final state by a method of order 8, restarted wherever the floor's slope changes."""

    def rates(t, s, k):
        force = (250.0 + 350.0 * CURRENT) * s[1] + (45.0 + 620.0 * CURRENT) * np.tanh(s[1] / 0.2)
        return seat.py_func(s, force, rows[k] + (rows[k + 1] - rows[k]) * (t / COARSE - k))

    s = np.zeros(4)
    for k in range(len(rows) - 1):
        span = (k * COARSE, (k + 1) * COARSE)
        s = solve_ivp(rates, span, s, args=(k,), method="DOP853", rtol=1e-12, atol=1e-15).y[:, -1]
    return s


def test_the_method_is_of_order_four(conform):
    rows = rough(1.0, COARSE, rms=10.0, seed=3)
    final = exact(rows)
    errors = []
    for times in (1, 2, 4, 8):
        fine = refined(rows, times)
        h = driven(DAMPER, fine, CURRENT, step=COARSE / times, tolerance=1e9, start_current=CURRENT)
        state = [h[f"{part}_{kind}"][-1] for part in ("suspension", "cushion") for kind in ("displacement", "velocity")]
        errors.append(np.max(np.abs((state - final) / final)))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[-1] < 1e-7
    for times, order in zip((1, 2, 4), orders, strict=True):
        claim = f"order of convergence on a smooth rig, step {COARSE / times * 1e3:g} ms against half of it"
        conform(claim, "scipy, DOP853 at 1e-12: a method of order 4", order, 4.0, tolerance=0.25)


def test_the_tolerance_bounds_the_error_where_the_step_is_too_long(conform):
    rows = rough(1.0, COARSE, rms=10.0, seed=3)
    final = exact(rows)[:2]
    for tolerance in (1e-3, 1e-5, 1e-7):
        h = driven(DAMPER, rows, CURRENT, step=COARSE, tolerance=tolerance, start_current=CURRENT)
        state = [h["suspension_displacement"][-1], h["suspension_velocity"][-1]]
        error = np.max(np.abs((state - final) / final))
        claim = f"steps of 4 ms, tolerance {tolerance:g}: relative error of the state after 1 s"
        conform(claim, "scipy, DOP853 at 1e-12", error, tolerance=10 * tolerance)
