"""A block as one C99 file without allocation: records, functions, the values of its parameters, its variables."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from importlib.resources import files
from typing import cast

import numba
from numba import types

from seatsim.exchange.blocks.base import Block
from seatsim.exchange.printing.declarations import is_row
from seatsim.exchange.printing.functions import new_program
from seatsim.exchange.printing.program import Program
from seatsim.exchange.printing.values import BOOLEAN, REAL, Signature, is_empty, is_tuple, number
from seatsim.exchange.variables import RATES, Variable

KINDS = {bool: "BOOLEAN_VARIABLE", int: "INTEGER_VARIABLE", float: "REAL_VARIABLE"}


def resource(name: str) -> str:
    """Return the text of a file of C that comes with this package."""
    return (files("seatsim.exchange") / "c" / name).read_text(encoding="utf-8")


def fill(name: str, words: Mapping[str, str]) -> str:
    """Return the text of such a file with its `@WORD@`s replaced, those that are in the words themselves left alone."""
    return re.sub(r"@(\w+)@", lambda found: words[found[1]], resource(name))


def print_model(block: Block) -> str:
    """Return the C of a block: `struct Model` and the functions that reset, start, advance and observe it.

    Raises:
        NotPrintableError: a function of the block uses what has no counterpart in C.
    """
    program = new_program()
    p, u, s = (Signature(numba.typeof(value)) for value in (block.parameters, block.inputs, block.rest))
    number_ = Signature(REAL)
    start = _call(program, block.start, (p, u, s), ("m->parameters", "m->inputs", "rest_state"))
    given = ("m->parameters", "m->inputs", "m->state")
    observe = _call(program, block.observe, (p, u, s, number_), (*given, "m->age"))
    advance = _call(program, block.advance, (p, u, s, number_, number_), (*given, "(real)k * part", "part"))
    result = numba.typeof((block.initial, True))
    names = {
        "Parameters": program.types.name(p.type),
        "Inputs": program.types.name(u.type),
        "State": program.types.name(s.type),
        "Outputs": program.types.name(numba.typeof(block.outputs)),
        "Advanced": program.types.name(result),
    }
    values = {"Parameters": block.parameters, "Inputs": block.inputs, "State": block.rest}
    constants = [
        f"static const {names[kind]} {name} = {_initialiser(values[kind], numba.typeof(values[kind]))};"
        for kind, name in (("Parameters", "nominal_parameters"), ("Inputs", "first_inputs"), ("State", "rest_state"))
    ]
    words = {"START": start, "OBSERVE": observe, "ADVANCE": advance}
    words |= {"FIXED_STEP": str(int(block.fixed_step)), "STEP": repr(block.step)}
    model = fill("model.h", names | words)
    return "\n".join([resource("prelude.h"), program.source(), *constants, "", model])


def print_variables(variables: Sequence[Variable]) -> str:
    """Return the table of a model's variables, by which a wrapper finds them."""
    names = [v.name for v in variables]
    rates = [names.index(RATES[v.name]) if RATES.get(v.name) in names else -1 for v in variables]
    rows = [
        f'    {{"{v.name}", {KINDS[type(v.value)]}, {v.causality.upper()}, offsetof(Model, {v.place}),'
        f" {_limit(v.low)}, {_limit(v.high)}, {rate}}},"
        for v, rate in zip(variables, rates, strict=True)
    ]
    return fill("variables.h", {"ROWS": "\n".join(rows)})


def _call(
    program: Program, function: Callable[..., object], kinds: tuple[Signature, ...], codes: tuple[str, ...]
) -> str:
    """Return the call of a function of the block, which is printed."""
    printed = program.function(function, kinds)
    if printed.passed is not None:
        return codes[printed.passed]
    pairs = zip(codes, kinds, strict=True)
    listed = [f"&{code}" if is_tuple(kind.type) else code for code, kind in pairs if not is_empty(kind.type)]
    return f"{printed.name}({', '.join(listed)})"


def _initialiser(value: object, kind: types.Type) -> str:
    """Return the value of a record or number as C initialises it."""
    if kind == REAL:
        return number(float(cast(float, value))).code
    if kind == BOOLEAN or isinstance(kind, types.Integer):
        return str(int(cast(int, value)))
    pairs = zip(cast("tuple[object, ...]", value), kind, strict=True)
    listed = ", ".join(_initialiser(item, inner) for item, inner in pairs if not is_empty(inner))
    return f"{{{{{listed}}}}}" if is_row(kind) else f"{{{listed}}}"


def _limit(value: float) -> str:
    return repr(value) if math.isfinite(value) else ("HUGE_VAL" if value > 0 else "-HUGE_VAL")
