"""Which key matters most: shares of the variance of each metric (Sobol indices) with intervals, and the swing of each.

    first(k) = Var(E[y | k]) / Var(y),  total(k) = E[Var(y | all keys but k)] / Var(y)

Both come from a polynomial chaos expansion of the runs at hand, so that every design in which keys are independent
will do, and no runs are made for them. Each key has functions that are orthonormal over the runs: polynomials of the
rank of a number, contrasts of the values of a text. A metric is a constant, a sum of these and of products of two; the
squares of the coefficients are shares of its variance (Sudret 2008, Reliab. Eng. Syst. Saf. 93, 964). The intervals of
95 % are those of a bootstrap over draws. Products of three keys and what polynomials miss are in no index: `explained`,
the share of the variance that the expansion predicts of runs left out of its fit, says how far the indices can be
relied on. What replicates differ in is unexplained, too.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.metrics.table import COMFORT
from seatsim.scenario.scenario import is_condition
from seatsim.schema.arrays import Array
from seatsim.sweeps.parts import SweepRows, is_number

if TYPE_CHECKING:
    import pandas as pd

_MOST_VALUES = 40
"""Different texts of a key that have contrasts of their own."""
_RUNS_PER_TERM = 2
"""Runs for each coefficient that are needed at least."""
_SINGULAR = 1e-10
"""Reciprocal of the condition number from which on runs do not determine an expansion."""
_RESAMPLES = 200
_MOST_RUNS = 4000
"""Runs that are used; more hardly narrow the intervals, and the bootstrap takes time for each."""
_DEPENDENT = 0.3
"""Correlation of functions of two keys from which on these are dependent, and shares of variance have no meaning."""
_SAME = 0.95
"""Correlation from which on two keys are one, however few their points."""
_SWING = (0.05, 0.95)
"""Quantiles of a key between which a metric swings."""
_VANISHING = 1e-9
"""Standard deviation over the mean of a metric that does not vary."""


class _Degree(NamedTuple):
    """How rich an expansion is: the highest degree of a key alone, and of of each of two in a product (0: none)."""

    alone: int
    product: int


_DEGREES = (_Degree(1, 0), _Degree(2, 0), _Degree(2, 1), _Degree(3, 1), _Degree(3, 2), _Degree(5, 2))
"""Expansions that are compared, from the poorest on."""


class _Basis(NamedTuple):
    """The functions of an expansion at the runs, shape (N, P), the first constant; the keys that each depends on."""

    values: Array
    keys: list[tuple[int, ...]]


class _Expansion(NamedTuple):
    """Coefficients of metrics, shape (P, M), inverse of the Gram matrix, shape (P, P), and variances of errors (M,)."""

    coefficients: Array
    inverse: Array
    noise: Array


class Sensitivity(NamedTuple):
    """How a metric hangs on a key: indices with intervals, and the metric's mean at a low and a high value of the key.

    `low` and `high` are the 5 % and 95 % quantiles of a number; of a text, those with the least and greatest mean.
    """

    metric: str
    key: str
    first: float
    first_low: float
    first_high: float
    total: float
    total_low: float
    total_high: float
    low: object
    high: object
    at_low: float
    at_high: float
    explained: float


class Sensitivities(NamedTuple):
    """Sensitivities of all metrics, the strongest key of each first; `problem` says why there are none."""

    rows: list[Sensitivity]
    problem: str = ""

    def of(self, metric: str) -> list[Sensitivity]:
        """Return those of one metric."""
        return [row for row in self.rows if row.metric == metric]

    @property
    def leading(self) -> list[Sensitivity]:
        """Those of comfort where it varies, else of the first metric."""
        return self.of(COMFORT) or (self.of(self.rows[0].metric) if self.rows else [])


def analyse_sensitivity(rows: SweepRows) -> Sensitivities:
    """Return the sensitivity of every metric to every varied key, where the runs tell."""
    usable = rows.usable.sample(_MOST_RUNS, random_state=0) if len(rows.usable) > _MOST_RUNS else rows.usable
    keys = [key for key in rows.keys if usable[key].nunique() > 1]
    if not keys:
        return Sensitivities([], "no key has two values among the runs that can be used")
    columns = [usable[key].to_numpy() for key in keys]
    pair = _find_dependent(columns)
    if pair is not None:
        return Sensitivities(
            [],
            f"{keys[pair[0]]} and {keys[pair[1]]} vary together; shares of variance need keys that"
            " vary independently (cross, lhs, sobol)",
        )
    complete = [name for name in rows.metrics if usable[name].notna().all() and _varies(usable[name].to_numpy())]
    if not complete:
        return Sensitivities([], "no metric varies")
    drawn = [key for key in keys if key in rows.drawn]
    # In a cross every draw stands in many rows, which then tell of that one draw.
    draw = np.asarray(usable.groupby(drawn).ngroup() if drawn else range(len(usable)), dtype=np.intp)
    draws = int(draw.max()) + 1
    found = _expand(columns, usable[complete].to_numpy(), draws, len(drawn))
    if found is None:
        what, over = ("draws", drawn) if draws < len(usable) else ("runs", keys)
        return Sensitivities([], f"{draws} {what} that can be used are too few for {len(over)} keys")
    basis, expansion, errors = found
    resampled = list(_resample(basis, usable[complete].to_numpy(), draw))
    made: list[Sensitivity] = []
    for m, metric in enumerate(complete):
        explained, here = 1 - float((errors[:, m] ** 2).mean() / usable[metric].var()), []
        for k, key in enumerate(keys):
            first, total = _indices(basis, expansion, k, m)
            drawn_anew = np.array([_indices(basis, each, k, m) for each in resampled] or [(np.nan, np.nan)])
            (first_low, total_low), (first_high, total_high) = np.quantile(drawn_anew, (0.025, 0.975), axis=0).tolist()
            own = [place for place, of in enumerate(basis.keys) if of in ((), (k,))]
            swing = _swing(usable[key], basis.values[:, own] @ expansion.coefficients[own, m])
            indices = (first, first_low, first_high, total, total_low, total_high)
            here.append(Sensitivity(metric, key, *indices, *swing, explained))
        made += sorted(here, key=lambda row: -row.total)
    return Sensitivities(made)


def _varies(values: Array) -> bool:
    return float(values.std()) > _VANISHING * (abs(float(values.mean())) + _VANISHING)


def _find_dependent(columns: Sequence[Array]) -> tuple[int, int] | None:
    bases = [_make_key_basis(column, 1) for column in columns]
    for a in range(len(bases)):
        for b in range(a + 1, len(bases)):
            pairs = len(set(zip(columns[a].tolist(), columns[b].tolist(), strict=True)))
            # Few points are alike by chance, within three standard deviations of 1/sqrt(points); the same ones are not.
            permitted = max(_DEPENDENT, min(_SAME, 3 / np.sqrt(pairs)))
            if np.abs(bases[a].T @ bases[b]).max() / len(bases[a]) > permitted:
                return a, b
    return None


def _make_key_basis(values: Array | Sequence[object], degree: int) -> Array:
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


def _make_basis(columns: Sequence[Array | Sequence[object]], degree: _Degree) -> _Basis:
    """Return the functions of all keys and, where the degree has products, those of two keys."""
    single = [_make_key_basis(column, degree.alone) for column in columns]
    parts: list[tuple[Array, tuple[int, ...]]] = [(np.ones((len(single[0]), 1)), ())]
    parts += [(functions, (key,)) for key, functions in enumerate(single)]
    kinds = [np.asarray(column).dtype.kind for column in columns]
    pairs = zip(single, kinds, strict=True)
    short = [functions[:, : degree.product] if kind in "if" else functions for functions, kind in pairs]
    for (first, a), (second, b) in combinations(enumerate(short), 2) if degree.product else ():
        product = (a[:, :, None] * b[:, None, :]).reshape(len(a), -1)
        parts.append((product, (first, second)))
    return _Basis(
        np.hstack([values for values, _ in parts]), [keys for values, keys in parts for _ in range(values.shape[1])]
    )


def _fit_expansion(basis: Array, metrics: Array) -> _Expansion | None:
    """Return the expansion of metrics, shape (N, M), or None where the runs do not determine it."""
    runs, terms = basis.shape
    gram = basis.T @ basis
    if runs < _RUNS_PER_TERM * terms or np.linalg.cond(gram) > 1 / _SINGULAR:
        return None
    inverse = np.asarray(np.linalg.inv(gram), dtype=np.float64)
    coefficients: Array = inverse @ (basis.T @ metrics)
    residuals = metrics - basis @ coefficients
    noise: Array = (residuals**2).sum(axis=0) / (runs - terms)
    return _Expansion(coefficients, inverse, noise)


def _predict_left_out(basis: Array, metrics: Array, expansion: _Expansion) -> Array | None:
    """Return the errors of an expansion at runs left out one by one, shape (N, M).

    With the leverage h of a run they are `residual / (1 - h)`; None where h is 1, so that the run alone determines a
    coefficient.
    """
    leverage = ((basis @ expansion.inverse) * basis).sum(axis=1)
    if np.any(leverage > 1 - _SINGULAR):
        return None
    errors: Array = (metrics - basis @ expansion.coefficients) / (1 - leverage)[:, None]
    return errors


def _expand(
    columns: Sequence[Array], metrics: Array, draws: int, drawn: int
) -> tuple[_Basis, _Expansion, Array] | None:
    """Return the expansion that predicts runs left out best, over all metrics, with its errors there, shape (N, M).

    So many keys are `drawn` together so many times: these `draws` determine their terms, however many runs there are.
    """
    best: tuple[float, _Basis, _Expansion, Array] | None = None
    scale = metrics.var(axis=0)
    for degree in _DEGREES:
        if draws < _RUNS_PER_TERM * (1 + drawn * degree.alone):
            continue
        basis = _make_basis(columns, degree)
        expansion = _fit_expansion(basis.values, metrics)
        errors = None if expansion is None else _predict_left_out(basis.values, metrics, expansion)
        if expansion is None or errors is None:
            continue
        error = float((np.mean(errors**2, axis=0) / scale).mean())
        if best is None or error < best[0]:
            best = error, basis, expansion, errors
    return None if best is None else best[1:]


def _resample(basis: _Basis, metrics: Array, draw: NDArray[np.intp]) -> Iterator[_Expansion]:
    """Yield expansions of the runs with the draws taken anew, as often as chance has it; `draw` is that of each run."""
    rng = np.random.default_rng(0)
    draws = int(draw.max()) + 1
    for _ in range(_RESAMPLES):
        weights = np.sqrt(rng.multinomial(draws, np.full(draws, 1 / draws)))[draw, None]
        expansion = _fit_expansion(weights * basis.values, weights * metrics)
        if expansion is not None:
            yield expansion


def _indices(basis: _Basis, expansion: _Expansion, key: int, metric: int) -> tuple[float, float]:
    """Return first-order and total index; what noise adds to the square of a coefficient is taken out."""
    squares = expansion.coefficients[:, metric] ** 2 - expansion.noise[metric] * np.diag(expansion.inverse)
    whole = float(squares[1:].sum() + expansion.noise[metric])
    alone = sum(float(squares[k]) for k, keys in enumerate(basis.keys) if keys == (key,))
    with_others = sum(float(squares[k]) for k, keys in enumerate(basis.keys) if key in keys)
    # The mean square of a metric that the noise exceeds may come out below zero.
    first, total = (min(1.0, max(0.0, part / whole)) if whole > 0 else np.nan for part in (alone, with_others))
    return float(first), float(max(first, total))


def _swing(column: pd.Series, means: Array) -> tuple[object, object, float, float]:
    """Return two values of a key and the mean of a metric at each, of its `means` by the key alone, shape (N,)."""
    if is_number(column):
        low, high = (column.quantile(share, interpolation="nearest") for share in _SWING)
    else:
        low, high = column.iloc[int(means.argmin())], column.iloc[int(means.argmax())]
    at = [float(means[int(np.flatnonzero(column.to_numpy() == value)[0])]) for value in (low, high)]
    return low, high, at[0], at[1]


def choose_key(found: Sequence[Sensitivity], rows: SweepRows) -> Sensitivity | None:
    """Return what matters most to a metric: of the keys that are drawn if there are some, else of all but `variant`."""
    candidates = [row for row in found if row.key in rows.drawn] or [row for row in found if row.key != "variant"]
    return max(candidates, key=lambda row: row.total, default=None)


def choose_choice(found: Sequence[Sensitivity], rows: SweepRows) -> Sensitivity | None:
    """Return which of the keys that a designer chooses matters most to a metric."""
    return choose_key([row for row in found if not is_condition(row.key)], rows)


def tabulate_sensitivities(found: Sensitivities) -> pd.DataFrame:
    """Return the rows as a frame."""
    import pandas as pd

    return pd.DataFrame(found.rows, columns=list(Sensitivity._fields))
