"""Which key matters most: shares of the variance of each metric (Sobol indices) with intervals, and the swing of each.

    first(k) = Var(E[y | k]) / Var(y),  total(k) = E[Var(y | all keys but k)] / Var(y)

Both come from a polynomial chaos expansion of the runs at hand, so that every design in which keys are independent
will do, and no runs are made for them. The intervals of 95 % are those of a bootstrap over draws. Products of three
keys and what polynomials miss are in no index: `explained`, the share of the variance that the expansion predicts of
runs left out of its fit, says how far the indices can be relied on. What replicates differ in is unexplained, too.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.schema.arrays import Array
from seatsim.sweeps import chaos
from seatsim.sweeps.rows import SweepRows, is_number

if TYPE_CHECKING:
    import pandas as pd

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
        explained = 1 - float((errors[:, m] ** 2).mean() / usable[metric].var())
        here = [
            _make_row(usable, metric, key, k, basis, expansion, resampled, m, explained) for k, key in enumerate(keys)
        ]
        made += sorted(here, key=lambda row: -row.total)
    return Sensitivities(made)


def _varies(values: Array) -> bool:
    return float(values.std()) > _VANISHING * (abs(float(values.mean())) + _VANISHING)


def _find_dependent(columns: Sequence[Array]) -> tuple[int, int] | None:
    bases = [chaos.make_key_basis(column, 1) for column in columns]
    for a in range(len(bases)):
        for b in range(a + 1, len(bases)):
            pairs = len(set(zip(columns[a].tolist(), columns[b].tolist(), strict=True)))
            # Few points are alike by chance, within three standard deviations of 1/sqrt(points); the same ones are not.
            permitted = max(_DEPENDENT, min(_SAME, 3 / np.sqrt(pairs)))
            if np.abs(bases[a].T @ bases[b]).max() / len(bases[a]) > permitted:
                return a, b
    return None


def _expand(
    columns: Sequence[Array], metrics: Array, draws: int, drawn: int
) -> tuple[chaos.Basis, chaos.Expansion, Array] | None:
    """Return the expansion that predicts runs left out best, over all metrics, with its errors there, shape (N, M).

    So many keys are `drawn` together so many times: these `draws` determine their terms, however many runs there are.
    """
    best: tuple[float, chaos.Basis, chaos.Expansion, Array] | None = None
    scale = metrics.var(axis=0)
    for degree in chaos.DEGREES:
        if draws < chaos.RUNS_PER_TERM * (1 + drawn * degree.alone):
            continue
        basis = chaos.make_basis(columns, degree)
        expansion = chaos.fit_expansion(basis.values, metrics)
        errors = None if expansion is None else chaos.predict_left_out(basis.values, metrics, expansion)
        if expansion is None or errors is None:
            continue
        error = float((np.mean(errors**2, axis=0) / scale).mean())
        if best is None or error < best[0]:
            best = error, basis, expansion, errors
    return None if best is None else best[1:]


def _resample(basis: chaos.Basis, metrics: Array, draw: NDArray[np.intp]) -> Iterator[chaos.Expansion]:
    """Yield expansions of the runs with the draws taken anew, as often as chance has it; `draw` is that of each run."""
    rng = np.random.default_rng(0)
    draws = int(draw.max()) + 1
    for _ in range(_RESAMPLES):
        weights = np.sqrt(rng.multinomial(draws, np.full(draws, 1 / draws)))[draw, None]
        expansion = chaos.fit_expansion(weights * basis.values, weights * metrics)
        if expansion is not None:
            yield expansion


def _make_row(
    usable: pd.DataFrame,
    metric: str,
    key: str,
    number: int,
    basis: chaos.Basis,
    expansion: chaos.Expansion,
    resampled: Sequence[chaos.Expansion],
    column: int,
    explained: float,
) -> Sensitivity:
    first, total = _indices(basis, expansion, number, column)
    drawn = np.array([_indices(basis, each, number, column) for each in resampled] or [(np.nan, np.nan)])
    lows, highs = np.quantile(drawn, 0.025, axis=0), np.quantile(drawn, 0.975, axis=0)
    ends = _swing(usable, metric, key, number, basis, expansion, column)
    return Sensitivity(
        metric, key, first, float(lows[0]), float(highs[0]), total, float(lows[1]), float(highs[1]), *ends, explained
    )


def _indices(basis: chaos.Basis, expansion: chaos.Expansion, key: int, metric: int) -> tuple[float, float]:
    """Return first-order and total index; what noise adds to the square of a coefficient is taken out."""
    squares = expansion.coefficients[:, metric] ** 2 - expansion.noise[metric] * np.diag(expansion.inverse)
    whole = float(squares[1:].sum() + expansion.noise[metric])
    alone = sum(float(squares[k]) for k, keys in enumerate(basis.keys) if keys == (key,))
    with_others = sum(float(squares[k]) for k, keys in enumerate(basis.keys) if key in keys)
    # The mean square of a metric that the noise exceeds may come out below zero.
    first, total = (min(1.0, max(0.0, part / whole)) if whole > 0 else np.nan for part in (alone, with_others))
    return float(first), float(max(first, total))


def _swing(
    usable: pd.DataFrame,
    metric: str,
    key: str,
    number: int,
    basis: chaos.Basis,
    expansion: chaos.Expansion,
    column: int,
) -> tuple[object, object, float, float]:
    """Return two values of a key and the mean of a metric at each, by the terms of the expansion in that key alone."""
    mine = [k for k, keys in enumerate(basis.keys) if keys in ((), (number,))]
    means = basis.values[:, mine] @ expansion.coefficients[mine, column]
    values = usable[key]
    if is_number(values):
        low, high = (values.quantile(share, interpolation="nearest") for share in _SWING)
    else:
        low, high = values.iloc[int(means.argmin())], values.iloc[int(means.argmax())]
    at = [float(means[int(np.flatnonzero(values.to_numpy() == value)[0])]) for value in (low, high)]
    return low, high, at[0], at[1]


def choose_key(found: Sequence[Sensitivity], rows: SweepRows) -> Sensitivity | None:
    """Return what matters most to a metric: of the keys that are drawn if there are some, else of all but `variant`."""
    candidates = [row for row in found if row.key in rows.drawn] or [row for row in found if row.key != "variant"]
    return max(candidates, key=lambda row: row.total, default=None)


def tabulate_sensitivities(found: Sensitivities) -> pd.DataFrame:
    """Return the rows as a frame."""
    import pandas as pd

    return pd.DataFrame(found.rows, columns=list(Sensitivity._fields))
