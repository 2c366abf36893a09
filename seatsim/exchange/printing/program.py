"""A program in C that grows by the functions that are asked for, and the body of one while it is printed.

Its values are C expressions with the types that numba gives them, and what is known of them beforehand.
"""

from __future__ import annotations

import ast
import builtins
import inspect
import math
import textwrap
from collections.abc import Callable, Collection
from enum import IntEnum
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numba import types

from seatsim.compilation.jit import GENERIC
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError

REAL, INTEGER, BOOLEAN, NOTHING = types.float64, types.int64, types.boolean, types.none
Rank = IntEnum("Rank", "UNARY PRODUCT SUM COMPARISON LOGIC CHOICE")
"""Ranks of C's operators, from the one that binds most; 0 is a name, a literal or a call."""
_TAKEN = Path(__file__).parents[1].joinpath("c", "taken.txt").read_text().split()
"""Words of C and of its library."""


UNKNOWN = object()
"""What is only known when the code runs."""


class NotPrintableError(InputError):
    """A function uses what has no counterpart in the printed C."""


class Value(NamedTuple):
    """A value: C expression, type, what it is if that is known, and whether repeating the expression costs nothing.

    `shape` is that of an array, `rank` that of the outermost operator (see `Rank`). A value without
    type is a Python object that exists while the code is printed only: a module, a function, a class.
    """

    code: str
    type: types.Type  # or None
    known: Any = UNKNOWN  # a number, a tuple, a function, a class or a module
    plain: bool = True
    shape: tuple[int, ...] = ()
    rank: int = 0

    @property
    def is_empty(self) -> bool:
        """Whether the value holds no number, so that it has no counterpart in C."""
        return is_empty(self.type)

    def within(self, most: int) -> str:
        """Return the expression, in brackets where its outermost operator has a rank above `most`."""
        return f"({self.code})" if self.rank > most else self.code

    def as_real(self) -> Value:
        """Return a number as a real one, by a cast where it is a whole one that is known only when the code runs."""
        if self.type == REAL:
            return self
        if is_known(self):
            return number(float(self.known))
        return Value(f"(real){self.within(Rank.UNARY)}", REAL, plain=False, rank=Rank.UNARY)


class Signature(NamedTuple):
    """Type of an argument, with the shape of an array."""

    type: types.Type
    shape: tuple[int, ...] = ()


def is_known(*values: Value) -> bool:
    """Whether all values are known beforehand."""
    return all(value.known is not UNKNOWN for value in values)


def number(value: float | bool) -> Value:
    """Return a number as a literal."""
    if isinstance(value, bool):
        return Value(str(int(value)), BOOLEAN, value)
    if isinstance(value, int):
        return Value(str(value), INTEGER, value, rank=0 if value >= 0 else Rank.UNARY)
    value = float(value)
    if math.isnan(value):
        return Value("R_NAN", REAL, value)
    if math.isinf(value):
        return Value("R_INFINITY", REAL, value) if value > 0 else Value("-R_INFINITY", REAL, value, rank=Rank.UNARY)
    negative = math.copysign(1.0, value) < 0.0
    return Value(f"-R({-value!r})", REAL, value, rank=Rank.UNARY) if negative else Value(f"R({value!r})", REAL, value)


def is_tuple(kind: object) -> bool:
    """Whether a type is that of a tuple or record."""
    return isinstance(kind, types.BaseTuple)


def is_empty(kind: types.Type) -> bool:
    """Whether a type holds no number, so that it has no counterpart in C."""
    return kind is NOTHING or (is_tuple(kind) and all(map(is_empty, kind)))


def field_names(kind: types.Type) -> tuple[str, ...]:
    """Return the C names of a record's fields, or of a tuple of several types."""
    cls = getattr(kind, "instance_class", None)
    return tuple(map(identifier, cls._fields)) if cls else tuple(f"item{k}" for k in range(len(kind)))


def identifier(name: str) -> str:
    """Return a name that C permits and that is not taken by its library."""
    return f"{name}_" if name in _TAKEN else name


def whole_as_int64(kind: types.Type) -> types.Type:
    """Return the type of a variable: one type serves all whole numbers."""
    return INTEGER if isinstance(kind, types.Integer) else kind


