"""The syntax tree of a Python function."""

from __future__ import annotations

import ast
import inspect
import textwrap
from types import FunctionType

from seatsim.exchange.printing.values import NotPrintableError


def definition_of(function: FunctionType) -> ast.FunctionDef:
    """Return the definition of a function.

    Raises:
        NotPrintableError: its source is not at hand.
    """
    return _first(function, ast.FunctionDef)  # type: ignore[return-value]  # of the type asked for


def lambda_of(function: FunctionType) -> ast.Lambda:
    """Return the definition of a lambda, the only one of its line."""
    return _first(function, ast.Lambda)  # type: ignore[return-value]  # of the type asked for


def _first(function: FunctionType, kind: type[ast.AST]) -> ast.AST:
    try:
        tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    except (OSError, SyntaxError) as error:
        raise NotPrintableError(
            f"{function.__module__}.{function.__qualname__}: its source is not at hand, so that it cannot be exported"
        ) from error
    return next(node for node in ast.walk(tree) if isinstance(node, kind))
