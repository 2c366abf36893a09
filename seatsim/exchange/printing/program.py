"""A program in C that grows by the functions that are asked for, each printed once for the types it is called with."""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Callable
from types import FunctionType
from typing import NamedTuple, TypeVar

import numpy as np
from numba import types

from seatsim.compilation.jit import GENERIC
from seatsim.exchange.printing.values import (
    REAL,
    Declarations,
    NotPrintableError,
    Signature,
    Value,
    free_name,
    is_empty,
    is_tuple,
    number,
)
from seatsim.schema.arrays import Array

_N = TypeVar("_N", bound=ast.AST)


class Printed(NamedTuple):
    """A printed function: C name, type that it returns, and its value where that is a number or one of its arguments.

    `value` is the number, `passed` the position of the argument; a call of such a function need not be printed.
    """

    name: str
    result: types.Type
    value: Value | None = None
    passed: int | None = None


class Program:
    """The structs, tables and functions of a program, each in the order in which C must see them."""

    def __init__(self, translate: Callable[[Program, Callable[..., object], str, tuple[Signature, ...]], Printed]):
        self.translate = translate
        self.types = Declarations()
        self.functions: list[str] = []
        self.tables: list[str] = []
        self._printed: dict[tuple[object, tuple[Signature, ...]], Printed] = {}
        self._forms: dict[tuple[object, tuple[types.Type, ...]], Callable[..., object] | None] = {}
        self._names: set[str] = set()
        self.apart: set[object] = set()  # functions that are called, not put where they are called
        self._table_names: dict[bytes, str] = {}

    def function(self, function: Callable[..., object], arguments: tuple[Signature, ...]) -> Printed:
        """Return the printed function for arguments of these types; it is printed when it is first asked for."""
        key = (function, arguments)
        if key not in self._printed:
            name = free_name(_function_name(function), self._names)
            self._names.add(name)
            self._printed[key] = self.translate(self, function, name, arguments)
        return self._printed[key]

    def takes_address(self, function: Callable[..., object], kind: types.Type) -> bool:
        """Return whether a function takes the address of an argument of this type.

        What is inlined takes addresses of records, and nothing is copied. What is called takes copies: a caller whose
        records a function might see has to keep them in memory.
        """
        return is_tuple(kind) and not is_empty(kind) and function not in self.apart

    def form(self, generic: Callable[..., object], arguments: tuple[types.Type, ...]) -> Callable[..., object] | None:
        """Return the form of a generic function for arguments of these types, the same one every time."""
        key = (generic, arguments)
        if key not in self._forms:
            self._forms[key] = GENERIC[generic](*arguments)
        return self._forms[key]

    def table(self, values: Array) -> Value:
        """Return a constant array, as a table that is printed once."""
        flat = np.ascontiguousarray(values, dtype=np.float64)
        key = flat.tobytes()
        if key not in self._table_names:
            name = self._table_names[key] = f"table_{len(self._table_names) + 1}"
            numbers = textwrap.fill(", ".join(number(float(v)).code for v in flat.ravel()), 110)
            self.tables.append(f"static const real {name}[{flat.size}] = {{\n{textwrap.indent(numbers, '    ')}\n}};\n")
        return Value(self._table_names[key], types.Array(REAL, flat.ndim, "C", readonly=True), values, True, flat.shape)

    def source(self) -> str:
        """Return the text of structs, tables and functions."""
        return "\n".join([*self.types.text, *self.tables, *self.functions])


def _function_name(function: Callable[..., object]) -> str:
    """Return a name in C that no variable has: a method's with its class before it, any other with its module."""
    owner, _, name = function.__qualname__.rpartition(".")
    return f"{owner.rpartition('.')[2] or function.__module__.rpartition('.')[2]}_{name.lstrip('_')}"


def origin(function: Callable[..., object]) -> str:
    """Return the full name of a Python function, and its first sentence."""
    words = (inspect.getdoc(function) or "").partition("\n")[0].replace("*/", "* /")
    return f"{function.__module__}.{function.__qualname__}" + (f": {words}" if words else "")


def source_of(function: FunctionType, kind: type[_N]) -> _N:
    """Return the definition of a function, or of a lambda, the only one of its line.

    Raises:
        NotPrintableError: its source is not at hand.
    """
    try:
        tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    except (OSError, SyntaxError) as error:
        raise NotPrintableError(
            f"{function.__module__}.{function.__qualname__}: its source is not at hand, so that it cannot be exported"
        ) from error
    return next(node for node in ast.walk(tree) if isinstance(node, kind))
