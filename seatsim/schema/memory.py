"""Memory that is foreseen before it is taken."""

from __future__ import annotations

import os
from pathlib import Path

from seatsim.schema.errors import InputError
from seatsim.schema.guarded import in_mib

NUMBERS_OF_STEP = 60
"""Numbers that a simulated step takes: inputs, channels of the history, and copies of some."""


def check_memory(size: float, what: str, remedy: str) -> None:
    """Raise InputError where `what` needs more bytes than there are; `remedy` is what to do about it."""
    there = find_available()
    if there is not None and size > there:
        raise InputError(f"{what} need {in_mib(size)} of memory, where {in_mib(there)} are free; {remedy}")


def check_steps(steps: float) -> None:
    """Raise InputError where a simulation of so many steps does not fit into the memory."""
    shown = f"{steps:,.0f}".replace(",", " ")
    check_memory(8.0 * NUMBERS_OF_STEP * steps, f"{shown} steps", "shorten the run, or raise solver.step")


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
