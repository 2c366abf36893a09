"""How the kernel and the models are compiled, in one place."""

from __future__ import annotations

import hashlib
import linecache
from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba
from numba.extending import overload, register_jitable

from seatsim.compilation import lean_code

lean_code.install()

_F = TypeVar("_F", bound=Callable[..., object])
_Resolve = Callable[..., Callable[..., object] | None]

ARITHMETIC: dict[str, object] = {"error_model": "numpy", "fastmath": {"contract", "reassoc", "arcp", "nsz"}}
"""Division by zero gives inf or NaN; sums may be fused and reordered, but NaN and inf keep their meaning.

The kernel looks for NaN to tell that a solution is lost, and marks what is absent by it: `nnan` and `ninf` would let
the compiler drop both.
"""
INLINED: dict[str, object] = ARITHMETIC | {"forceinline": True, "no_cfunc_wrapper": True}
"""For what is called from compiled code only: an entry point of its own would cost compile time."""


def jit(function: _F) -> _F:
    """Return `function` such that compiled code may call it, inlined; called from Python it stays what it is."""
    compiled: _F = register_jitable(**INLINED)(function)
    return compiled


def jit_apart(function: _F) -> _F:
    """Return `function` compiled apart from its callers, so that these keep to the registers: it is seldom called."""
    compiled: _F = numba.njit(no_cfunc_wrapper=True, **ARITHMETIC)(function)
    return compiled


GENERIC: dict[object, _Resolve] = {}
"""Functions whose form depends on the types of their arguments, and what gives the form for types of numba."""


def specialise(generic: Callable[..., object]) -> Callable[[_Resolve], _Resolve]:
    """Return a decorator of the function that gives the form of `generic`, to be inlined, for arguments of types.

    Without numba's `strict` the arguments of both may have different names.
    """

    def enter(resolve: _Resolve) -> _Resolve:
        GENERIC[generic] = resolve
        overload(generic, strict=False, jit_options=INLINED)(resolve)
        return resolve

    return enter


def define(source: str, name: str, namespace: dict[str, Any]) -> Callable[..., Any]:
    """Return the function `name` that a source defines; its lines can be shown and read, as those of a file can."""
    file = f"<{name} {hashlib.sha256(source.encode()).hexdigest()[:16]}>"
    linecache.cache[file] = (len(source), None, source.splitlines(keepends=True), file)
    exec(compile(source, file, "exec"), namespace)
    return cast("Callable[..., Any]", namespace[name])
