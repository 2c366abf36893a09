"""Statements: assignments, conditions, loops and what a function returns."""

from __future__ import annotations

import ast

from numba import types

from seatsim.exchange.printing.expressions import arithmetic, print_expression
from seatsim.exchange.printing.program import Scope, element, origin
from seatsim.exchange.printing.values import NOTHING, UNKNOWN, NotPrintableError, Value, is_empty, is_known


def print_body(body: list[ast.stmt], scope: Scope) -> bool:
    """Print statements; return whether they end by returning a value."""
    # What stands behind a statement that returns is not reached, and not printed.
    return any(_print_statement(statement, scope) for statement in body)


def _print_statement(node: ast.stmt, scope: Scope) -> bool:
    """Print one statement; return whether nothing after it is reached."""
    match node:
        case ast.Expr(value=ast.Constant()) | ast.Pass():
            return False
        case ast.Return(value=value):
            return _print_return(value, scope)
        case ast.Assign(targets=[target], value=value):
            _assign(target, value, scope)
        case ast.AnnAssign(target=target, value=ast.expr() as value):
            _assign(target, value, scope)
        case ast.AugAssign(target=target, op=op, value=value):
            before = print_expression(_as_read(target), scope)
            _store(target, arithmetic(op, before, print_expression(value, scope), node, scope), scope)
        case ast.If():
            return _print_if(node, scope)
        case ast.For():
            _print_for(node, scope)
        case ast.While():
            _print_while(node, scope)
        case ast.Break():
            scope.write("break;")
            return True
        case ast.Continue():
            scope.write("continue;")
            return True
        case _:
            raise scope.refuse(node, "this statement has no counterpart in C")
    return False


def _print_return(value: ast.expr | None, scope: Scope) -> bool:
    result = print_expression(value, scope) if value else Value("", NOTHING)
    scope.results.append(result)
    scope.write(f"return {result.code};" if not is_empty(result.type) else "return;")
    return True


def _assign(target: ast.expr, value: ast.expr, scope: Scope) -> None:
    """Assign a value to a variable, or several to as many; the right side is computed before any of them changes."""
    if not isinstance(target, ast.Tuple):
        _store(target, print_expression(value, scope), scope)
        return
    if isinstance(value, ast.Tuple):
        values = [print_expression(item, scope) for item in value.elts]
        targets = {node.id for node in ast.walk(target) if isinstance(node, ast.Name)}
        read = {node.id for item in value.elts[1:] for node in ast.walk(item) if isinstance(node, ast.Name)}
        if targets & read:
            values = [scope.keep(_copied(item)) for item in values]
    else:
        whole = scope.keep(print_expression(value, scope))
        values = [element(scope, whole, k) for k in range(len(whole.type))]
    for one, item in zip(target.elts, values, strict=True):
        _store(one, item, scope)


def _copied(value: Value) -> Value:
    """Return a value that is to be held apart from the variable it comes from."""
    return value if value.known is not UNKNOWN or value.type is None else value._replace(plain=False)


def _store(target: ast.expr, value: Value, scope: Scope) -> None:
    match target:
        case ast.Name(id=name) if name.startswith("_"):
            pass
        case ast.Name(id=name):
            scope.assign(name, value)
        case ast.Subscript(value=ast.Name(id=owner)) if owner in scope.variables:
            place = print_expression(_as_read(target), scope)
            scope.write(f"{place.code} = {value.code};")
        case _:
            raise scope.refuse(target, "only variables and elements of arrays are assigned")


def _as_read(target: ast.expr) -> ast.expr:
    """Return what is assigned as an expression that is read."""
    return ast.parse(ast.unparse(target), mode="eval").body


def _print_if(node: ast.If, scope: Scope) -> bool:
    """Print a condition; only one branch where it is known beforehand which holds."""
    condition = print_expression(node.test, scope)
    if is_known(condition):
        return print_body(node.body if condition.known else node.orelse, scope)
    scope.write(f"if ({condition.code}) {{")
    first = _print_block(node.body, scope)
    second = False
    if node.orelse:
        scope.write("} else {")
        second = _print_block(node.orelse, scope)
    scope.write("}")
    return first and second


def _print_block(body: list[ast.stmt], scope: Scope) -> bool:
    """Print an inner block; variables that change their type within it would be others after it."""
    before = dict(scope.variables)
    scope.depth += 1
    ends = print_body(body, scope)
    scope.depth -= 1
    for name, value in before.items():
        if not ends and scope.variables[name] != value:
            raise NotPrintableError(
                f"{origin(scope.function)}: '{name}' has another type after a branch or loop, which C does not permit"
            )
    if ends:
        scope.variables = before | {k: v for k, v in scope.variables.items() if k not in before}
    return ends


def _print_for(node: ast.For, scope: Scope) -> None:
    match node:
        case ast.For(target=ast.Name(id=name), iter=ast.Call(func=ast.Name(id="range"), args=ends), orelse=[]):
            values = [print_expression(end, scope) for end in ends]
        case _:
            raise scope.refuse(node.iter, "a loop runs over range(n) or range(m, n)")
    if len(values) > 2:
        raise scope.refuse(node.iter, "a loop runs over range(n) or range(m, n)")
    counter = scope.name("k" if name == "_" else name)
    # Python reads the ends once: one that the loop changes is held.
    changed = {
        n.id for part in node.body for n in ast.walk(part) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)
    }
    read = {n.id for n in ast.walk(ends[-1]) if isinstance(n, ast.Name)}
    end = scope.keep(_copied(values[-1]) if changed & read else values[-1]).code
    start = values[0].code if len(values) == 2 else "0"
    scope.variables[name] = Value(counter, types.int64)
    scope.write(f"for (int {counter} = {start}; {counter} < {end}; {counter}++) {{")
    _print_block(node.body, scope)
    scope.write("}")


def _print_while(node: ast.While, scope: Scope) -> None:
    lines = len(scope.lines)
    condition = print_expression(node.test, scope)
    if node.orelse or len(scope.lines) > lines:
        raise scope.refuse(node.test, "the condition of a loop must be a single expression")
    scope.write(f"while ({condition.code}) {{")
    _print_block(node.body, scope)
    scope.write("}")
