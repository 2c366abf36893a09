"""Values of the printed code: a C expression with the type that numba gives it, and what is known of it beforehand."""

import math
from collections.abc import Collection
from enum import IntEnum
from typing import Any, NamedTuple

from numba import types

from seatsim.schema.errors import InputError

REAL, INTEGER, BOOLEAN, NOTHING = types.float64, types.int64, types.boolean, types.none
Rank = IntEnum("Rank", "UNARY PRODUCT SUM COMPARISON LOGIC CHOICE")
"""Ranks of C's operators, from the one that binds most; 0 is a name, a literal or a call."""
_TAKEN = """
auto break case char const continue default do double else enum extern float for goto if inline int long register
restrict return short signed sizeof static struct switch typedef union unsigned void volatile while real R main
read write time signal exp log pow tanh sin cos tan atan sqrt fabs floor ceil fmod abs round div index gamma
y0 y1 yn j0 j1 jn remove rename link select least greatest
"""
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

    def as_real(self) -> "Value":
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
    return f"{name}_" if name in _TAKEN.split() else name


def whole_as_int64(kind: types.Type) -> types.Type:
    """Return the type of a variable: one type serves all whole numbers."""
    return INTEGER if isinstance(kind, types.Integer) else kind


class Declarations:
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
        self.names[kind] = free_name(identifier(name), self.names.values())
        self.text.append(f"typedef struct {{\n{body}}} {self.names[kind]};\n")
        return self.names[kind]


def is_row(kind: types.Type) -> bool:
    """Whether a tuple is an array in C: elements of one type, without names of their own."""
    return isinstance(kind, types.UniTuple) and not isinstance(kind, types.BaseNamedTuple)


def free_name(name: str, taken: Collection[str]) -> str:
    """Return the name, with a number where it is taken."""
    if name not in taken:
        return name
    return next(f"{name}_{k}" for k in range(2, len(taken) + 3) if f"{name}_{k}" not in taken)
