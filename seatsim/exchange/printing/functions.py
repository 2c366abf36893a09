"""Functions: their parameters and types, their statements and what they return."""

import ast
import re
from collections import Counter
from collections.abc import Callable

from numba import types

from seatsim.exchange.printing.expressions import arithmetic, print_expression
from seatsim.exchange.printing.program import (
    NOTHING,
    REAL,
    NotPrintableError,
    Printed,
    Program,
    Scope,
    Signature,
    Value,
    element,
    is_empty,
    is_known,
    is_tuple,
    origin,
    source_of,
    whole_as_int64,
)

_PERMITTED = (
    "permitted are numbers, tuples and records, arithmetic (// and % of whole numbers), comparisons of numbers,"
    " calls of math, of records and of such functions, assignments, conditions, and loops over range(n) or range(m, n)"
)


def print_function(
    program: Program, function: Callable[..., object], name: str, arguments: tuple[Signature, ...]
) -> Printed:
    """Print a function for arguments of these types.

    Raises:
        NotPrintableError: it uses what has no counterpart in C.
    """
    definition = source_of(function, ast.FunctionDef)
    names = [argument.arg for argument in definition.args.args]
    scope = Scope(program, function, _count_assignments(definition, names))
    parameters = [_parameter(scope, *pair) for pair in zip(names, arguments, strict=True)]
    given = list(map(scope.variables.__getitem__, names))
    ends = _print_body(definition.body, scope)
    if not ends:
        raise NotPrintableError(f"{origin(function)}: not every path returns a value, so that it cannot be exported")
    result = _common_type(scope, definition)
    if len(scope.results) == 1 and _is_straight(definition):
        (only,) = scope.results
        kept = [scope.assigned[parameter] == 1 for parameter in names]
        passed = [k for k, value in enumerate(given) if value is only and kept[k]]
        if passed:
            return Printed(name, result, passed=passed[0])
        if is_known(only) and not is_tuple(only.type):
            return Printed(name, result, value=only)
    if not is_empty(result):
        program.functions.append(_definition(name, result, parameters, scope))
    return Printed(name, result)


def _parameter(scope: Scope, name: str, argument: Signature) -> str:
    """Enter a parameter among the variables, and return how C declares it; of an empty one there is nothing."""
    kind = whole_as_int64(argument.type)
    if is_empty(kind):
        scope.variables[name] = Value("", kind)
        return ""
    code, written = scope.name(name), scope.program.types.name(kind)
    scope.variables[name] = Value(code, kind, shape=argument.shape)
    return f"{written} {code}".replace("* ", "*")


def _definition(name: str, result: types.Type, parameters: list[str], scope: Scope) -> str:
    """Return the text of a function."""
    listed = ", ".join(filter(None, parameters))
    head = f"INLINED {scope.program.types.name(result)} {name}({listed or 'void'})"
    lines = [*scope.declared, *_used(scope.lines)]
    return "\n".join([f"/* {origin(scope.function)} */", head, "{", *_unused(parameters, lines), *lines, "}", ""])


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
        raise scope.refuse(definition, _PERMITTED)
    return kinds[0]


def _is_straight(definition: ast.FunctionDef) -> bool:
    return not any(isinstance(node, ast.If | ast.For | ast.While) for node in ast.walk(definition))


def _print_body(body: list[ast.stmt], scope: Scope) -> bool:
    """Print statements; return whether they end by returning a value."""
    # What stands behind a statement that returns is not reached, and not printed.
    return any(_print_statement(statement, scope) for statement in body)


def _print_statement(node: ast.stmt, scope: Scope) -> bool:
    """Print one statement; return whether nothing after it is reached.

    Raises:
        NotPrintableError: it holds what C, or this printer, has not: its names and types are looked up in vain.
    """
    try:
        return _try_statement(node, scope)
    except (AttributeError, LookupError, TypeError, ValueError) as error:
        raise scope.refuse(node, _PERMITTED) from error


def _try_statement(node: ast.stmt, scope: Scope) -> bool:
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
            _store(target, arithmetic(op, before, print_expression(value, scope), scope), scope)
        case ast.If():
            return _print_if(node, scope)
        case ast.For():
            _print_for(node, scope)
        case ast.While():
            _print_while(node, scope)
        case ast.Break() | ast.Continue():
            scope.write(f"{ast.unparse(node)};")
            return True
        case _:
            raise TypeError(type(node))
    return False


def _print_return(value: ast.expr | None, scope: Scope) -> bool:
    result = print_expression(value, scope) if value else Value("", NOTHING)
    scope.results.append(result)
    scope.write(f"return {result.code};" if not result.is_empty else "return;")
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
    return value if is_known(value) or value.type is None else value._replace(plain=False)


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
            raise TypeError(type(target))


def _as_read(target: ast.expr) -> ast.expr:
    """Return what is assigned as an expression that is read."""
    return ast.parse(ast.unparse(target), mode="eval").body


def _print_if(node: ast.If, scope: Scope) -> bool:
    """Print a condition; only one branch where it is known beforehand which holds."""
    condition = print_expression(node.test, scope)
    if is_known(condition):
        return _print_body(node.body if condition.known else node.orelse, scope)
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
    ends = _print_body(body, scope)
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
            *starts, last = (print_expression(end, scope) for end in ends)
        case _:
            raise TypeError(type(node.iter))
    counter = scope.name("k" if name == "_" else name)
    # Python reads the ends once: one that the loop changes is held.
    changed = {
        n.id for part in node.body for n in ast.walk(part) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)
    }
    read = {n.id for n in ast.walk(ends[-1]) if isinstance(n, ast.Name)}
    end = scope.keep(_copied(last) if changed & read else last).code
    [start] = [each.code for each in starts] or ["0"]
    scope.variables[name] = Value(counter, types.int64)
    scope.write(f"for (int {counter} = {start}; {counter} < {end}; {counter}++) {{")
    _print_block(node.body, scope)
    scope.write("}")


def _print_while(node: ast.While, scope: Scope) -> None:
    lines = len(scope.lines)
    condition = print_expression(node.test, scope)
    if node.orelse or len(scope.lines) > lines:
        raise TypeError("the condition of a loop is more than a single expression")
    scope.write(f"while ({condition.code}) {{")
    _print_block(node.body, scope)
    scope.write("}")
