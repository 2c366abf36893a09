"""The loudest part of a signal, and few items of many."""

import numpy as np
import pytest

from seatsim.plots.thinning import find_loudest


def test_the_loudest_samples_agree_with_a_sum_over_every_window():
    values = np.random.default_rng(0).standard_normal(200)
    energy = [np.sum(values[k : k + 30] ** 2) for k in range(170)]
    assert find_loudest(values, 0.1, 3.0, 0.1).start == pytest.approx(0.1 * np.argmax(energy))
