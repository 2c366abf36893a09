"""A block as one C99 file that stands alone, with a test vector that a compiled `main` checks."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from seatsim.exchange.blocks.base import Block
from seatsim.exchange.model_source import fill, print_model
from seatsim.exchange.variables import Variable, list_variables
from seatsim.schema.files import write_text

SAMPLES = 200
"""Samples of the test vector."""
AMPLITUDES = {
    "displacement": 0.02, "velocity": 0.2, "acceleration": 2.0, "frame_velocity": 0.3, "driver_velocity": 0.3,
    "floor_velocity": 0.3, "floor_acceleration": 2.0, "frame_acceleration": 2.0, "driver_acceleration": 1.5,
    "damper_force": 300.0, "current": 0.5, "command": 0.5, "replayed_command": 0.5, "frame_force": 20.0,
    "driver_force": 20.0, "temperature": 10.0,
}  # fmt: skip
"""Size of the sines that the test vector feeds, in the unit of the input; an input that is not here stays as it is."""


def write_c(block: Block, path: Path) -> None:
    """Write a block as one C file.

    Raises:
        InputError: a function has no counterpart in C, or the file cannot be written. OutputError: the disk is full.
    """
    write_text(path, print_c(block))


def print_c(block: Block) -> str:
    """Return the text of the file."""
    variables = list_variables(block)
    inputs = [v for v in variables if v.causality == "input"]
    outputs = [v for v in variables if v.causality == "output"]
    fed, expected = zip(*_test_vector(block, inputs, outputs), strict=True)
    words = {
        # A name must not end the comment in which it stands.
        "TITLE": f"{block.name}: {block.summary}".replace("*/", "* /").replace("/*", "/ *"),
        "NOTES": "".join(f"\n   Note: {note}." for note in block.notes),
        "INPUTS": _list_of(inputs),
        "OUTPUTS": _list_of(outputs),
        "SAMPLES": str(SAMPLES),
        "FED": _rows(fed),
        "EXPECTED": _rows(expected),
        "FEED": "".join(f"        m.{v.place} = (real)fed[k][{j}];\n" for j, v in enumerate(inputs)),
        "CHECK": "".join(
            f"        off += is_off(m.{v.place}, expected[k][{j}], {j});\n" for j, v in enumerate(outputs)
        ),
        "INPUT_COUNT": str(len(inputs)),
        "OUTPUT_COUNT": str(len(outputs)),
    }
    return fill("file.c", words | {"MODEL": print_model(block)})


def _list_of(variables: list[Variable]) -> str:
    return "".join(f"\n     m.{v.place:<32} {v.unit:<8} {v.meaning}" for v in variables)


def _test_vector(
    block: Block, inputs: list[Variable], outputs: list[Variable]
) -> Iterator[tuple[list[float], list[float]]]:
    """Yield the inputs of each sample and the outputs after it, computed by the Python functions themselves."""
    parameters, given, state = block.parameters, block.inputs, block.initial
    for k in range(SAMPLES):
        values = {v.name: _signal(v, j, k * block.step) for j, v in enumerate(inputs)}
        given = given._replace(**values)
        if k == 0:
            state = block.start(parameters, given, block.rest)
        state, _ = block.advance(parameters, given, state, 0.0, block.step)
        seen: Any = block.observe(parameters, given, state, block.step)
        yield [float(v) for v in values.values()], [float(getattr(seen, v.name)) for v in outputs]


def _signal(v: Variable, position: int, time: float) -> float:
    """Return a sine of a frequency and phase of its own about the value at the start."""
    return float(v.value) + AMPLITUDES.get(v.name, 0.0) * math.sin(7.0 * time * (1.0 + 0.37 * position) + position)


def _rows(rows: tuple[list[float], ...]) -> str:
    return "\n".join("    {" + ", ".join(map(repr, row)) + "}," for row in rows)
