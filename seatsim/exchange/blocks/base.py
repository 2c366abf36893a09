"""A block: a model with inputs and outputs that is advanced from outside, as another program's master does.

    def start(parameters, inputs, rest):              the state at time zero, from the state at rest
    def observe(parameters, inputs, state, age):      the outputs, `age` seconds after the inputs were given
    def advance(parameters, inputs, state, age, length):   the state `length` seconds later, and whether it was reached

An advance begins `age` seconds after the inputs were given.

Parameters, inputs, state and outputs are records (NamedTuple), the functions plain arithmetic: numba compiles them, and
`seatsim.exchange.printing` prints them as C. Records of inputs and outputs state unit and meaning of their fields.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from seatsim.schema.registry import Record


@dataclass(frozen=True)
class Block:
    """A model that can be exported.

    name, summary: what it is called, and a sentence. parameters, inputs, rest: records of parameters, of inputs at the
    start and of the state at rest. step: s, in which it is advanced; `fixed_step` where every advance is one of these,
    and other programs must ask for whole numbers of them. parts: classes whose methods are compiled in. hidden:
    parameters that are not exposed, by the beginning of their name. notes: sentences about what is left out.
    """

    name: str
    summary: str
    parameters: Record
    inputs: Record
    rest: Record
    start: Callable[..., Any]
    observe: Callable[..., Any]
    advance: Callable[..., Any]
    step: float
    fixed_step: bool
    parts: tuple[type, ...]
    hidden: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    @cached_property
    def initial(self) -> Any:
        """The state at time zero."""
        return self.start(self.parameters, self.inputs, self.rest)

    @cached_property
    def outputs(self) -> Any:
        """The outputs at time zero."""
        return self.observe(self.parameters, self.inputs, self.initial, 0.0)
