"""How the kernel is compiled, in one place."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numba

F = TypeVar("F", bound=Callable[..., Any])

ARITHMETIC: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract", "reassoc", "arcp", "nsz"}}
"""Division by zero gives inf or NaN; sums may be fused and reordered, but NaN and inf keep their meaning."""
INLINED: dict[str, Any] = ARITHMETIC | {"forceinline": True}


def jit(function: F) -> F:
    """Compile a function of the loop, inlined where it is called."""
    inlined: F = numba.njit(**INLINED)(function)
    return inlined


def jit_apart(function: F) -> F:
    """Compile a function that is seldom called, apart from its callers, so that these keep to the registers."""
    called: F = numba.njit(**ARITHMETIC)(function)
    return called
