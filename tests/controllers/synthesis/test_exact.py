"""Matrices without rounding, against Python's fractions."""

from decimal import Decimal, localcontext
from fractions import Fraction

import numpy as np

from controllers.synthesis.certify import EXACT, close_exactly, rounded, without_rounding
from controllers.synthesis.plant import MATRICES, close_loop

A = np.array([[1e-200, 1e200], [3.0, -0.1]])
B = np.array([[0.1, -7.25], [1e-17, 1.0]])
fractions = np.vectorize(Fraction, otypes=[object])


def test_sums_and_products_do_not_round():
    a, b, x, y = without_rounding(A), without_rounding(B), fractions(A), fractions(B)
    with localcontext(EXACT):
        for found, wanted in ((a, x), (b, y), (a @ b, x @ y), (a + b, x + y), (b - a, y - x)):
            np.testing.assert_array_equal(fractions(found), wanted)
        np.testing.assert_array_equal(rounded((a @ a) - (a @ a) + b), B)


def test_the_nearest_double_is_returned():
    third = np.array([[Decimal("0." + 40 * "3")]], dtype=object)
    assert rounded(third)[0, 0] == 1 / 3


def test_a_closed_loop_is_that_of_rational_arithmetic(random_plant):
    plant = random_plant(3)
    gain = 1e12 * np.random.default_rng(0).standard_normal((2, 2))
    with localcontext(EXACT):
        loop = close_exactly(plant, gain)
    wanted = close_loop([fractions(getattr(plant, name)) for name in MATRICES], fractions(gain))
    for found, exact in zip(loop, wanted, strict=True):
        np.testing.assert_array_equal(fractions(found), exact)
