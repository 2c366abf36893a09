"""How much may be made: counted from what a file states, or a run needs, before any of it is made.

A few bytes can state a large array, refer to the same part over and over, or lead back to themselves. Every reader
whose format permits that counts here what it is about to make, and one limit holds for all of them.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Hashable, Iterable
from pathlib import Path
from typing import NamedTuple

from seatsim.schema.errors import InputError
from seatsim.schema.guarded import in_mib

_LEAST, _LARGEST = 2**24, 2**30
"""Bytes that any file may make, and up to which it may make more than a number of each of its bytes."""
_TIMES, BYTES_OF_NUMBER = 100, 8
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
    return max(_LEAST, min(_LARGEST, _TIMES * size), BYTES_OF_NUMBER * size)


def check_made(made: float, size: int, what: str = "what it states") -> None:
    """Raise TooMuchError where `made` bytes are more than a file of `size` bytes may make."""
    permitted = permitted_of(size)
    if made > permitted:
        raise TooMuchError(
            f"{what} would take at least {in_mib(made)} of memory; permitted for a file of {in_mib(size)} are"
            f" {in_mib(permitted)} ({_TIMES} times its size, at least {in_mib(_LEAST)}, up to {in_mib(_LARGEST)})"
        )


def check_parts(roots: Iterable[Hashable], part: Callable[[Hashable], Part], size: int) -> None:
    """Check all parts of a file of `size` bytes, each counted as often as something refers to it.

    `part` returns the part of a name, such as its address. Every part is looked at once.

    Raises:
        TooMuchError: a part refers to itself over others, or all together make too much.
    """
    made: dict[Hashable, int] = {}
    open_parts: dict[Hashable, Part] = {}
    top = list(roots)
    stack = top[::-1]
    while stack:
        name = stack[-1]
        if name in open_parts:
            own, others = open_parts.pop(name)
            made[name] = own + BYTES_OF_PART + sum(made[each] for each in others)
            check_made(made[name], size)
        if name in made:
            stack.pop()
            continue
        found = open_parts[name] = part(name)
        check_made(found.size, size)
        if any(each in open_parts for each in found.refers_to):
            raise TooMuchError(f"a part of it refers to itself over others ({getattr(name, 'name', name)})")
        stack += found.refers_to
        check_made(BYTES_OF_PART * len(stack), size)
    check_made(sum(made[each] for each in top), size)


_NUMBERS_OF_STEP = 60
"""Numbers that a simulated step takes: inputs, channels of the history, and copies of some."""


def check_memory(size: float, what: str, remedy: str) -> None:
    """Raise InputError where `what` needs more bytes than there are; `remedy` is what to do about it."""
    there = find_available()
    if there is not None and size > there:
        raise InputError(f"{what} need {in_mib(size)} of memory, where {in_mib(there)} are free; {remedy}")


def check_steps(steps: float) -> None:
    """Raise InputError where a simulation of so many steps does not fit into the memory."""
    shown = f"{steps:,.0f}".replace(",", " ")
    check_memory(8.0 * _NUMBERS_OF_STEP * steps, f"{shown} steps", "shorten the run, or raise solver.step")


def find_available() -> int | None:
    """Return how many bytes of memory can be taken without swapping, None where the system does not say."""
    try:
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
        return next(1024 * int(line.split()[1]) for line in lines if line.startswith("MemAvailable"))
    except (OSError, ValueError, StopIteration):
        pass
    try:
        return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, OSError, ValueError):
        return None