class _Declarations:
    """The structs of a program, in the order in which C must see them."""

    def __init__(self) -> None:
        self.names: dict[types.Type, str] = {}
        self.text: list[str] = []

    def name(self, kind: types.Type) -> str:
        """Return the C name of a type, declared before if it is a struct."""
        if kind == REAL:
            return "real"
        if isinstance(kind, types.Array):
            return "real *" if kind.mutable else "const real *"
        if kind == BOOLEAN or isinstance(kind, types.Integer):
            return "int"
        if kind is NOTHING or is_empty(kind):
            return "void"
        if not is_tuple(kind):
            raise NotPrintableError(f"a value of type {kind} has no counterpart in C")
        if kind in self.names:
            return self.names[kind]
        items = tuple(kind)
        if is_row(kind):
            name, body = f"{self.name(items[0])}_{len(items)}", f"    {self.name(items[0])} at[{len(items)}];\n"
        else:
            fields = zip(field_names(kind), items, strict=True)
            body = "".join(f"    {self.name(item)} {field};\n" for field, item in fields if not is_empty(item))
            cls = getattr(kind, "instance_class", None)
            name = cls.__name__ if cls else "tuple"
        self.names[kind] = _free_name(identifier(name), self.names.values())
        self.text.append(f"typedef struct {{\n{body}}} {self.names[kind]};\n")
        return self.names[kind]


def is_row(kind: types.Type) -> bool:
    """Whether a tuple is an array in C: elements of one type, without names of their own."""
    return isinstance(kind, types.UniTuple) and not isinstance(kind, types.BaseNamedTuple)


def _free_name(name: str, taken: Collection[str]) -> str:
    """Return the name, with a number where it is taken."""
    if name not in taken:
        return name
    return next(f"{name}_{k}" for k in range(2, len(taken) + 3) if f"{name}_{k}" not in taken)


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
        self.types = _Declarations()
        self.functions: list[str] = []
        self.tables: list[str] = []
        self._printed: dict[tuple[object, tuple[Signature, ...]], Printed] = {}
        self._forms: dict[tuple[object, tuple[types.Type, ...]], Callable[..., object] | None] = {}
        self._names: set[str] = set()
        self._table_names: dict[bytes, str] = {}

    def function(self, function: Callable[..., object], arguments: tuple[Signature, ...]) -> Printed:
        """Return the printed function for arguments of these types; it is printed when it is first asked for."""
        key = (function, arguments)
        if key not in self._printed:
            name = _free_name(_function_name(function), self._names)
            self._names.add(name)
            self._printed[key] = self.translate(self, function, name, arguments)
        return self._printed[key]

    def form(self, generic: Callable[..., object], arguments: tuple[types.Type, ...]) -> Callable[..., object] | None:
        """Return the form of a generic function for arguments of these types, the same one every time."""
        key = (generic, arguments)
        if key not in self._forms:
            self._forms[key] = GENERIC[generic](*arguments)
        return self._forms[key]

    def table(self, array: Array) -> Value:
        """Return a constant array, as a table that is printed once."""
        flat = np.ascontiguousarray(array, dtype=np.float64)
        key = flat.tobytes()
        if key not in self._table_names:
            name = self._table_names[key] = f"table_{len(self._table_names) + 1}"
            numbers = textwrap.fill(", ".join(number(float(v)).code for v in flat.ravel()), 110)
            self.tables.append(f"static const real {name}[{flat.size}] = {{\n{textwrap.indent(numbers, '    ')}\n}};\n")
        return Value(self._table_names[key], types.Array(REAL, flat.ndim, "C", readonly=True), array, True, flat.shape)

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


def source_of(function: Callable[..., object], kind: type[_N]) -> _N:
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


