"""Matrices without rounding, against Python's fractions."""

from fractions import Fraction

import numpy as np

from controllers.synthesis.certify import ExactMatrix, close_exactly

A = np.array([[1e-200, 1e200], [3.0, -0.1]])
B = np.array([[0.1, -7.25], [1e-17, 1.0]])


def fractions(matrix):
    return np.array([[Fraction(value) for value in row] for row in matrix.tolist()], dtype=object)


def value(exact):
    return np.array([[Fraction(whole, 2**exact.bits) for whole in row] for row in exact.whole.tolist()], dtype=object)


def test_doubles_are_taken_as_they_are():
    for matrix in (A, B, np.zeros((2, 3))):
        np.testing.assert_array_equal(value(ExactMatrix.of(matrix)), fractions(matrix))
        np.testing.assert_array_equal(ExactMatrix.of(matrix).rounded(), matrix)


def test_sums_products_and_transposes_do_not_round():
    a, b, x, y = ExactMatrix.of(A), ExactMatrix.of(B), fractions(A), fractions(B)
    np.testing.assert_array_equal(value(a @ b), x @ y)
    np.testing.assert_array_equal(value(a + b), x + y)
    np.testing.assert_array_equal(value(b - a), y - x)
    np.testing.assert_array_equal(value(a.T), x.T)
    np.testing.assert_array_equal(((a @ a) - (a @ a) + b).rounded(), B)


def test_the_nearest_double_is_returned():
    third = ExactMatrix(np.array([[2**80 // 3]], dtype=object), 80)
    assert third.rounded()[0, 0] == 1 / 3


def test_a_closed_loop_is_that_of_rational_arithmetic(random_plant):
    plant = random_plant(3)
    gain = 1e12 * np.random.default_rng(0).standard_normal((2, 2))
    K = fractions(gain)
    A, B1, B2, C1, C2, D11, D12, D21 = (
        fractions(m) for m in (plant.A, plant.B1, plant.B2, plant.C1, plant.C2, plant.D11, plant.D12, plant.D21)
    )
    exact = (A + B2 @ K @ C2, B1 + B2 @ K @ D21, C1 + D12 @ K @ C2, D11 + D12 @ K @ D21)
    for found, wanted in zip(close_exactly(plant, gain), exact, strict=True):
        np.testing.assert_array_equal(value(found), wanted)
