"""What the benchmarks of the diagnosis share: weights by the stated noise, ranks, and the sparse regression."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from seatsim.diagnosis.problem import pose_problem
from seatsim.recordings.recording import load_recording


def test_stated_noise_alone_whitens_white_noise_of_that_size_to_mean_square_1(benchmark, sound):
    with ThreadPoolExecutor(2) as pool:
        problem = pose_problem(load_recording(sound), pool)
    weights = benchmark("cases").weigh_stated_noise(problem)
    level = np.maximum(problem.noise, 1e-3 * problem.spread)[:, None]
    run, rng = problem.runs[0], np.random.default_rng(1)
    whitened = weights(level * rng.standard_normal(problem.measured[run].shape), run)
    assert np.mean(whitened**2) == pytest.approx(1.0, abs=0.05)


def test_a_sparse_regression_keeps_the_columns_that_the_target_is_made_of(benchmark):
    columns = np.random.default_rng(0).standard_normal((5, 4000))
    target = 2.0 * columns[1] + 1.0 * columns[3] + 0.1 * columns[4]
    ranked, left = benchmark("diagnosis_baselines").regress_sparsely(target, list(zip("abcde", columns, strict=True)))
    assert [name for name, _ in ranked] == ["b", "d"]
    assert left == pytest.approx(0.01, rel=0.1)
    assert benchmark("diagnosis_baselines").regress_sparsely(target, []) == ([], pytest.approx(np.mean(target**2)))
