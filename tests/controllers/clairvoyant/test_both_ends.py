"""The clairvoyant bracket: both ends against independent answers, and against the laws."""

import dataclasses

import numpy as np
import pytest

import seatsim
from controllers.clairvoyant import ClairvoyantBounds, clairvoyant
from controllers.clairvoyant.bound import find_lower_bound
from controllers.clairvoyant.envelope import fit_envelope
from controllers.clairvoyant.feasible import find_best_run
from controllers.clairvoyant.problem import HeldForceProblem
from controllers.clairvoyant.recursion import ForceBand
from controllers.clairvoyant.transcription import transcribe
from seatsim.metrics.comfort import weighted_rms
from seatsim.schema.errors import InputError
from seatsim.simulation.inputs import Forces
from seatsim.simulation.simulate import simulate

LAWS = {
    "H-infinity": {"controller": {"law": "static_output_feedback", "gain": [2.0, 2147.6], "sample_time": 0.005}},
    "skyhook": {"controller": {"law": "skyhook", "damping": 2000.0, "sample_time": 0.005}},
    "soft": {"controller": {"law": "constant", "current": 0.0}},
    "hard": {"controller": {"law": "constant", "current": 1.0}},
}
BAND = ForceBand(c=250.0, f=45.0, b=600.0, a=665.0)
WEIGHT = 30.0**2


@pytest.fixture(scope="module")
def scenarios(kept_seat_file):
    return seatsim.load(kept_seat_file, {"excitation.duration": 2.0, "variants": LAWS})


@pytest.fixture(scope="module")
def bracket(scenarios):
    return clairvoyant(scenarios[0], [WEIGHT])


def posed(scenario, duration=0.4, weight=WEIGHT):
    floor = scenario.excitation.floor(0.001, scenario.seed).acceleration[500 : 501 + round(1000 * duration)]
    return HeldForceProblem(transcribe(scenario.plant, floor, 0.001, 5, (0.0, 0.0)), weight)


def dense(problem):
    """The problem in all forces at once: velocities G F + w0, criterion F H F + 2 h F + free."""
    t, n = problem.transcription, problem.intervals
    states = np.zeros((n, len(t.A), n))
    for k in range(1, n):
        states[k] = t.A @ states[k - 1]
        states[k, :, k - 1] += t.B
    y = np.concatenate([states, np.eye(n)[:, None, :]], axis=1)
    p = problem.stage_matrices
    H, h = np.einsum("kif,ij,kjg->fg", y, p.Q, y), np.einsum("kif,ki->f", y, p.q)
    return H, h, t.acceleration.free + problem.weight * t.travel.free, np.einsum("i,kif->kf", p.V, y)


def test_bound_lies_below_every_law_and_below_the_run(scenarios, bracket):
    assert (bracket.lower > 0).all()
    assert (bracket.width > 0).all()
    assert bracket.width[0] < 0.06
    for scenario in scenarios:
        metrics = seatsim.run(scenario).runs[0].metrics
        aw, x = metrics["driver_acceleration_weighted"].value, metrics["suspension_displacement_rms"].value
        assert (aw**2 + bracket.weights * x**2 > bracket.reached).all()
        assert aw > bracket.bound(x)


def test_run_is_what_the_simulation_makes_of_its_force(scenarios, bracket):
    scenario = scenarios[0]
    weak = scenario.damper.record._replace(c_a=0.0, c_b=0.0, alpha_a=0.0, alpha_b=0.0)
    free = dataclasses.replace(scenario, damper=dataclasses.replace(scenario.damper, record=weak))
    floor = scenario.excitation.floor(0.001, scenario.seed)
    force = np.repeat(bracket.force[0], 5)
    # The simulation takes forces as linear between samples: a step in the middle of one has the held force's impulse.
    push = -np.pad(0.5 * (force[1:] + force[:-1]), 1, mode="edge")
    history = simulate(free, floor, Forces(frame=push))
    aw = weighted_rms(history["driver_acceleration"], 1000.0)
    assert aw == pytest.approx(bracket.acceleration[0], rel=5e-3)
    assert np.sqrt(np.mean(history["suspension_displacement"] ** 2)) == pytest.approx(bracket.travel[0], rel=5e-3)
    w = np.diff(history["suspension_displacement"][::5]) / 0.005
    F, size = bracket.force[0], np.abs(w)
    assert np.min(F * w - BAND.c * w**2 - BAND.f * size) > -0.02 * np.max(F * w)
    assert np.max(np.abs(F) - BAND.a - BAND.b * size) < 5.0


