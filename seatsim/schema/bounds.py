"""How much a file may make: counted from what it states, before any of it is made.

A few bytes can state a large array, refer to the same part over and over, or lead back to themselves. Every reader
whose format permits that counts here what it is about to make, and one limit holds for all of them.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from typing import NamedTuple

from seatsim.schema.guarded import in_mib

LEAST, LARGEST = 2**24, 2**30
"""Bytes that any file may make, and up to which it may make more than a number of each of its bytes."""
TIMES, BYTES_OF_NUMBER = 100, 8
"""How many times its size a file may make: where it is packed or doubled, and where each byte becomes a number."""
BYTES_OF_PART = 256
"""Bytes that a part takes in memory, however small it is: a channel, a group, a text."""


class TooMuchError(ValueError):
    """What a file states is beyond what may be made of it."""


class Part(NamedTuple):
    """The bytes that a part of a file makes, and the parts that it refers to."""

    size: int
    refers_to: tuple[Hashable, ...] = ()


def permitted_of(size: int) -> int:
    """Return how many bytes a file of `size` bytes may make."""
    return max(LEAST, min(LARGEST, TIMES * size), BYTES_OF_NUMBER * size)


def check_made(made: float, size: int, what: str = "what it states") -> None:
    """Raise TooMuchError where `made` bytes are more than a file of `size` bytes may make."""
    permitted = permitted_of(size)
    if made > permitted:
        raise TooMuchError(
            f"{what} would take at least {in_mib(made)} of memory; permitted for a file of {in_mib(size)} are"
            f" {in_mib(permitted)} ({TIMES} times its size, at least {in_mib(LEAST)}, up to {in_mib(LARGEST)})"
        )


def check_parts(roots: Iterable[Hashable], part: Callable[[Hashable], Part], size: int) -> None:
    """Check all parts of a file of `size` bytes, each counted as often as something refers to it.

    `part` returns the part of a name, such as its address. Every part is looked at once.

    Raises:
        TooMuchError: a part refers to itself over others, or all together make too much.
    """
    made: dict[Hashable, int] = {}
    open_parts: dict[Hashable, Part] = {}
    stack = list(roots)[::-1]
    top = list(stack)
    while stack:
        name = stack[-1]
        if name in made:
            stack.pop()
            continue
        if name in open_parts:
            own, others = open_parts.pop(name)
            made[name] = own + BYTES_OF_PART + sum(made[each] for each in others)
            check_made(made[name], size)
            stack.pop()
            continue
        found = open_parts[name] = part(name)
        check_made(found.size, size)
        if any(each in open_parts for each in found.refers_to):
            raise TooMuchError(f"a part of it refers to itself over others ({getattr(name, 'name', name)})")
        stack += found.refers_to
        check_made(BYTES_OF_PART * len(stack), size)
    check_made(sum(made[each] for each in top), size)
