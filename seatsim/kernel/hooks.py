"""Optional methods of records: the one place where a method is looked up by its name; and arithmetic of tuples.

A record class is an ordinary NamedTuple with ordinary methods. `hook(default)` makes a function `f(record, ...)` that
in compiled code is the record's own method of that name, inlined; where the class has none, the default's. Over a tuple
of effect records `sum_hook`, `fold_hook` and `join_hook` make one function per hook, unrolled: only the records that
have the method are called, the others cost nothing. `z` is the state of all of them, one after another; a method
`f(self, ..., z)` gets its own part of it. numba resolves all by the classes of the records.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cache
from typing import Any, ParamSpec, Protocol, TypeVar

from numba import types

from seatsim.compilation.jit import define, jit, specialise
from seatsim.rig.state import State
from seatsim.schema.registry import specification_of

_P = ParamSpec("_P")
_R = TypeVar("_R")


def method_of(cls: type, name: str) -> Callable[..., Any] | None:
    """Return the method of a record class for the hook `name`, or None where it has none."""
    method: Callable[..., Any] | None = getattr(cls, name, None)
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


def hook(default: Callable[_P, _R]) -> Callable[_P, _R]:
    """Make the generic function that calls a record's method of the default's name, or else the default."""
    name = default.__name__

    def method(cls: type) -> Callable[_P, _R]:
        own = method_of(cls, name)
        return own or default

    def generic(*arguments: _P.args, **named: _P.kwargs) -> _R:
        return method(type(arguments[0]))(*arguments, **named)

    def resolve(record: types.Type, *arguments: types.Type) -> Callable[_P, _R] | None:
        return method(record_class(record)) if isinstance(record, types.BaseNamedTuple) else None

    generic.__name__ = generic.__qualname__ = name
    specialise(generic)(resolve)
    return generic


_T = TypeVar("_T")
Effects = tuple[Any, ...]
"""Effect records: a `typing.NamedTuple` each, with a method for each hook that it uses."""


class _FoldedHook(Protocol):
    """A value that is passed from record to record."""

    def __call__(self, effects: Effects, z: State, value: _T, /, *arguments: object) -> _T:
        """Return `value` after all records changed it; unchanged where no record has the method."""


def state_at_rest(classes: Sequence[type]) -> State:
    """Return the state at rest of records of these classes, one after another."""
    return tuple(value for cls in classes for value in specification_of(cls).initial)


def _parts(classes: Sequence[type], name: str) -> Iterator[tuple[int, Callable[..., object], slice]]:
    """Yield index, method and part of the state of every class that has the method."""
    start = 0
    for index, cls in enumerate(classes):
        end = start + len(specification_of(cls).initial)
        method = method_of(cls, name)
        if method:
            yield index, method, slice(start, end)
        start = end


@cache
def _implementation(
    classes: tuple[type, ...], name: str, first: str, line: str, last: str, count: int
) -> Callable[..., object]:
    """Build `impl(effects, z, a0, ...)` with `count` arguments: numba cannot loop over a tuple of several classes."""
    arguments = [f"a{k}" for k in range(count)]
    body, namespace = [first], dict[str, object](__name__=__name__)
    for index, method, part in _parts(classes, name):
        namespace[f"m{index}"] = jit(method)
        given = ", ".join([f"effects[{index}]", *arguments, f"z[{part.start}:{part.stop}]"])
        body.append(line.format(call=f"m{index}({given})"))
    source = "\n    ".join([f"def {name}({', '.join(['effects', 'z', *arguments])}):", *body, last])
    return define(source, name, namespace)


def _chain(name: str, first: str, line: str, last: str) -> Callable[..., Any]:
    """Make a generic function `f(effects, z, *arguments)` out of the source of its body.

    The body is `first`, then `line` for each record that has the method, then `last`; `{call}` in a line is the
    method's call, `r` the result so far, `a0, a1, ...` the arguments.
    """

    def generic(effects: Effects, z: State, *arguments: object) -> object:
        classes = tuple(type(effect) for effect in effects)
        return _implementation(classes, name, first, line, last, len(arguments))(effects, z, *arguments)

    def resolve(effects: types.Type, z: types.Type, *arguments: types.Type) -> Callable[..., object] | None:
        if not isinstance(effects, types.BaseTuple):
            return None
        return _implementation(tuple(map(record_class, effects.types)), name, first, line, last, len(arguments))

    generic.__name__ = generic.__qualname__ = name
    specialise(generic)(resolve)
    return generic


def sum_hook(name: str) -> Callable[..., float]:
    """Make the function that sums the records' values for the hook `name`."""
    return _chain(name, "r = 0.0", "r += {call}", "return r")


