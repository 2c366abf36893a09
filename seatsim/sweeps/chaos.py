"""Polynomial chaos expansions of metrics over the varied keys, by least squares.

Each key has functions that are orthonormal over the runs: polynomials of the rank of a number, contrasts of the values
of a text. A metric is a constant, a sum of these and of products of two; where keys are independent, the squares of the
coefficients are shares of its variance (Sudret 2008, Reliab. Eng. Syst. Saf. 93, 964).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np

from seatsim.schema.arrays import Array

_MOST_VALUES = 40
"""Different texts of a key that have contrasts of their own."""
RUNS_PER_TERM = 2
"""Runs for each coefficient that are needed at least."""
_SINGULAR = 1e-10
"""Reciprocal of the condition number from which on runs do not determine an expansion."""


class _Degree(NamedTuple):
    """How rich an expansion is: the highest degree of a key alone, and of of each of two in a product (0: none)."""

    alone: int
    product: int


DEGREES = (_Degree(1, 0), _Degree(2, 0), _Degree(2, 1), _Degree(3, 1), _Degree(3, 2), _Degree(5, 2))
"""Expansions that are compared, from the poorest on."""


class Basis(NamedTuple):
    """The functions of an expansion at the runs, shape (N, P), the first constant; the keys that each depends on."""

    values: Array
    keys: list[tuple[int, ...]]


class Expansion(NamedTuple):
    """Coefficients of metrics, shape (P, M), inverse of the Gram matrix, shape (P, P), and variances of errors (M,)."""

    coefficients: Array
    inverse: Array
    noise: Array


def make_key_basis(values: Array | Sequence[object], degree: int) -> Array:
    """Return functions of one key that are orthonormal over the runs and orthogonal to a constant, shape (N, K)."""
    column = np.asarray(values)
    if column.dtype.kind in "if":
        distinct, index, counts = np.unique(column, return_inverse=True, return_counts=True)
        rank = (np.cumsum(counts) - 0.5 * counts)[index] / len(column)
        raw = np.polynomial.legendre.legvander(2 * rank - 1, min(degree, len(distinct) - 1))[:, 1:]
    else:
        distinct, index = np.unique(column.astype(str), return_inverse=True)
        raw = (index[:, None] == np.arange(min(len(distinct), _MOST_VALUES) - 1)).astype(float)
    whole = np.column_stack([np.ones(len(column)), raw])
    q, r = np.linalg.qr(whole)
    # The sign of a column of Q is the library's choice; with that of R a function rises with the key.
    functions: Array = np.sqrt(len(column)) * (q * np.sign(np.diag(r)))[:, 1:]
    return functions


def make_basis(columns: Sequence[Array | Sequence[object]], degree: _Degree) -> Basis:
    """Return the functions of all keys and, where the degree has products, those of two keys."""
    single = [make_key_basis(column, degree.alone) for column in columns]
    parts: list[tuple[Array, tuple[int, ...]]] = [(np.ones((len(single[0]), 1)), ())]
    parts += [(functions, (key,)) for key, functions in enumerate(single)]
    kinds = [np.asarray(column).dtype.kind for column in columns]
    pairs = zip(single, kinds, strict=True)
    short = [functions[:, : degree.product] if kind in "if" else functions for functions, kind in pairs]
    for (first, a), (second, b) in combinations(enumerate(short), 2) if degree.product else ():
        product = (a[:, :, None] * b[:, None, :]).reshape(len(a), -1)
        parts.append((product, (first, second)))
    return Basis(np.hstack([values for values, _ in parts]), list(_name_columns(parts)))


def fit_expansion(basis: Array, metrics: Array) -> Expansion | None:
    """Return the expansion of metrics, shape (N, M), or None where the runs do not determine it."""
    runs, terms = basis.shape
    gram = basis.T @ basis
    if runs < RUNS_PER_TERM * terms or np.linalg.cond(gram) > 1 / _SINGULAR:
        return None
    inverse = np.asarray(np.linalg.inv(gram), dtype=np.float64)
    coefficients: Array = inverse @ (basis.T @ metrics)
    residuals = metrics - basis @ coefficients
    noise: Array = (residuals**2).sum(axis=0) / (runs - terms)
    return Expansion(coefficients, inverse, noise)


def predict_left_out(basis: Array, metrics: Array, expansion: Expansion) -> Array | None:
    """Return the errors of an expansion at runs left out one by one, shape (N, M).

    With the leverage h of a run they are `residual / (1 - h)`; None where h is 1, so that the run alone determines a
    coefficient.
    """
    leverage = ((basis @ expansion.inverse) * basis).sum(axis=1)
    if np.any(leverage > 1 - _SINGULAR):
        return None
    errors: Array = (metrics - basis @ expansion.coefficients) / (1 - leverage)[:, None]
    return errors


def _name_columns(parts: Sequence[tuple[Array, tuple[int, ...]]]) -> Iterator[tuple[int, ...]]:
    for values, keys in parts:
        yield from [keys] * values.shape[1]
