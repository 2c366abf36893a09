"""Calls: of `math` and built-in functions, of records' classes and methods, and of functions that are printed too."""

import ast
import builtins
import inspect
import math
from collections.abc import Callable, Mapping
from types import FunctionType

import numpy as np
from numba import types

from seatsim.compilation.jit import GENERIC
from seatsim.exchange.printing.program import Scope, build_tuple, element, source_of
from seatsim.exchange.printing.values import BOOLEAN, INTEGER, REAL, Rank, Signature, Value, is_known, is_tuple, number

_Evaluate = Callable[[ast.expr, Scope], Value]
_MATHS = "exp log sqrt sin cos tan atan tanh sinh cosh expm1 copysign hypot atan2 pow"
"""Functions of `math` that C has under the same name."""


def print_call(
    callee: Value, given: list[Value], named: Mapping[str, Value], node: ast.Call, scope: Scope, evaluate: _Evaluate
) -> Value:
    """Return the value of a call."""
    if callee.type is not None or callee.known is None:
        raise scope.refuse(node, "what is called must be a function, a class of records or a method")
    thing = callee.known
    if isinstance(thing, tuple):
        thing, owner = thing
        if getattr(thing, "__name__", "") == "_replace":
            return _replace(scope, owner, named)
        given = [owner, *given]
    if isinstance(thing, type) and issubclass(thing, tuple) and hasattr(thing, "_fields"):
        return build_tuple(scope, _bind(thing, given, named, node, scope), thing)
    module = getattr(thing, "__module__", "")
    if module == "math" or thing in (abs, min, max, len, float, np.empty):
        return _print_library(thing.__name__, given, node, scope)
    if hasattr(thing, "py_func"):
        thing = thing.py_func
        scope.program.apart.add(thing)
    if thing in GENERIC:
        given = _bind(thing, given, named, node, scope) if named else given
        thing = scope.program.form(thing, tuple(value.type for value in given))
        named = {}
        if thing is None:
            raise scope.refuse(node, "the function has no form for these types")
    if not isinstance(thing, FunctionType):
        raise scope.refuse(node, f"{getattr(thing, '__name__', thing)} has no counterpart in C")
    return _print_own(thing, _bind(thing, given, named, node, scope), scope, evaluate)


def _bind(
    function: Callable[..., object], given: list[Value], named: Mapping[str, Value], node: ast.Call, scope: Scope
) -> list[Value]:
    """Return the arguments of a call in the order of the parameters, with defaults."""
    bound = inspect.signature(function).bind(*given, **named)
    bound.apply_defaults()
    values: list[object] = []
    for value in bound.arguments.values():
        values += value if isinstance(value, tuple) and not isinstance(value, Value) else [value]
    return [value if isinstance(value, Value) else _default(value, node, scope) for value in values]


def _default(value: object, node: ast.Call, scope: Scope) -> Value:
    if isinstance(value, bool | int | float):
        return number(value)
    if value == ():
        return Value("", types.Tuple(()))
    raise scope.refuse(node, "defaults of arguments must be numbers")


def _replace(scope: Scope, owner: Value, named: Mapping[str, Value]) -> Value:
    """Return a record with other values of some fields."""
    held = scope.keep(owner)
    items = [named.get(name) or element(scope, held, k) for k, name in enumerate(owner.type.fields)]
    return build_tuple(scope, items, owner.type.instance_class)


def _print_own(function: FunctionType, values: list[Value], scope: Scope, evaluate: _Evaluate) -> Value:
    """Return the call of a function that is printed too; a lambda is put in its place."""
    if function.__name__ == "<lambda>":
        body = source_of(function, ast.Lambda)
        inner = Scope(scope.program, function, {})
        inner.write, inner.name = scope.write, scope.name  # type: ignore[method-assign]  # lines go to the caller
        names = [argument.arg for argument in body.args.args]
        inner.variables = {name: scope.keep(value) for name, value in zip(names, values, strict=True)}
        return evaluate(body.body, inner)
    printed = scope.program.function(function, tuple(Signature(value.type, value.shape) for value in values))
    if printed.value is not None:
        return printed.value
    if printed.passed is not None:
        return values[printed.passed]
    if Value("", printed.result).is_empty:
        return Value("", printed.result)
    listed = ", ".join(value.code for value in values if not value.is_empty)
    return Value(f"{printed.name}({listed})", printed.result, plain=False)


def _print_library(  # noqa: PLR0911 - one return per function
    name: str, values: list[Value], node: ast.Call, scope: Scope
) -> Value:
    """Return the call of a built-in function or one of `math`."""
    whole = all(value.type != REAL for value in values)
    if name == "len":
        (only,) = values
        return number(len(only.type) if is_tuple(only.type) else only.shape[0])
    if name == "empty":
        shape = values[0].known if isinstance(values[0].known, tuple) else (values[0].known,)
        if not all(isinstance(length, int) for length in shape):
            raise scope.refuse(node, "the shape of an array must be constant")
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
    listed = ", ".join(value.code for value in values)
    if name == "float":
        return values[0].as_real()
    if name == "abs":
        return Value(f"{'abs' if whole else 'r_fabs'}({listed})", INTEGER if whole else REAL, plain=False)
    if name in ("isnan", "isinf", "isfinite"):
        return Value(f"{name}({listed})", BOOLEAN, plain=False)
    if name in ("floor", "ceil"):
        return Value(f"(int)r_{name}({listed})", INTEGER, plain=False, rank=Rank.UNARY)
    if name in _MATHS.split():
        return Value(f"r_{name}({listed})", REAL, plain=False)
    raise scope.refuse(node, f"'{name}' has no counterpart in C")