def fold_hook(name: str) -> _FoldedHook:
    """Make the function that passes its first argument from record to record, each of which may change it."""
    return _chain(name, "", "a0 = {call}", "return a0")


def join_hook(name: str) -> Callable[..., State]:
    """Make the function that joins the records' tuples, one after another, in the order of the states."""
    return _chain(name, "r = ()", "r = r + {call}", "return r")


def leading_state(effects: Effects, z: State) -> State:
    """Return the head of a state, in front of the part that belongs to the effects."""
    return z[: len(z) - len(state_at_rest([type(effect) for effect in effects]))]


def effect_state(effects: Effects, z: State) -> State:
    """Return the tail of a state, which belongs to the effects."""
    return z[len(z) - len(state_at_rest([type(effect) for effect in effects])) :]


@specialise(leading_state)
def _leading_state(effects: types.Type, z: types.Type) -> Callable[[Effects, State], State]:
    end = len(z) - len(state_at_rest([*map(record_class, effects.types)]))
    return lambda effects, z: z[:end]


@specialise(effect_state)
def _effect_state(effects: types.Type, z: types.Type) -> Callable[[Effects, State], State]:
    start = len(z) - len(state_at_rest([*map(record_class, effects.types)]))
    return lambda effects, z: z[start:]


def axpy(y: State, h: float, k: State) -> State:
    """Return `y + h k` for two tuples of equal length."""
    return tuple(a + h * b for a, b in zip(y, k, strict=True))


@specialise(axpy)
def _axpy(y: types.Type, h: types.Type, k: types.Type) -> Callable[..., State]:
    return _unrolled("y, h, k", "y[{j}] + h * k[{j}]", len(y))


def combine(y: State, h: float, k1: State, k2: State, k3: State, k4: State) -> State:
    """Return `y + h (k1 + 2 k2 + 2 k3 + k4) / 6`, the step of the classical Runge-Kutta method."""
    stages = zip(y, k1, k2, k3, k4, strict=True)
    return tuple(a + h / 6.0 * (b + 2.0 * (c + d) + e) for a, b, c, d, e in stages)


@specialise(combine)
def _combine(
    y: types.Type, h: types.Type, k1: types.Type, k2: types.Type, k3: types.Type, k4: types.Type
) -> Callable[..., State]:
    term = "y[{j}] + h / 6.0 * (k1[{j}] + 2.0 * (k2[{j}] + k3[{j}]) + k4[{j}])"
    return _unrolled("y, h, k1, k2, k3, k4", term, len(y))


def _unrolled(arguments: str, term: str, length: int) -> Callable[..., State]:
    """Build a function that returns a tuple of `term` for j = 0 .. length - 1: numba has no tuple comprehension."""
    body = "".join(term.format(j=j) + ", " for j in range(length))
    source = f"def unrolled({arguments}): return ({body})"
    return define(source, "unrolled", {"__name__": __name__})


MOST_WORK = 100
"""Mean number of parts of a step at which a run is given up: it would take minutes, where others take milliseconds."""
MOST_DEBT = 1000.0 * MOST_WORK
"""Parts beyond that mean that are lent, so that a stiff start does not end a run."""


@jit
def owe(debt: float, parts: float) -> float:
    """Return the parts owed after a step that took `parts` of them: what exceeds `MOST_WORK`, less what was saved."""
    return max(0.0, debt + parts - MOST_WORK)
