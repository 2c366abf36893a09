"""The recursions, by the calls of the problem: against the same problem in all forces at once."""

import numpy as np
import pytest

from controllers.clairvoyant.recursion import FREE, LOWER, STUCK, UPPER, _find_closest_force


def multipliers(problem, seed=1):
    return np.random.default_rng(seed).uniform(0.2, 1, (3, problem.intervals)) * [[2e-7], [2e-7], [1e-10]]


def lagrangian(problem, dense, band, alpha, beta, nu):
    """Return the Lagrangian in all forces: F L F + 2 line F + constant."""
    (H, h, free, G), w0 = dense, problem.transcription.free_velocity
    c, f, b, a = band
    D = np.eye(len(w0)) - b * G
    L = H + G.T @ np.diag((alpha + beta) * c) @ G + D.T @ np.diag(nu) @ D
    L -= 0.5 * (np.diag(alpha + beta) @ G + G.T @ np.diag(alpha + beta))
    line = h + G.T @ ((alpha + beta) * c * w0 + 0.5 * f * (alpha - beta)) - 0.5 * (alpha + beta) * w0
    line -= D.T @ (nu * b * w0)
    constant = free + np.sum((alpha + beta) * c * w0**2 + f * (alpha - beta) * w0 + nu * (b**2 * w0**2 - a**2))
    return L, line, constant


def test_minimum_and_determinant_of_the_lagrangian(problem, dense, band):
    y = multipliers(problem)
    L, line, constant = lagrangian(problem, dense, band, *y)
    found = problem.minimise_lagrangian(band, y, 0.0)
    assert found.bound == pytest.approx(constant - line @ np.linalg.solve(L, line), rel=1e-9)
    assert found.barrier == pytest.approx(np.linalg.slogdet(L)[1], rel=1e-9)
    # The law gives the minimiser: run it over the states it makes.
    F, t, state = np.linalg.solve(L, -line), problem.transcription, np.zeros(len(problem.transcription.A))
    for k in range(problem.intervals):
        assert found.gain[k] @ np.append(state, 1.0) == pytest.approx(F[k], rel=1e-6, abs=1e-5)
        state = t.A @ state + t.B * F[k]


@pytest.mark.parametrize("barrier", [0.0, 1e-5])
def test_derivatives_of_minimum_and_barrier(problem, band, barrier):
    y = multipliers(problem)
    by = problem.minimise_lagrangian(band, y, barrier).by
    for row, k in ((0, 5), (0, 40), (1, 40), (2, 30), (2, 3)):
        step = np.zeros_like(y)
        step[row, k] = 1e-3 * y[row, k]
        up, down = (problem.minimise_lagrangian(band, y + sign * step, barrier) for sign in (1, -1))
        rise = (up.bound + barrier * up.barrier - down.bound - barrier * down.barrier) / (2 * step[row, k])
        assert by[row, k] == pytest.approx(rise, rel=2e-4)


def test_a_lagrangian_without_a_minimum_is_none(problem, band):
    assert problem.minimise_lagrangian(band, multipliers(problem) * [[1e6], [1e6], [0.0]], 0.0) is None


def test_a_run_has_the_criterion_and_velocities_of_its_forces(problem, dense, band):
    (H, h, free, G), w0 = dense, problem.transcription.free_velocity
    gain = np.zeros((problem.intervals, len(problem.transcription.velocity)))
    gain[:, -1] = 150.0 * np.sin(0.3 * np.arange(problem.intervals))
    run = problem.simulate(band, gain)
    F = run.force
    assert run.cost == pytest.approx(F @ H @ F + 2 * h @ F + free, rel=1e-9)
    assert run.cost == pytest.approx(run.acceleration + problem.weight * run.travel, rel=1e-12)
    np.testing.assert_allclose(run.velocity, np.where(run.modes == STUCK, 0.0, G @ F + w0), atol=1e-9)
    size, along = np.abs(run.velocity), F * np.sign(run.velocity)
    moving = run.modes != STUCK
    assert np.all(along[moving] >= (band.f + band.c * size - 1e-9)[moving])
    assert np.all(along[moving] <= (band.a + band.b * size + 1e-9)[moving])
    assert np.all(np.abs(F[~moving]) <= band.a)
    wanted = gain[:, -1]
    np.testing.assert_allclose(F[run.modes == FREE], wanted[run.modes == FREE])
    lower = np.abs(run.modes) == LOWER
    np.testing.assert_allclose(along[lower], (band.f + band.c * size)[lower], rtol=1e-9)
    assert {FREE, LOWER} <= set(np.abs(run.modes))


@pytest.mark.parametrize(
    ("want", "free", "force", "mode"),
    [
        (200.0, 0.5, 200.0, FREE),
        (-200.0, -0.5, -200.0, FREE),
        (-900.0, 0.5, (45.0 + 250.0 * 0.5) / 1.25, LOWER),
        (900.0, -0.5, -(45.0 + 250.0 * 0.5) / 1.25, -LOWER),
        (9000.0, 5.0, (665.0 + 600.0 * 5.0) / 1.6, UPPER),
        (-9000.0, -5.0, -(665.0 + 600.0 * 5.0) / 1.6, -UPPER),
        (9000.0, 0.2, 200.0, STUCK),
        (-9000.0, -0.2, -200.0, STUCK),
    ],
)
def test_the_closest_force_that_the_damper_delivers(band, want, free, force, mode):
    # w = free - F / 1000: a force of 1000 free holds the damper still, if it is no larger than a = 665 N.
    found = _find_closest_force(band, want, free, 1e-3)
    assert found[0] == pytest.approx(force)
    assert found[1] == mode


def test_the_improved_law_is_best_while_intervals_stay(problem, dense, band):
    """Free intervals and those on a line follow from one linear system."""
    H, h, _, G = dense
    w0, n = problem.transcription.free_velocity, problem.intervals
    gain = np.zeros((n, len(problem.transcription.velocity)))
    gain[:, -1] = 150.0 * np.sin(0.3 * np.arange(n))
    run, proximity = problem.simulate(band, gain), 1e-9
    law = problem.improve_law(band, run, proximity)
    # Forces on a line: F = sign offset + slope w; stuck: w = 0. Written as E F = e, the rest free.
    fixed, E, e = run.modes != FREE, np.zeros((n, n)), np.zeros(n)
    for k in np.flatnonzero(fixed):
        if run.modes[k] == STUCK:
            E[k], e[k] = G[k], -w0[k]
        else:
            slope, offset = (band.c, band.f) if abs(run.modes[k]) == LOWER else (band.b, band.a)
            E[k], e[k] = np.eye(n)[k] - slope * G[k], np.sign(run.modes[k]) * offset + slope * w0[k]
    m = int(fixed.sum())
    # The proximity term acts on every interval's force.
    A = np.block([[H + proximity * np.eye(n), E[fixed].T], [E[fixed], np.zeros((m, m))]])
    F = np.linalg.solve(A, np.concatenate([proximity * run.force - h, e[fixed]]))[:n]
    t, state = problem.transcription, np.zeros(len(problem.transcription.A))
    for k in range(n):
        if not fixed[k]:
            assert law[k] @ np.append(state, 1.0) == pytest.approx(F[k], rel=1e-5, abs=1e-3)
        state = t.A @ state + t.B * F[k]
