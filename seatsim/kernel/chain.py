"""What several effects do together: one generic function per hook, unrolled over a tuple of effect records.

Each record answers to the hooks that it has methods for; the others cost nothing. `z` is the state of all records of
the tuple, one after another; a method `f(self, ..., z)` gets its own part of it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from numba import types
from numba.extending import overload

from seatsim.compilation.jit import INLINED, jit
from seatsim.kernel.generic import Tuple
from seatsim.schema.registry import specification_of

Effects = tuple[Any, ...]


def state_of(classes: Sequence[type]) -> Tuple:
    """Return the state at rest of records of these classes."""
    return tuple(value for cls in classes for value in specification_of(cls).initial)


def _parts(classes: Sequence[type], name: str) -> Iterator[tuple[int, Callable[..., Any], slice]]:
    """Yield index, method and part of the state of every class that has the method."""
    start = 0
    for index, cls in enumerate(classes):
        end = start + len(specification_of(cls).initial)
        if hasattr(cls, name):
            yield index, getattr(cls, name), slice(start, end)
        start = end


def _chain(name: str, first: str, line: str, last: str) -> Callable[..., Any]:
    """Make a generic function `f(effects, z, *args)` out of the source of its body.

    The body is `first`, then `line` for each record that has the method, then `last`; `{call}` in a line is the
    method's call, `r` the result so far, `a0, a1, ...` the arguments.
    """

    def build(classes: Sequence[type], count: int) -> Callable[..., Any]:
        arguments = [f"a{k}" for k in range(count)]
        body, namespace = [first], {}
        for index, method, part in _parts(classes, name):
            namespace[f"m{index}"] = jit(method)
            given = ", ".join([f"effects[{index}]", *arguments, f"z[{part.start}:{part.stop}]"])
            body.append(line.format(call=f"m{index}({given})"))
        source = "\n    ".join([f"def impl({', '.join(['effects', 'z', *arguments])}):", *body, last])
        exec(source, namespace)
        implementation: Callable[..., Any] = namespace["impl"]
        return implementation

    def generic(effects: Effects, z: Tuple, *args: Any) -> Any:
        return build([type(effect) for effect in effects], len(args))(effects, z, *args)

    def resolve(effects: Any, z: Any, *args: Any) -> Callable[..., Any] | None:
        if not isinstance(effects, types.BaseTuple):
            return None
        return build([kind.instance_class for kind in effects.types], len(args))

    generic.__name__ = generic.__qualname__ = name
    overload(generic, strict=False, jit_options=INLINED)(resolve)
    return generic


def summed(name: str) -> Callable[..., Any]:
    """Make the sum of the records' answers, 0 where none answers."""
    return _chain(name, "r = 0.0", "r += {call}", "return r")


def folded(name: str) -> Callable[..., Any]:
    """Make the function that hands its first argument from record to record, each of which may change it."""
    return _chain(name, "", "a0 = {call}", "return a0")


def joined(name: str) -> Callable[..., Any]:
    """Make the tuple of the records' tuples, one after another, as the states are."""
    return _chain(name, "r = ()", "r = r + {call}", "return r")


def before(effects: Effects, z: Tuple) -> Tuple:
    """Return the head of a state, in front of the part that belongs to the effects."""
    return z[: len(z) - len(state_of([type(effect) for effect in effects]))]


def own(effects: Effects, z: Tuple) -> Tuple:
    """Return the tail of a state, which belongs to the effects."""
    return z[len(z) - len(state_of([type(effect) for effect in effects])) :]


@overload(before, strict=False, jit_options=INLINED)
def _before(effects: Any, z: Any) -> Callable[..., Any]:
    end = len(z) - len(state_of([kind.instance_class for kind in effects.types]))
    return lambda effects, z: z[:end]


@overload(own, strict=False, jit_options=INLINED)
def _own(effects: Any, z: Any) -> Callable[..., Any]:
    start = len(z) - len(state_of([kind.instance_class for kind in effects.types]))
    return lambda effects, z: z[start:]
