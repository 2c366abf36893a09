"""The lower bound: what it may not exceed, what it has to reach, and where its ascent sets out from."""

import numpy as np

from controllers.clairvoyant.bound import find_lower_bound
from controllers.clairvoyant.solve import find_best_run


def test_the_bound_lies_below_every_run_and_above_what_no_limit_allows(problem, band, dense):
    run = find_best_run(problem, band)
    found = find_lower_bound(problem, band, run.cost)
    H, h, free, _ = dense
    assert free - h @ np.linalg.solve(H + 1e-12 * np.eye(len(H)), h) < found.value
    assert 0.9 * run.cost < found.value < run.cost
    # Multipliers without a minimum, as those of another weight may be, are retreated from.
    wild = np.log(np.repeat([0.1, 0.1, 1e-9], len(found.logarithms) // 3))
    assert 0.8 * run.cost < find_lower_bound(problem, band, run.cost, wild).value < run.cost
