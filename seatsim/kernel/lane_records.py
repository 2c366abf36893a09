"""Records of many lanes, side by side in rows of numbers, so that a loop over lanes can take several at once.

A record is any nesting of named tuples and tuples of numbers. Number `j` of lane `l` stands at `rows[j * LANES + l]`:
with a distance that the compiler knows it needs no proof at run time that lanes do not overlap.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple, TypeVar, cast

import numpy as np
from numba import types
from numba.extending import overload
from numpy.typing import NDArray

from seatsim.compilation.jit import INLINED

T = TypeVar("T")
Array = NDArray[np.float64]
LANES = 16
"""Lanes of a block: two registers of 512 bits, or four of 256."""


class Zero(NamedTuple):
    """A number that is 0 in every lane."""


class One(NamedTuple):
    """A number that is 1 in every lane."""


class Two(NamedTuple):
    """A number that is 2 in every lane, such as the exponent of a product."""


SHARED: dict[type, float] = {Zero: 0.0, One: 1.0, Two: 2.0}
"""Numbers that are compiled in where all lanes share them: the terms and powers that they take away cost most."""


def numbers(record: tuple[object, ...]) -> list[float]:
    """Return the numbers of a record from the first field to the last, those of nested ones in their place.

    Raises:
        TypeError: a field is neither a number nor a record.
    """
    found: list[float] = []
    for part in record:
        if isinstance(part, tuple):
            found += numbers(part)
        elif isinstance(part, bool | int | float):
            found.append(part)
        else:
            raise TypeError(f"{type(part).__name__} is no number")
    return found


def template_of(records: Sequence[T]) -> T:
    """Return the first of several records of one form, with what they share of `SHARED` in place of its numbers."""
    first = records[0]
    if isinstance(first, tuple):
        parts = [template_of(column) for column in zip(*cast("Sequence[tuple[Any, ...]]", records), strict=True)]
        return cast("T", type(first)(*parts) if hasattr(first, "_fields") else tuple(parts))
    if isinstance(first, float) and all(record == first for record in records):
        return cast("T", next((kind() for kind, value in SHARED.items() if value == first), first))
    return first


def fill(records: Sequence[tuple[object, ...]]) -> Array:
    """Return the rows of up to `LANES` records of one form; lanes that are left over repeat the last one."""
    columns = [numbers(record) for record in records]
    columns += [columns[-1]] * (LANES - len(columns))
    return np.array(columns, dtype=float).T.ravel()


def gather(template: T, rows: Array, lane: int) -> T:
    """Return the record of a lane, of the form of the template."""
    raise NotImplementedError("for compiled code only")


def scatter(record: object, rows: Array, lane: int) -> None:
    """Write the record of a lane into its rows."""
    raise NotImplementedError("for compiled code only")


@overload(gather, strict=False, jit_options=INLINED)
def _gather(template: types.Type, rows: types.Type, lane: types.Type) -> Callable[..., object]:
    namespace: dict[str, object] = {}
    places = iter(range(10_000))
    value = _expression(template, places, namespace)
    exec(f"def impl(template, rows, lane): return {value}", namespace)
    return cast("Callable[..., object]", namespace["impl"])


@overload(scatter, strict=False, jit_options=INLINED)
def _scatter(record: types.Type, rows: types.Type, lane: types.Type) -> Callable[..., None]:
    lines = [f"rows[{j * LANES} + lane] = {leaf}" for j, leaf in enumerate(_leaves(record, "record"))]
    namespace: dict[str, object] = {}
    exec("\n    ".join(["def impl(record, rows, lane):", *lines, "return"]), namespace)
    return cast("Callable[..., None]", namespace["impl"])


def _expression(kind: types.Type, places: Iterator[int], namespace: dict[str, object]) -> str:
    """Return the source that builds a value of a type out of the rows; classes that it names enter the namespace."""
    if not isinstance(kind, types.BaseTuple):
        value = f"rows[{next(places) * LANES} + lane]"
        if isinstance(kind, types.Boolean):
            return f"{value} != 0.0"
        return f"int({value})" if isinstance(kind, types.Integer) else value
    cls = kind.instance_class if isinstance(kind, types.BaseNamedTuple) else None
    if cls in SHARED:
        next(places)
        return repr(SHARED[cls])
    parts = "".join(f"{_expression(part, places, namespace)}, " for part in kind.types)
    if cls is None:
        return f"({parts})"
    name = f"{cls.__name__}_{len(namespace)}"
    namespace[name] = cls
    return f"{name}({parts})"


def _leaves(kind: types.Type, path: str) -> Iterator[str]:
    """Yield the source of every number of a record of a type."""
    if isinstance(kind, types.BaseTuple):
        for index, part in enumerate(kind.types):
            yield from _leaves(part, f"{path}[{index}]")
    else:
        yield path
