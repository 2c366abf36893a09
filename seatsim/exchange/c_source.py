"""A block as C99 without allocation: alone, with a test vector that a compiled `main` checks, or for a unit."""

import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import SupportsFloat, SupportsInt

import numba
from numba import types

from seatsim.exchange.block import RATES, Block, Variable, list_variables
from seatsim.exchange.printing.functions import print_function
from seatsim.exchange.printing.program import REAL, Program, Signature, is_empty, is_row, number
from seatsim.schema.fields import read_packaged

_SAMPLES = 200
"""Samples of the test vector."""
_SIZES = read_packaged(Path(__file__).with_name("test_vector.yaml"), dict[str, float])
"""Size of the sines that the test vector feeds, in the unit of the input."""
_KINDS = {bool: "BOOLEAN_VARIABLE", int: "INTEGER_VARIABLE", float: "REAL_VARIABLE"}


def fill(name: str, **words: object) -> str:
    """Return a file of this package with its words put in; those of an XML file are escaped."""
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("seatsim.exchange", "."), autoescape=jinja2.select_autoescape(["xml"]),
        undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True,
    )  # fmt: skip
    return environment.get_template(name).render(words)


def print_model(block: Block) -> str:
    """Return the C of a block: `struct Model` and the functions that reset, start, advance and observe it.

    Raises:
        NotPrintableError: a function of the block uses what has no counterpart in C.
    """
    program = Program(print_function)
    p, u, s = (Signature(numba.typeof(value)) for value in (block.parameters, block.inputs, block.rest))
    number_ = Signature(REAL)
    start = _call(program, block.start, (p, u, s), ("m->parameters", "m->inputs", "rest_state"))
    given = ("m->parameters", "m->inputs", "m->state")
    observe = _call(program, block.observe, (p, u, s, number_), (*given, "m->age"))
    advance = _call(program, block.advance, (p, u, s, number_, number_), (*given, "(real)k * part", "part"))
    records = {"Parameters": block.parameters, "Inputs": block.inputs, "State": block.rest}
    results = {"Outputs": block.outputs, "Advanced": (block.initial, True)}
    names = {name: program.types.name(numba.typeof(value)) for name, value in (records | results).items()}
    called = zip(("nominal_parameters", "first_inputs", "rest_state"), records.items(), strict=True)
    constants = [
        f"static const {names[kind]} {name} = {_initialiser(value, numba.typeof(value))};"
        for name, (kind, value) in called
    ]
    model = fill("c/model.h", START=start, OBSERVE=observe, ADVANCE=advance, block=block, **names)
    return "\n".join([fill("c/prelude.h"), program.source(), *constants, "", model, ""])


def print_variables(variables: Sequence[Variable]) -> str:
    """Return the table of a model's variables, by which a wrapper finds them."""
    names = [v.name for v in variables]
    rates = [names.index(RATES[v.name]) if RATES.get(v.name) in names else -1 for v in variables]
    kinds = [_KINDS[type(v.value)] for v in variables]
    return fill("c/variables.h", variables=variables, kinds=kinds, rates=rates, limit=_limit)


def _call(
    program: Program, function: Callable[..., object], kinds: tuple[Signature, ...], codes: tuple[str, ...]
) -> str:
    """Return the call of a function of the block, which is printed."""
    printed = program.function(function, kinds)
    if printed.passed is not None:
        return codes[printed.passed]
    listed = (code for code, kind in zip(codes, kinds, strict=True) if not is_empty(kind.type))
    return f"{printed.name}({', '.join(listed)})"


def _initialiser(value: object, kind: types.Type) -> str:
    """Return the value of a record or number as C initialises it."""
    if isinstance(value, tuple):
        pairs = zip(value, kind, strict=True)
        listed = ", ".join(_initialiser(item, inner) for item, inner in pairs if not is_empty(inner))
        return f"{{{{{listed}}}}}" if is_row(kind) else f"{{{listed}}}"
    assert isinstance(value, SupportsFloat) and isinstance(value, SupportsInt)
    return number(float(value)).code if kind == REAL else str(int(value))


def _limit(value: float) -> str:
    return repr(value) if math.isfinite(value) else ("HUGE_VAL" if value > 0 else "-HUGE_VAL")


def print_c(block: Block) -> str:
    """Return a block as the text of one C file.

    Raises:
        NotPrintableError: a function has no counterpart in C.
    """
    variables = list_variables(block)
    inputs = [v for v in variables if v.causality == "input"]
    outputs = [v for v in variables if v.causality == "output"]
    fed, expected = zip(*_test_vector(block, inputs, outputs), strict=True)
    # A name must not end the comment in which it stands.
    title = f"{block.name}: {block.summary}".replace("*/", "* /").replace("/*", "/ *")
    words = {"inputs": inputs, "outputs": outputs, "fed": fed, "expected": expected, "samples": _SAMPLES}
    return fill("c/file.c", title=title, block=block, model=print_model(block), **words)


def _test_vector(
    block: Block, inputs: list[Variable], outputs: list[Variable]
) -> Iterator[tuple[list[float], list[float]]]:
    """Yield the inputs of each sample and the outputs after it, computed by the Python functions themselves."""
    parameters, given, state = block.parameters, block.inputs, block.initial
    for k in range(_SAMPLES):
        values = {v.name: _signal(v, j, k * block.step) for j, v in enumerate(inputs)}
        given = given._replace(**values)
        if k == 0:
            state = block.start(parameters, given, block.rest)
        state, _ = block.advance(parameters, given, state, 0.0, block.step)
        seen = block.observe(parameters, given, state, block.step)
        yield [float(v) for v in values.values()], [float(getattr(seen, v.name)) for v in outputs]


def _signal(v: Variable, position: int, time: float) -> float:
    """Return a sine of a frequency and phase of its own about the value at the start."""
    size = _SIZES.get(v.name, 0.0)
    return float(v.value) + size * math.sin(7.0 * time * (1.0 + 0.37 * position) + position)
