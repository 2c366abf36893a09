"""Expressions: arithmetic, comparisons, elements of tuples and arrays, calls."""

import ast
import builtins
import inspect
import math
import operator
from collections.abc import Callable, Mapping
from types import FunctionType, ModuleType
from typing import Any

import numpy as np
from numba import types

from seatsim.compilation.jit import GENERIC
from seatsim.exchange.printing.program import (
    BOOLEAN,
    INTEGER,
    REAL,
    Rank,
    Scope,
    Signature,
    Value,
    build_tuple,
    element,
    is_known,
    is_tuple,
    number,
    part,
    source_of,
)

_ARITHMETIC: dict[type[ast.operator], tuple[str, Callable[[float, float], float]]] = {
    ast.Add: ("+", operator.add),
    ast.Sub: ("-", operator.sub),
    ast.Mult: ("*", operator.mul),
    ast.Div: ("/", operator.truediv),
    ast.FloorDiv: ("/", operator.floordiv),
    ast.Mod: ("%", operator.mod),
}
_COMPARED: dict[type[ast.cmpop], tuple[str, Callable[[float, float], bool]]] = {
    ast.Lt: ("<", operator.lt),
    ast.LtE: ("<=", operator.le),
    ast.Gt: (">", operator.gt),
    ast.GtE: (">=", operator.ge),
    ast.Eq: ("==", operator.eq),
    ast.NotEq: ("!=", operator.ne),
}
_MATHS = "exp log sqrt sin cos tan atan tanh sinh cosh expm1 copysign hypot atan2 pow"
_IN_C = (
    {name: (f"r_{name}", REAL) for name in _MATHS.split()}
    | {name: (name, BOOLEAN) for name in ("isnan", "isinf", "isfinite")}
    | {"floor": ("(int)r_floor", INTEGER), "ceil": ("(int)r_ceil", INTEGER), "abs": ("r_fabs", REAL)}
)
"""What functions of `math`, and `abs`, are called in C, and what they return."""
_UNROLLED = 4
"""Greatest power that is printed as a product, as compiled Python code computes it."""


def print_expression(node: ast.expr, scope: Scope) -> Value:  # noqa: PLR0911 - one return per kind
    """Return the value of an expression; what it needs beforehand is written to the scope."""
    match node:
        case ast.Constant(value=bool() | int() | float() as value):
            return number(value)
        case ast.Name(id=name):
            return scope.variables[name] if name in scope.variables else _known(scope.look_up(name), scope)
        case ast.Attribute():
            return _print_attribute(node, scope)
        case ast.Tuple(elts=items):
            return build_tuple(scope, _print_items(items, scope))
        case ast.BinOp(left=left, op=ast.Pow(), right=right):
            return _print_power(print_expression(left, scope), print_expression(right, scope), scope)
        case ast.BinOp(left=left, op=op, right=right):
            return arithmetic(op, print_expression(left, scope), print_expression(right, scope), scope)
        case ast.UnaryOp(op=op, operand=operand):
            return _print_unary(op, print_expression(operand, scope))
        case ast.Compare():
            return _print_comparison(node, scope)
        case ast.BoolOp():
            return _print_logic(node, scope)
        case ast.IfExp():
            return _print_choice(node, scope)
        case ast.Subscript():
            return _print_subscript(node, scope)
        case ast.Call():
            return _print_call(node, scope)
    raise TypeError(type(node))


def _print_items(nodes: list[ast.expr], scope: Scope) -> list[Value]:
    """Return the values of the items of a tuple or call; those of a tuple with a star stand one by one."""
    values = []
    for node in nodes:
        if isinstance(node, ast.Starred):
            whole = scope.keep(print_expression(node.value, scope))
            values += [element(scope, whole, k) for k in range(len(whole.type))]
        else:
            values.append(print_expression(node, scope))
    return values


def _known(thing: object, scope: Scope) -> Value:
    """Return what a global name or an attribute of a module stands for."""
    if isinstance(thing, bool | int | float):
        return number(thing)
    if isinstance(thing, np.ndarray):
        return scope.program.table(thing)
    if isinstance(thing, tuple):
        values = [_known(item, scope) for item in thing]
        return build_tuple(scope, values, type(thing) if hasattr(thing, "_fields") else None)
    if callable(thing) or isinstance(thing, ModuleType):
        return Value("", None, thing)
    raise TypeError(type(thing))


def _print_attribute(node: ast.Attribute, scope: Scope) -> Value:
    owner = print_expression(node.value, scope)
    if owner.type is None:
        return _known(getattr(owner.known, node.attr), scope)
    if node.attr in owner.type.fields:
        return element(scope, owner, owner.type.fields.index(node.attr))
    return Value("", None, (getattr(owner.type.instance_class, node.attr), owner))


