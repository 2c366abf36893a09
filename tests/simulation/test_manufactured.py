"""A manufactured solution of the whole rig: the forces that a chosen motion needs give that motion back."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from seatsim.excitations.base import Floor
from seatsim.scenario.loading import single
from seatsim.scenario.scenario import Solver
from seatsim.simulation.inputs import Forces
from seatsim.simulation.simulate import simulate

DURATION, CURRENT, RATIO, RISE = 0.8, 0.6, 0.7, 600.0
EFFECTS = [{"effect": "suspension.progressive_spring", "parameters": {"rise": RISE}}]


def chosen(t):
    """Suspension x, v, a, cushion xc, vc, ac and floor acceleration, all at rest at first."""
    p, q = 2 * np.pi * 1.4, 2 * np.pi * 3.7
    x, v, a = 0.01 * (1 - np.cos(p * t)), 0.01 * p * np.sin(p * t), 0.01 * p**2 * np.cos(p * t)
    xc, vc, ac = 0.002 * (1 - np.cos(q * t)), 0.002 * q * np.sin(q * t), 0.002 * q**2 * np.cos(q * t)
    return x, v, a, xc, vc, ac, 2.0 * np.sin(2 * np.pi * 2.3 * t)


def damper_force(scenario, t):
    """Force of the Bouc-Wen damper in N under the chosen motion, and the coil's current in A, solved apart."""
    p, rate = scenario.damper.record, scenario.coil.rate

    def slope(t, z):
        v = RATIO * chosen(t)[1]
        return p.A * v - p.beta * v * np.abs(z) ** p.n - p.gamma * np.abs(v) * z * np.abs(z) ** (p.n - 1)

    z = solve_ivp(slope, (0.0, DURATION), [0.0], "LSODA", t, rtol=1e-10, atol=1e-12, max_step=1e-3).y[0]
    i = CURRENT * (1 - np.exp(-rate * t))
    return (p.c_a + p.c_b * i) * RATIO * chosen(t)[1] + (p.alpha_a + p.alpha_b * i) * z, i


def error(scenario, step):
    """Largest error of the driver's acceleration in m/s^2, the travel in m, the current in A; and of the energy."""
    t = step * np.arange(round(DURATION / step) + 1)
    x, v, a, xc, vc, ac, floor = chosen(t)
    plant = scenario.plant
    force, current = damper_force(scenario, t)
    cushion = plant.cushion_stiffness * xc + plant.cushion_damping * vc
    suspension = plant.suspension_stiffness * x * (1 + RISE * x**2) + plant.suspension_damping * v + RATIO * force
    on_driver = plant.driver_mass * (a + ac + floor) + cushion
    forces = Forces(plant.frame_mass * (a + floor) + suspension - cushion, on_driver)
    h = simulate(replace(scenario, solver=Solver(step, 1e-7)), Floor(step, floor, 0 * t, 0 * t), forces)
    work = h["energy_floor"] - sum(h[f"energy_{part}"] for part in ("damper", "suspension", "cushion", "stored"))
    names = ("driver_acceleration", "suspension_displacement", "coil_current")
    errors = [h[name] - exact for name, exact in zip(names, (a + ac + floor, x, current), strict=True)]
    return [np.max(np.abs(each)) for each in (*errors, work / np.max(np.abs(h["energy_floor"])))]


def test_the_chosen_motion_is_met_and_steps_converge(seat_file, conform):
    settings = {"controller": {"law": "constant", "current": CURRENT}, "plant.damper_ratio": RATIO, "effects": EFFECTS}
    scenario = single(seat_file, settings)
    coarse, fine = error(scenario, 1e-3), error(scenario, 2.5e-4)
    # Inputs are straight lines between samples, which is exact to the second order.
    names = ("acceleration of the driver, m/s^2", "displacement, m", "current, A", "balance of energy, share")
    for name, found, tolerance in zip(names, fine, (2e-3, 2e-7, 1e-12, 1e-6), strict=True):
        claim = f"whole rig at 0.25 ms, greatest error: {name}"
        conform(claim, "manufactured solution", found, tolerance=tolerance)
    assert fine[0] < coarse[0] / 12 and fine[1] < coarse[1] / 12
    assert coarse[2] == pytest.approx(0.0, abs=1e-12)
