"""Tuples and records as structs: built, taken apart, indexed."""

from __future__ import annotations

import ast

from numba import types

from seatsim.exchange.printing.declarations import is_row
from seatsim.exchange.printing.scope import Scope
from seatsim.exchange.printing.values import (
    REAL,
    UNKNOWN,
    Value,
    element_types,
    field_names,
    is_empty,
    is_known,
    number,
    tuple_type,
    whole_as_int64,
)


def build_tuple(scope: Scope, items: list[Value], cls: type | None = None) -> Value:
    """Return a tuple, or a record of a class, of these elements."""
    kind = tuple_type(tuple(whole_as_int64(item.type) for item in items), cls)
    known = tuple(item.known for item in items) if items and is_known(*items) else UNKNOWN
    if is_empty(kind):
        return Value("", kind)
    listed = ", ".join(item.code for item in items if not is_empty(item.type))
    name = scope.program.types.name(kind)
    return Value(f"({name}){{{{{listed}}}}}" if is_row(kind) else f"({name}){{{listed}}}", kind, known, False)


def element(scope: Scope, owner: Value, index: int | Value, node: ast.AST | None = None) -> Value:
    """Return one element of a tuple, by its position or, where all have one type, by a number known later."""
    if isinstance(index, Value):
        if not is_row(owner.type):
            raise scope.refuse(node or ast.Pass(), "the position in a tuple of several types must be a constant")
        return Value(f"{_member(scope.keep(owner))}at[{index.code}]", owner.type.dtype)
    index %= len(owner.type)
    if isinstance(owner.known, tuple):
        return _known_element(scope, owner, index)
    kind = element_types(owner.type)[index]
    if is_empty(kind):
        return Value("", kind)
    held = scope.keep(owner)
    if is_row(owner.type):
        return Value(f"{_member(held)}at[{index}]", kind)
    return Value(f"{_member(held)}{field_names(owner.type)[index]}", kind)


def address(scope: Scope, record: Value) -> str:
    """Return the address of a record, which is put into memory of its own where it is in none."""
    if record.code.startswith("*"):
        return record.code[1:]
    if record.plain:
        return f"&{record.code}"
    return f"(const {scope.program.types.name(record.type)}[1]){{{record.code}}}"


def _member(owner: Value) -> str:
    """Return what stands before the name of a member of a record or of what a pointer points to."""
    return f"{owner.code[1:]}->" if owner.code.startswith("*") else f"{owner.code}."


def _known_element(scope: Scope, owner: Value, index: int) -> Value:
    found = owner.known[index]  # type: ignore[index]  # a tuple
    if not isinstance(found, tuple):
        return number(found)
    kinds = element_types(element_types(owner.type)[index])
    return build_tuple(scope, [number(float(v) if k == REAL else v) for v, k in zip(found, kinds, strict=True)])


def field(scope: Scope, owner: Value, name: str) -> Value:
    """Return a field of a record."""
    return element(scope, owner, owner.type.fields.index(name))


def part(scope: Scope, owner: Value, span: slice) -> Value:
    """Return a part of a tuple as a tuple."""
    positions = range(*span.indices(len(owner.type)))
    if len(positions) == len(owner.type) and not isinstance(owner.type, types.BaseNamedTuple):
        return owner
    return build_tuple(scope, [element(scope, held, k) for held in [scope.keep(owner)] for k in positions])
