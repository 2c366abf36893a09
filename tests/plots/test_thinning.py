"""The loudest part of a signal, and few items of many."""

import numpy as np
import pytest

from seatsim.plots.thinning import Window, find_loudest, spread_evenly


def test_the_loudest_samples_are_those_of_the_largest_energy():
    values = np.array([0.0, 1.0, -3.0, 0.0, 2.0, 2.0, 0.0, 0.0])
    # Energies of pairs: 1, 10, 9, 4, 8, 4, and the last pair is never reached.
    assert [find_loudest(values, 1.0, 2.0, raster).start for raster in (1.0, 2.0, 4.0)] == [1.0, 2.0, 4.0]
    assert find_loudest(np.ones(9), 1.0, 3.0, 1.0) == Window(0.0, 3.0)
    assert find_loudest(np.ones(3), 1.0, 5.0, 1.0) == Window(0.0, 2.0)


def test_the_loudest_samples_agree_with_a_sum_over_every_window():
    values = np.random.default_rng(0).standard_normal(200)
    energy = [np.sum(values[k : k + 30] ** 2) for k in range(170)]
    assert find_loudest(values, 0.1, 3.0, 0.1).start == pytest.approx(0.1 * np.argmax(energy))


def test_items_are_spread_from_the_first_to_the_last():
    assert spread_evenly("abcdefghi", 3) == ["a", "e", "i"]
    assert spread_evenly(range(20), 8) == [0, 2, 5, 8, 10, 13, 16, 19]
    assert spread_evenly("ab", 3) == ["a", "b"]


def test_a_window_is_the_samples_with_both_ends():
    window = Window(1.5, 2.0)
    assert window.part(0.1) == slice(15, 21)
    assert str(Window(1.26, 3.0)) == "1.3 to 3.0 s"
    assert np.arange(30)[window.part(0.1)] == pytest.approx([15, 16, 17, 18, 19, 20])
