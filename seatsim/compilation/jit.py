"""How the kernel and the models are compiled, in one place: machine code for what is called, and for nothing else.

numba takes every function through the optimiser to machine code, also one that its callers take in whole, and counts
references to the members of every tuple, also of one that holds numbers alone. The loop over a run is made of some
seventy such functions and of such tuples: without both it compiles in six tenths of the time, and runs as fast.
"""

from __future__ import annotations

import hashlib
import linecache
from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba
from llvmlite.binding import ModuleRef
from numba import types
from numba.core.codegen import CPUCodeLibrary, JITCPUCodegen
from numba.core.datamodel import default_manager, models
from numba.extending import overload, register_jitable

_finalize, _optimize_functions = CPUCodeLibrary.finalize, CPUCodeLibrary._optimize_functions
_set_env = JITCPUCodegen.set_env
_environments: dict[str, object] = {}
"""Python objects that inlined functions refer to, by the symbol that stands for them in the code of their callers."""


def _install() -> None:
    """Have numba do so in this process. Code of others that Python can call is compiled as ever."""
    CPUCodeLibrary.finalize, CPUCodeLibrary._optimize_functions = finalize, optimize_functions
    JITCPUCodegen.set_env = set_env
    for kind in (types.Tuple, types.NamedTuple):
        default_manager.register(kind, _Tuple)
    for kind in (types.UniTuple, types.NamedUniTuple):
        default_manager.register(kind, _UniTuple)


def finalize(library: CPUCodeLibrary) -> None:
    """End the compilation of a function: one that is inlined stays as it is written, for its callers.

    Any other links all that it inlines, with what that calls, and is optimised as one.
    """
    if _is_inlined(library._final_module):
        library._finalized = True
        return
    library._linking_libraries = _list_linked(library)
    _finalize(library)
    for variable in library._final_module.global_variables:
        if variable.name in _environments:
            _set_env(library._codegen, variable.name, _environments[variable.name])


def optimize_functions(library: CPUCodeLibrary, module: ModuleRef) -> None:
    """Optimise a module's functions one by one; those that are inlined are optimised in their callers."""
    module.data_layout = library._codegen._data_layout
    if not _is_inlined(module):
        _optimize_functions(library, module)


def set_env(codegen: JITCPUCodegen, name: str, environment: object) -> None:
    """Hand a function the Python objects that it refers to; one without machine code has them once a caller ends."""
    if codegen._engine.is_symbol_defined(name):
        _set_env(codegen, name, environment)
    else:
        _environments[name] = environment


def _is_inlined(module: ModuleRef) -> bool:
    """Return whether callers inline all functions of a module; one that Python calls has an entry besides these."""
    outer = [each for each in module.functions if not each.is_declaration and each.linkage.name == "external"]
    return bool(outer) and all(any(b"alwaysinline" in text for text in each.attributes) for each in outer)


def _list_linked(library: CPUCodeLibrary) -> list[CPUCodeLibrary]:
    """Return the libraries of what a function calls, and of what inlined functions among these call, each once.

    Each stands after all that call it: of a library that is linked before, LLVM leaves out what nothing calls yet.
    """
    ended = dict[CPUCodeLibrary, None]()

    def visit(caller: CPUCodeLibrary) -> None:
        for each in caller._linking_libraries:
            if each not in ended:
                if _is_inlined(each._final_module):
                    visit(each)
                ended[each] = None

    visit(library)
    return list(reversed(ended))


class _Uncounted(models.DataModel):  # type: ignore[misc]  # numba has no types
    """A tuple whose references are counted only where a member is."""

    def traverse(self, builder: object) -> list[object]:
        """Return the members whose references may be counted."""
        members: list[object] = super().traverse(builder) if self.contains_nrt_meminfo() else []
        return members


class _Tuple(_Uncounted, models.TupleModel):  # type: ignore[misc]
    """Of members of several types."""


class _UniTuple(_Uncounted, models.UniTupleModel):  # type: ignore[misc]
    """Of members of one type."""


_install()

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