def arithmetic(op: ast.operator, left: Value, right: Value, scope: Scope) -> Value:
    """Return the result of an operation on two numbers; two tuples are joined by +."""
    if is_tuple(left.type) and is_tuple(right.type) and isinstance(op, ast.Add):
        items = [element(scope, side, k) for side in map(scope.keep, (left, right)) for k in range(len(side.type))]
        return build_tuple(scope, items)
    _require_numbers(left, right)
    sign, compute = _ARITHMETIC[type(op)]
    whole = not isinstance(op, ast.Div) and REAL not in {left.type, right.type}
    if is_known(left, right) and not (right.known == 0 and sign in "/%"):
        return number(compute(left.known, right.known))
    if sign in "/%" and isinstance(op, ast.FloorDiv | ast.Mod) and not whole:
        raise TypeError("// and % are for whole numbers only")
    rank = Rank.SUM if sign in "+-" else Rank.PRODUCT
    if not whole:
        left, right = left.as_real(), right.as_real()
    code = f"{left.within(rank)} {sign} {right.within(rank - 1)}"
    return Value(code, INTEGER if whole else REAL, plain=False, rank=rank)


def _is_number(value: Value) -> bool:
    return value.type in {REAL, BOOLEAN} or isinstance(value.type, types.Integer)


def _require_numbers(*values: Value) -> None:
    if not all(map(_is_number, values)):
        raise TypeError("no numbers")


def _print_power(base: Value, exponent: Value, scope: Scope) -> Value:
    """Return a power; a small whole one is a product, as it is in compiled Python code."""
    if is_known(base, exponent):
        return number(base.known**exponent.known)
    whole = int(exponent.known) if isinstance(exponent.known, int) else 0
    if 1 <= whole <= _UNROLLED:
        factor = scope.keep(base)
        return Value(" * ".join([factor.within(Rank.UNARY)] * whole), base.type, plain=False, rank=Rank.PRODUCT)
    return Value(f"r_pow({base.code}, {exponent.code})", REAL, plain=False)


def _print_unary(op: ast.unaryop, value: Value) -> Value:
    if isinstance(op, ast.Not):
        opposite = Value(f"!{value.within(0)}", BOOLEAN, plain=False, rank=Rank.UNARY)
        return number(not value.known) if is_known(value) else opposite
    _require_numbers(value)
    if not isinstance(op, ast.USub):
        raise TypeError(type(op))
    if is_known(value):
        return number(-value.known)
    return Value(f"-{value.within(0)}", value.type, plain=False, rank=Rank.UNARY)


def _print_comparison(node: ast.Compare, scope: Scope) -> Value:
    values = [print_expression(item, scope) for item in (node.left, *node.comparators)]
    _require_numbers(*values)
    if is_known(*values):
        pairs = zip(node.ops, values, values[1:], strict=False)
        return number(all(_COMPARED[type(op)][1](a.known, b.known) for op, a, b in pairs))
    values[1:-1] = map(scope.keep, values[1:-1])
    parts = [
        f"{a.within(Rank.SUM)} {_COMPARED[type(op)][0]} {b.within(Rank.SUM)}"
        for op, a, b in zip(node.ops, values, values[1:], strict=False)
    ]
    return Value(" && ".join(parts), BOOLEAN, plain=False, rank=Rank.COMPARISON if len(parts) == 1 else Rank.LOGIC)


def _print_logic(node: ast.BoolOp, scope: Scope) -> Value:
    """Return `and` or `or` of conditions; what is known beforehand decides or falls out."""
    deciding, sign = (False, " && ") if isinstance(node.op, ast.And) else (True, " || ")
    remaining: list[Value] = []
    for item in node.values:
        value = print_expression(item, scope)
        if not is_known(value):
            remaining.append(value)
        elif bool(value.known) is deciding:
            # What stands before has no side effect, so that the whole is decided.
            return number(deciding)
    if len(remaining) < 2:
        return remaining[0] if remaining else number(not deciding)
    return Value(sign.join(value.within(Rank.COMPARISON) for value in remaining), BOOLEAN, plain=False, rank=Rank.LOGIC)


def _print_choice(node: ast.IfExp, scope: Scope) -> Value:
    condition = print_expression(node.test, scope)
    if is_known(condition):
        return print_expression(node.body if condition.known else node.orelse, scope)
    yes, no = print_expression(node.body, scope), print_expression(node.orelse, scope)
    if yes.type != no.type and not (_is_number(yes) and _is_number(no)):
        raise TypeError(f"{yes.type} and {no.type}")
    if yes.is_empty:
        return yes
    if REAL in (yes.type, no.type):
        yes, no = yes.as_real(), no.as_real()
    code = f"{condition.within(Rank.LOGIC)} ? {yes.within(Rank.LOGIC)} : {no.within(Rank.CHOICE)}"
    return Value(code, yes.type, plain=False, rank=Rank.CHOICE)


def _print_subscript(node: ast.Subscript, scope: Scope) -> Value:
    owner = print_expression(node.value, scope)
    if isinstance(owner.type, types.Array):
        items = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        return _array_element(owner, [print_expression(item, scope) for item in items], scope)
    if isinstance(node.slice, ast.Slice):
        ends = [print_expression(end, scope).known if end else None for end in (node.slice.lower, node.slice.upper)]
        return part(scope, owner, slice(*ends))
    index = print_expression(node.slice, scope)
    return element(scope, owner, int(index.known) if is_known(index) else index)


