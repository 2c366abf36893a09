"""How the values of all keys are combined to points: every combination, side by side, or drawn from a sequence.

A design that is drawn is resolved once, from the seed of the sweep, before anything runs. Where a design of more runs
begins with the points of one of fewer (`sobol`, `zip`, draws within `cross`), a sweep can be extended.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import cast

import numpy as np

from seatsim.schema.arrays import Array
from seatsim.sweeps.axes import SPECIMENS, Axis
from seatsim.sweeps.definition import SweepDefinition

_Columns = Mapping[str, list[object]]
"""The values of every varied key, a list over the points each."""


def count_points(definition: SweepDefinition) -> int:
    """Return how many points a design has, without making any of them."""
    if definition.table is not None:
        return len(next(iter(definition.table.columns.values())))
    lengths = [len(axis.values) for axis in definition.axes if axis.values is not None]
    if definition.design == "cross":
        return math.prod(lengths) * (1 if len(lengths) == len(definition.axes) else definition.runs or 1)
    return definition.runs or max(lengths, default=1)


def resolve_design(definition: SweepDefinition) -> _Columns:
    """Return the points of a sweep, without its replicates and the variants of its scenario.

    Raises:
        InputError: the design needs a number of runs that is not stated, or lists that are paired differ in length.
    """
    if definition.table is not None:
        return definition.table.columns
    resolve = {"cross": _cross, "zip": _pair, "lhs": _fill_hypercube, "sobol": _follow_sobol}[definition.design]
    columns = {**resolve(definition)}
    for specimen in cast("list[Mapping[str, object]]", columns.pop(SPECIMENS, [])):
        for key, value in specimen.items():
            columns.setdefault(key, []).append(value)
    return columns


def _cross(definition: SweepDefinition) -> _Columns:
    """Return every combination of the listed values, each with the same joint draws of the others.

    The draws vary slowest, so that more of them only add points; of the lists the first varies slowest.
    """
    listed = [axis for axis in definition.axes if axis.values is not None]
    drawn = [axis for axis in definition.axes if axis.values is None]
    draws = _draw(drawn, _count_draws(definition), definition.seed) if drawn else {}
    firsts = zip(*draws.values(), strict=True) if drawn else [()]
    points = itertools.product(firsts, *(axis.values or () for axis in listed))
    flat = [(*first, *rest) for first, *rest in points]
    columns = zip(*flat, strict=True)
    found = dict(zip([*draws, *(axis.key for axis in listed)], map(list, columns), strict=True))
    return {axis.key: found[axis.key] for axis in definition.axes}


def _pair(definition: SweepDefinition) -> _Columns:
    """Return the first values of all keys, then the second ones, and so on; distributions are drawn as often.

    A value that is alone in its list goes with all the others.
    """
    listed = {axis.key: list(axis.values) for axis in definition.axes if axis.values is not None}
    lengths = {key: len(values) for key, values in listed.items() if len(values) > 1}
    if len(set(lengths.values())) > 1:
        shown = ", ".join(f"{key} {length}" for key, length in lengths.items())
        raise definition.source.error(("vary",), f"design 'zip' pairs lists of one length; they have: {shown}")
    needs_draws = len(listed) < len(definition.axes)
    count = next(iter(lengths.values()), 0) or (_count_draws(definition) if needs_draws else 1)
    listed = {key: values * (count // len(values)) for key, values in listed.items()}
    if definition.runs not in (None, count):
        raise definition.source.error(("runs",), f"{definition.runs} is not permitted; the lists have {count} values")
    drawn = _draw([axis for axis in definition.axes if axis.values is None], count, definition.seed)
    return {axis.key: (listed | drawn)[axis.key] for axis in definition.axes}


def _fill_hypercube(definition: SweepDefinition) -> _Columns:
    from scipy.stats import qmc

    count = _count_draws(definition)
    sampler = qmc.LatinHypercube(len(definition.axes), seed=np.random.default_rng(definition.seed))
    return _map_cube(definition.axes, sampler.random(count))


def _follow_sobol(definition: SweepDefinition) -> _Columns:
    from scipy.stats import qmc

    count = _count_draws(definition)
    sampler = qmc.Sobol(len(definition.axes), seed=np.random.default_rng(definition.seed))
    # Powers of two are what the sequence is balanced for; the first points of one are those of a shorter one.
    return _map_cube(definition.axes, sampler.random_base2(math.ceil(math.log2(count)))[:count])


def _draw(axes: Sequence[Axis], count: int, seed: int) -> dict[str, list[object]]:
    return _map_cube(axes, np.random.default_rng(seed).random((count, len(axes))))


def _map_cube(axes: Sequence[Axis], cube: Array) -> dict[str, list[object]]:
    """Return the values of the axes at points of the unit cube, shape (N, len(axes))."""
    return {axis.key: axis.quantile(cube[:, k]) for k, axis in enumerate(axes)}


def _count_draws(definition: SweepDefinition) -> int:
    if definition.runs is None:
        raise definition.source.error((), f"key 'runs' is missing; design '{definition.design}' draws so many points")
    return definition.runs
