"""How the kernel and the models are compiled, in one place."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numba
from numba.extending import register_jitable

F = TypeVar("F", bound=Callable[..., Any])

ARITHMETIC: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract", "reassoc", "arcp", "nsz"}}
"""Division by zero gives inf or NaN; sums may be fused and reordered, but NaN and inf keep their meaning."""
INLINED: dict[str, Any] = ARITHMETIC | {"forceinline": True, "no_cfunc_wrapper": True}
"""For what is called from compiled code only: an entry point of its own would cost compile time."""


def jit(function: F) -> F:
    """Let compiled code call a function, inlined; called from Python it stays what it is."""
    registered: F = register_jitable(**INLINED)(function)
    return registered


def jit_apart(function: F) -> F:
    """Compile a function that is seldom called, apart from its callers, so that these keep to the registers."""
    called: F = numba.njit(no_cfunc_wrapper=True, **ARITHMETIC)(function)
    return called
