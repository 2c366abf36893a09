"""Functions: their parameters, their types and what they return."""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Callable
from types import FunctionType
from typing import cast

from numba import types

from seatsim.exchange.printing.program import Printed, Program, Scope, origin, source_of
from seatsim.exchange.printing.statements import print_body
from seatsim.exchange.printing.values import (
    REAL,
    UNARY,
    UNKNOWN,
    NotPrintableError,
    Signature,
    Value,
    is_empty,
    is_tuple,
    whole_as_int64,
)


def print_function(
    program: Program, function: Callable[..., object], name: str, arguments: tuple[Signature, ...]
) -> Printed:
    """Print a function for arguments of these types.

    Raises:
        NotPrintableError: it uses what has no counterpart in C.
    """
    definition = source_of(cast(FunctionType, function), ast.FunctionDef)
    names = [argument.arg for argument in definition.args.args]
    scope = Scope(program, function, _count_assignments(definition, names))
    parameters = [_parameter(scope, *pair) for pair in zip(names, arguments, strict=True)]
    given = list(map(scope.variables.__getitem__, names))
    ends = print_body(definition.body, scope)
    if not ends:
        raise NotPrintableError(f"{origin(function)}: not every path returns a value, so that it cannot be exported")
    result = _common_type(scope, definition)
    if len(scope.results) == 1 and _is_straight(definition):
        (only,) = scope.results
        kept = [scope.assigned[parameter] == 1 for parameter in names]
        passed = [k for k, value in enumerate(given) if value is only and kept[k]]
        if passed:
            return Printed(name, result, passed=passed[0])
        if only.known is not UNKNOWN and not is_tuple(only.type):
            return Printed(name, result, value=only)
    if not is_empty(result):
        program.functions.append(_definition(program, function, name, result, parameters, scope))
    return Printed(name, result)


def _parameter(scope: Scope, name: str, argument: Signature) -> str:
    """Enter a parameter among the variables, and return how C declares it; of an empty one there is nothing."""
    kind = whole_as_int64(argument.type)
    if is_empty(kind):
        scope.variables[name] = Value("", kind)
        return ""
    code, written = scope.name(name), scope.program.types.name(kind)
    if not scope.program.takes_address(scope.function, kind):
        scope.variables[name] = Value(code, kind, shape=argument.shape)
        return f"{written} {code}".replace("* ", "*")
    if scope.assigned[name] == 1:
        scope.variables[name] = Value(f"*{code}", kind, rank=UNARY)
        return f"const {written} *{code}"
    given = scope.name(f"{name}_given")
    scope.write(f"{written} {code} = *{given};")
    scope.variables[name] = Value(code, kind)
    return f"const {written} *{given}"


def _definition(
    program: Program,
    function: Callable[..., object],
    name: str,
    result: types.Type,
    parameters: list[str],
    scope: Scope,
) -> str:
    """Return the text of a function."""
    listed = ", ".join(filter(None, parameters))
    # What is compiled apart for Python is so here: it is seldom called.
    kind = "CALLED" if function in program.apart else "INLINED"
    head = f"{kind} {program.types.name(result)} {name}({listed or 'void'})"
    lines = [*scope.declared, *_used(scope.lines)]
    return "\n".join([f"/* {origin(function)} */", head, "{", *_unused(parameters, lines), *lines, "}", ""])


def _unused(parameters: list[str], lines: list[str]) -> list[str]:
    """Return statements that name the parameters without a use, such as the state of a damper that has none."""
    names = [re.split(r"\W+", parameter)[-1] for parameter in parameters if parameter]
    return [f"    (void){name};" for name in names if not any(re.search(rf"\b{name}\b", line) for line in lines)]


def _used(lines: list[str]) -> list[str]:
    """Return the lines without variables that nothing uses, such as the state of effects that do not ask for it."""
    for k in range(len(lines) - 1, -1, -1):
        found = re.match(r"    +(?:const )?\w+ (\w+) = ", lines[k])
        if found and not any(re.search(rf"\b{found[1]}\b", line) for line in lines[k + 1 :]):
            lines = [*lines[:k], *lines[k + 1 :]]
    return lines


def _count_assignments(definition: ast.FunctionDef, names: list[str]) -> dict[str, int]:
    """Return in how many places each variable is assigned; a call assigns a parameter once."""
    found = Counter(names)
    for node in ast.walk(definition):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            found[node.id] += 1
    return dict(found)


def _common_type(scope: Scope, definition: ast.FunctionDef) -> types.Type:
    kinds = list(dict.fromkeys(whole_as_int64(result.type) for result in scope.results))
    if len(kinds) > 1 and not any(map(is_tuple, kinds)):
        return REAL
    if len(kinds) > 1:
        raise scope.refuse(definition, f"it returns several types: {', '.join(map(str, kinds))}")
    return kinds[0]


def _is_straight(definition: ast.FunctionDef) -> bool:
    return not any(isinstance(node, ast.If | ast.For | ast.While) for node in ast.walk(definition))
