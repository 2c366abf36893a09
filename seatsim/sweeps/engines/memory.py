"""What a process that simulates many runs keeps of the memory that each of them frees."""

from __future__ import annotations

import ctypes

_OPTIONS = {-1: 1 << 28, -3: 1 << 25}
"""M_TRIM_THRESHOLD and M_MMAP_THRESHOLD of glibc: bytes that it keeps, and of the largest array that it keeps."""


def keep_freed_memory() -> None:
    """Have glibc give the arrays that a run has freed to the next one; with another C library nothing is changed.

    Otherwise they are returned to the system, which clears their pages again: a third of a run's time.
    """
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (AttributeError, OSError, TypeError):
        return
    for option, size in _OPTIONS.items():
        mallopt(option, size)
