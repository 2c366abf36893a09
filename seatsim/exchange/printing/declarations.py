"""C types of tuples and records."""

from __future__ import annotations

from collections.abc import Collection

from numba import types

from seatsim.exchange.printing.values import (
    BOOLEAN,
    NOTHING,
    REAL,
    NotPrintableError,
    element_types,
    field_names,
    identifier,
    is_empty,
    is_tuple,
)


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
        if kind not in self.names:
            self._declare(kind)
        return self.names[kind]

    def _declare(self, kind: types.Type) -> None:
        items = element_types(kind)
        if is_row(kind):
            name, body = f"{self.name(items[0])}_{len(items)}", f"    {self.name(items[0])} at[{len(items)}];\n"
        else:
            fields = zip(field_names(kind), items, strict=True)
            body = "".join(f"    {self.name(item)} {field};\n" for field, item in fields if not is_empty(item))
            cls = getattr(kind, "instance_class", None)
            name = cls.__name__ if cls else "tuple"
        self.names[kind] = free_name(identifier(name), self.names.values())
        self.text.append(f"typedef struct {{\n{body}}} {self.names[kind]};\n")


def is_row(kind: types.Type) -> bool:
    """Whether a tuple is an array in C: elements of one type, without names of their own."""
    return isinstance(kind, types.UniTuple) and not isinstance(kind, types.BaseNamedTuple)


def free_name(name: str, taken: Collection[str]) -> str:
    """Return the name, with a number where it is taken."""
    if name not in taken:
        return name
    return next(f"{name}_{k}" for k in range(2, len(taken) + 3) if f"{name}_{k}" not in taken)