def _array_element(owner: Value, indices: list[Value], scope: Scope) -> Value:
    """Return an element of an array, or the part of it that fewer indices name."""
    if isinstance(owner.known, np.ndarray) and is_known(*indices):
        found = owner.known[tuple(index.known for index in indices)]
        return number(float(found)) if np.ndim(found) == 0 else scope.program.table(found)
    terms = []
    for position, index in enumerate(indices):
        stride = math.prod(owner.shape[position + 1 :])
        terms.append(f"{index.within(Rank.UNARY)} * {stride}" if stride != 1 else index.code)
    rest = owner.shape[len(indices) :]
    if not rest:
        return Value(f"{owner.code}[{' + '.join(terms)}]", REAL)
    kind = types.Array(REAL, len(rest), "C", readonly=not owner.type.mutable)
    return Value(f"({owner.within(Rank.SUM)} + {' + '.join(terms)})", kind, shape=rest)


def _print_call(node: ast.Call, scope: Scope) -> Value:
    """Return the value of a call: of `math` and built-in functions, of records and methods, of printed functions."""
    callee, given = print_expression(node.func, scope), _print_items(node.args, scope)
    named = {str(each.arg): print_expression(each.value, scope) for each in node.keywords}
    thing = callee.known
    if isinstance(thing, tuple):
        thing, owner = thing
        if getattr(thing, "__name__", "") == "_replace":
            held = scope.keep(owner)
            items = [named.get(name) or element(scope, held, k) for k, name in enumerate(owner.type.fields)]
            return build_tuple(scope, items, owner.type.instance_class)
        given = [owner, *given]
    if isinstance(thing, type) and issubclass(thing, tuple) and hasattr(thing, "_fields"):
        return build_tuple(scope, _bind(thing, given, named), thing)
    module = getattr(thing, "__module__", "")
    if module == "math" or thing in (abs, min, max, len, float, np.empty):
        return _print_library(thing.__name__, given, scope)
    thing = getattr(thing, "py_func", thing)
    if thing in GENERIC:
        given = _bind(thing, given, named) if named else given
        thing = scope.program.form(thing, tuple(value.type for value in given))
        named = {}
    if not isinstance(thing, FunctionType):
        raise TypeError(type(thing))
    return _print_own(thing, _bind(thing, given, named), scope)


def _bind(function: Callable[..., object], given: list[Value], named: Mapping[str, Value]) -> list[Value]:
    """Return the arguments of a call in the order of the parameters, with defaults."""
    bound = inspect.signature(function).bind(*given, **named)
    bound.apply_defaults()
    values: list[Any] = []
    for value in bound.arguments.values():
        values += value if isinstance(value, tuple) and not isinstance(value, Value) else [value]
    return [value if isinstance(value, Value) else number(value) for value in values]


def _print_own(function: FunctionType, values: list[Value], scope: Scope) -> Value:
    """Return the call of a function that is printed too; a lambda is put in its place."""
    if function.__name__ == "<lambda>":
        body = source_of(function, ast.Lambda)
        inner = Scope(scope.program, function, {})
        inner.write, inner.name = scope.write, scope.name  # type: ignore[method-assign]  # lines go to the caller
        names = [argument.arg for argument in body.args.args]
        inner.variables = {name: scope.keep(value) for name, value in zip(names, values, strict=True)}
        return print_expression(body.body, inner)
    printed = scope.program.function(function, tuple(Signature(value.type, value.shape) for value in values))
    if printed.value is not None:
        return printed.value
    if printed.passed is not None:
        return values[printed.passed]
    if Value("", printed.result).is_empty:
        return Value("", printed.result)
    listed = ", ".join(value.code for value in values if not value.is_empty)
    return Value(f"{printed.name}({listed})", printed.result, plain=False)


def _print_library(name: str, values: list[Value], scope: Scope) -> Value:
    """Return the call of a built-in function or one of `math`."""
    whole = all(value.type != REAL for value in values)
    if name == "len":
        (only,) = values
        return number(len(only.type) if is_tuple(only.type) else only.shape[0])
    if name == "empty":
        shape = values[0].known if isinstance(values[0].known, tuple) else (values[0].known,)
        code = scope.name("scratch")
        scope.write(f"real {code}[{math.prod(shape)}];")
        return Value(code, types.Array(REAL, len(shape), "C"), shape=shape)
    if is_known(*values):
        compute = getattr(math, name, None) or getattr(builtins, name)
        return number(compute(*[value.known for value in values]))
    if name in ("min", "max"):
        first, *rest = values if whole else [value.as_real() for value in values]
        for value in rest:
            word = {"min": "least", "max": "greatest"}[name] + ("_int" if whole else "")
            first = Value(f"{word}({first.code}, {value.code})", INTEGER if whole else REAL, plain=False)
        return first
    if name == "float":
        return values[0].as_real()
    word, kind = ("abs", INTEGER) if name == "abs" and whole else _IN_C[name]
    listed = ", ".join(value.code for value in values)
    return Value(f"{word}({listed})", kind, plain=False, rank=Rank.UNARY if kind == INTEGER else 0)
