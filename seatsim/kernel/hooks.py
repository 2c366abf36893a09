"""Optional methods of records: the one place where a method is looked up by its name.

A record class is an ordinary NamedTuple with ordinary methods. `hook(default)` makes a function `f(record, ...)` that
in compiled code is the record's own method of that name, inlined; where the class has none, the default's. numba
resolves it by the class of the record, so that a hook without a method costs nothing.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import ParamSpec, TypeVar, cast

from numba import types

from seatsim.compilation.jit import specialise

P = ParamSpec("P")
R = TypeVar("R")


def method_of(cls: type, name: str) -> Callable[..., object] | None:
    """Return the method of a record class for the hook `name`, or None where it has none."""
    method: Callable[..., object] | None = getattr(cls, name, None)
    return method


def record_class(kind: types.Type) -> type:
    """Return the record class that numba has typed as `kind`.

    Raises:
        TypeError: `kind` is no record, so that it has no methods.
    """
    if not isinstance(kind, types.BaseNamedTuple):
        raise TypeError(f"the compiled loop takes records (NamedTuple), not {kind}")
    cls: type = kind.instance_class
    return cls


def hook(default: Callable[P, R]) -> Callable[P, R]:
    """Make the generic function that calls a record's method of the default's name, or else the default."""
    name = default.__name__

    def method(cls: type) -> Callable[P, R]:
        own = method_of(cls, name)
        return cast("Callable[P, R]", own) if own else default

    def generic(*arguments: P.args, **named: P.kwargs) -> R:
        return method(type(arguments[0]))(*arguments, **named)

    def resolve(record: types.Type, *arguments: types.Type) -> Callable[P, R] | None:
        return method(record_class(record)) if isinstance(record, types.BaseNamedTuple) else None

    generic.__name__ = generic.__qualname__ = name
    specialise(generic)(resolve)
    return generic
