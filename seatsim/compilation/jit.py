"""How the kernel and the models are compiled, in one place."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import numba
from numba.extending import register_jitable

F = TypeVar("F", bound=Callable[..., object])

ARITHMETIC: dict[str, object] = {"error_model": "numpy", "fastmath": {"contract", "reassoc", "arcp", "nsz"}}
"""Division by zero gives inf or NaN; sums may be fused and reordered, but NaN and inf keep their meaning.

The kernel looks for NaN to tell that a solution is lost, and marks what is absent by it: `nnan` and `ninf` would let
the compiler drop both.
"""
INLINED: dict[str, object] = ARITHMETIC | {"forceinline": True, "no_cfunc_wrapper": True}
"""For what is called from compiled code only: an entry point of its own would cost compile time."""


def jit(function: F) -> F:
    """Return `function` such that compiled code may call it, inlined; called from Python it stays what it is."""
    registered: F = register_jitable(**INLINED)(function)
    return registered


def jit_apart(function: F) -> F:
    """Return `function` compiled apart from its callers, so that these keep to the registers: it is seldom called."""
    called: F = numba.njit(no_cfunc_wrapper=True, **ARITHMETIC)(function)
    return called
