"""The best run: better than every damper setting, no better than without limits, and a local minimum."""

import numpy as np
import pytest

from controllers.clairvoyant.solve import find_best_run


def constant_laws(problem):
    gain = np.zeros((problem.intervals, len(problem.transcription.velocity)))
    for force in (-400.0, 0.0, 400.0):
        gain[:, -1] = force
        yield gain


def test_it_beats_runs_of_stated_laws_and_not_the_optimum_without_limits(problem, dense, band):
    run = find_best_run(problem, band)
    for gain in constant_laws(problem):
        assert run.cost < 0.999 * problem.simulate(band, gain).cost
    H, h, free, _ = dense
    assert run.cost > free - h @ np.linalg.solve(H + 1e-12 * np.eye(len(H)), h)


def test_no_small_change_of_a_free_force_improves_it(problem, band):
    run = find_best_run(problem, band)
    # Its forces replayed as they are, clipped again where intervals leave their line.
    gain = np.zeros((problem.intervals, len(problem.transcription.velocity)))
    gain[:, -1] = run.force
    assert problem.simulate(band, gain).cost == pytest.approx(run.cost, rel=1e-6)
    for k in np.flatnonzero(run.modes == 0)[::7]:
        for size in (-5.0, 5.0):
            moved = gain.copy()
            moved[k, -1] += size
            assert problem.simulate(band, moved).cost > run.cost * (1 - 1e-6)


def test_a_start_is_used_and_never_made_worse(problem, band):
    for gain in constant_laws(problem):
        assert find_best_run(problem, band, gain).cost <= problem.simulate(band, gain).cost
