"""Long runs of the linear rig with noise of a known level, for tests of the weights."""

import numpy as np

from seatsim.diagnosis.settings import DiagnosisSettings

from .toy import add_up, draw_signals, make_problem

RUNS = {"first": 1800, "second": 2400}


def pose(noise_settings=None, runs=RUNS, amounts=None, **stated):
    """Return a problem whose measured runs hold a signal of standard deviation 5 beside their noise."""
    settings = DiagnosisSettings()
    settings = settings._replace(noise=settings.noise._replace(**noise_settings or {}))
    signals = draw_signals(["nominal", "a"], runs)
    return make_problem(signals, add_up(signals, amounts or {"a": 5.0}), settings=settings, **stated)


def mean_squares(weights, drawn):
    """Return the mean square of every channel over all runs, shape (channels,), and how many numbers it is from."""
    whitened = np.concatenate([weights(values, run) for run, values in drawn.items()], axis=1)
    return np.mean(whitened**2, axis=1), whitened.shape[1]


def draw(problem, levels, seed=9):
    rng = np.random.default_rng(seed)
    return {run: levels[:, None] * rng.standard_normal(problem.measured[run].shape) for run in problem.runs}