def test_lagrangian_is_that_of_the_dense_problem(scenarios):
    problem = posed(scenarios[0])
    H, h, free, G = dense(problem)
    w0 = problem.transcription.free_velocity
    alpha, beta, nu = np.random.default_rng(1).uniform(0, 1, (3, problem.intervals)) * [[2e-7], [2e-7], [1e-10]]
    c, f, b, a = BAND
    D = np.eye(len(w0)) - b * G
    L = H + G.T @ np.diag((alpha + beta) * c) @ G + D.T @ np.diag(nu) @ D
    L -= 0.5 * (np.diag(alpha + beta) @ G + G.T @ np.diag(alpha + beta))
    line = h + G.T @ ((alpha + beta) * c * w0 + 0.5 * f * (alpha - beta)) - 0.5 * (alpha + beta) * w0
    line -= D.T @ (nu * b * w0)
    constant = free + np.sum((alpha + beta) * c * w0**2 + f * (alpha - beta) * w0 + nu * (b**2 * w0**2 - a**2))
    found = problem.minimise_lagrangian(BAND, np.array([alpha, beta, nu]), 0.0)
    assert found.bound == pytest.approx(constant - line @ np.linalg.solve(L, line), rel=1e-7)
    assert found.barrier == pytest.approx(np.linalg.slogdet(L)[1], rel=1e-9)


def test_derivatives_with_the_barrier(scenarios):
    problem, barrier = posed(scenarios[0]), 1e-5
    y = np.full((3, problem.intervals), 2e-7) * [[1.0], [0.7], [1e-3]]
    by = problem.minimise_lagrangian(BAND, y, barrier).by
    for row, k in ((0, 5), (0, 40), (1, 40), (2, 60)):
        step = np.zeros_like(y)
        step[row, k] = 1e-3 * y[row, k]
        up, down = (problem.minimise_lagrangian(BAND, y + sign * step, barrier) for sign in (1, -1))
        rise = (up.bound + barrier * up.barrier - down.bound - barrier * down.barrier) / (2 * step[row, k])
        assert by[row, k] == pytest.approx(rise, rel=1e-4)


def test_both_ends_meet_where_the_damper_has_no_choice(scenarios):
    """A band about F = c w leaves a dashpot, whose criterion follows from a linear system."""
    problem = posed(scenarios[0], 0.5)
    band = ForceBand(c=800.0, f=0.0, b=800.0, a=4.0)
    H, h, free, G = dense(problem)
    F = np.linalg.solve(np.eye(problem.intervals) - band.c * G, band.c * problem.transcription.free_velocity)
    dashpot = free + F @ H @ F + 2 * h @ F
    run = find_best_run(problem, band)
    assert run.cost == pytest.approx(dashpot, rel=0.05)
    assert find_lower_bound(problem, band, run.cost).value == pytest.approx(run.cost, rel=0.05)


def test_envelope_of_a_viscous_and_friction_damper(scenarios):
    found = fit_envelope(scenarios[0].damper, 1.0, 20.0)
    assert found.inner == pytest.approx(BAND, rel=1e-6)
    assert found.outer.c * 0.3 + found.outer.f <= 250 * 0.3 + 45 + 1e-9
    assert found.outer.a + found.outer.b * 0.3 >= 665 + 600 * 0.3 - 1e-9


def test_bound_is_the_highest_of_all_weights():
    bracket = ClairvoyantBounds(
        np.array([1.0, 4.0]), np.array([2.0, 5.0]), np.array([1.5, 1.2]), np.array([0.5, 1.0]), None, 1.0
    )
    assert bracket.bound(0.0) == pytest.approx(np.sqrt(5.0))
    assert bracket.bound([1.0, 10.0]) == pytest.approx([1.0, 0.0])
    assert bracket.best([0.75, 2.0]) == pytest.approx([1.35, 1.2])
    assert np.isnan(bracket.best(0.4))


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"effects": [{"effect": "suspension.friction", "parameters": {"force": 45.0}}]}, "without effects; leave out"),
        ({"driver.model": "iso5982"}, "driver of one mass"),
        ({"damper.parameters.f0": 100.0}, "drives instead of damping"),
        ({"excitation": {"kind": "rest", "duration": 1.0}}, "nothing moves"),
        ({"temperature": {"start": 20.0, "ambient": 20.0}}, "one temperature"),
    ],
)
def test_what_has_no_bracket(kept_seat_file, settings, said):
    [scenario] = seatsim.load(kept_seat_file, settings)
    with pytest.raises(InputError, match=said):
        clairvoyant(scenario)


def test_numbers_out_of_range(scenarios):
    with pytest.raises(InputError, match="above 0"):
        clairvoyant(scenarios[0], [0.0])
    with pytest.raises(InputError, match=r"multiple of solver.step 0.001 s; choose 0.002 s"):
        clairvoyant(scenarios[0], [1.0], hold=0.0015)