class Scope:
    """Variables and lines of the function that is being printed."""

    def __init__(self, program: Program, function: Callable[..., object], assigned: dict[str, int]) -> None:
        self.program = program
        self.function = function
        self.assigned = assigned
        self.variables: dict[str, Value] = {}
        self.declared: list[str] = []
        self.lines: list[str] = []
        self.depth = 1
        self.results: list[Value] = []
        self._names: set[str] = set()

    def refuse(self, node: ast.AST, why: str) -> NotPrintableError:
        """Return the error of what cannot be printed, with the function and the line of it."""
        place = f"{self.function.__module__}.{self.function.__qualname__}"
        return NotPrintableError(f"{place}: '{ast.unparse(node)[:80]}' cannot be exported to C: {why}")

    def write(self, line: str) -> None:
        """Add a line."""
        self.lines.append("    " * self.depth + line)

    def name(self, wanted: str) -> str:
        """Return a name for a variable that is free within the function."""
        name = _free_name(identifier(wanted), self._names)
        self._names.add(name)
        return name

    def assign(self, name: str, value: Value) -> None:
        """Assign a value to the variable that Python calls `name`."""
        before = self.variables.get(name)
        known = value.known if self.assigned.get(name, 0) <= 1 else UNKNOWN
        if value.type is None or value.is_empty or known is not UNKNOWN or value.shape:
            # Nothing to compute: the value itself stands for the variable.
            self.variables[name] = value
            return
        kind = whole_as_int64(value.type)
        if before is None or before.type != kind or before.known is not UNKNOWN:
            self._declare(name, kind, value.code)
        else:
            self.write(f"{before.code} = {value.code};")

    def _declare(self, name: str, kind: types.Type, code: str) -> None:
        variable = self.name(name)
        self.variables[name] = Value(variable, kind)
        if self.depth == 1:
            self.write(f"{self.program.types.name(kind)} {variable} = {code};")
        else:
            self.declared.append(f"    {self.program.types.name(kind)} {variable};")
            self.write(f"{variable} = {code};")

    def keep(self, value: Value) -> Value:
        """Return a value whose expression may be repeated, held in a variable of its own where it costs anything."""
        if value.plain or value.is_empty:
            return value
        name = self.name("part")
        self.write(f"const {self.program.types.name(value.type)} {name} = {value.code};")
        return value._replace(code=name, plain=True, rank=0)

    def look_up(self, name: str) -> object:
        """Return the Python object of a name outside the function's own variables."""
        code = self.function.__code__
        if name in code.co_freevars:
            return (self.function.__closure__ or ())[code.co_freevars.index(name)].cell_contents
        found = self.function.__globals__.get(name, UNKNOWN)
        return getattr(builtins, name, UNKNOWN) if found is UNKNOWN else found


def build_tuple(scope: Scope, items: list[Value], cls: type | None = None) -> Value:
    """Return a tuple, or a record of a class, of these elements."""
    kind = types.BaseTuple.from_types(tuple(whole_as_int64(item.type) for item in items), cls)
    known = tuple(item.known for item in items) if items and is_known(*items) else UNKNOWN
    if is_empty(kind):
        return Value("", kind)
    listed = ", ".join(item.code for item in items if not item.is_empty)
    name = scope.program.types.name(kind)
    return Value(f"({name}){{{{{listed}}}}}" if is_row(kind) else f"({name}){{{listed}}}", kind, known, False)


def element(scope: Scope, owner: Value, index: int | Value) -> Value:
    """Return one element of a tuple, by its position or, where all have one type, by a number known later."""
    if isinstance(index, Value):
        if not is_row(owner.type):
            raise TypeError("the position in a tuple of several types must be a constant")
        return Value(f"{scope.keep(owner).code}.at[{index.code}]", owner.type.dtype)
    index %= len(owner.type)
    kind = tuple(owner.type)[index]
    if isinstance(owner.known, tuple) and not isinstance(owner.known[index], tuple):
        return number(owner.known[index])
    if is_empty(kind):
        return Value("", kind)
    held = scope.keep(owner)
    if is_row(owner.type):
        return Value(f"{held.code}.at[{index}]", kind)
    return Value(f"{held.code}.{field_names(owner.type)[index]}", kind)


def part(scope: Scope, owner: Value, span: slice) -> Value:
    """Return a part of a tuple as a tuple."""
    positions = range(*span.indices(len(owner.type)))
    if len(positions) == len(owner.type) and not isinstance(owner.type, types.BaseNamedTuple):
        return owner
    return build_tuple(scope, [element(scope, held, k) for held in [scope.keep(owner)] for k in positions])
