"""A block: a model with inputs and outputs that is advanced from outside, as another program's master does.

    def start(parameters, inputs, rest):              the state at time zero, from the state at rest
    def observe(parameters, inputs, state, age):      the outputs, `age` seconds after the inputs were given
    def advance(parameters, inputs, state, age, length):   the state `length` seconds later, and whether it was reached

An advance begins `age` seconds after the inputs were given.

Parameters, inputs, state and outputs are records (NamedTuple), the functions plain arithmetic: numba compiles them, and
`seatsim.exchange.printing` prints them as C. Records of inputs and outputs state unit and meaning of their fields.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, NamedTuple

import numba
from numba import types

from seatsim.effects.base import EFFECTS
from seatsim.exchange.printing.program import field_names as c_names
from seatsim.exchange.printing.program import is_empty, is_row
from seatsim.kernel.augmented import AugmentedDamper
from seatsim.kernel.rig import Rig, SeatedBody
from seatsim.schema.content import Form, Unwritten
from seatsim.schema.fields import bounds, describe, item_units
from seatsim.schema.registry import Record

RATES = {"floor_acceleration": "floor_jerk", "velocity": "acceleration"}
"""Inputs that are the rate of change of another one, by the name of that."""


@dataclass(frozen=True)
class Block:
    """A model that can be exported.

    name, summary: what it is called, and a sentence. parameters, inputs, rest: records of parameters, of inputs at the
    start and of the state at rest. step: s, in which it is advanced; `fixed_step` where every advance is one of these,
    and other programs must ask for whole numbers of them. hidden: parameters that are not exposed, by the beginning
    of their name. notes: sentences about what is left out.
    """

    name: str
    summary: str
    parameters: Record
    inputs: Record
    rest: Record
    start: Callable[..., object]
    observe: Callable[..., object]
    advance: Callable[..., tuple[object, object]]
    step: float
    fixed_step: bool
    hidden: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    @cached_property
    def initial(self) -> object:
        """The state at time zero."""
        return self.start(self.parameters, self.inputs, self.rest)

    @cached_property
    def outputs(self) -> object:
        """The outputs at time zero."""
        return self.observe(self.parameters, self.inputs, self.initial, 0.0)


class Variable(NamedTuple):
    """A number of a block: its name, what it is, and where C finds it in the model."""

    name: str
    causality: str
    value: Annotated[float | int | bool, Form(key="start")]
    place: Unwritten[str]
    unit: str = ""
    meaning: str = ""
    low: Unwritten[float] = -math.inf
    high: Unwritten[float] = math.inf


class ExportedBlock(NamedTuple):
    """What was exported, with its step in s."""

    name: str
    step: float
    variables: list[Variable]
    notes: Sequence[str]


def list_variables(block: Block) -> list[Variable]:
    """List the parameters, inputs and outputs of a block, in this order."""
    parts = {"parameters": block.parameters, "inputs": block.inputs, "outputs": block.outputs}
    found = [v for name, part in parts.items() for v in _walk("", name, part, Variable("", name[:-1], 0.0, ""))]
    # A number that is absent is NaN, which other programs do not take for one.
    return [v for v in found if not v.name.startswith(block.hidden) and not math.isnan(v.value)]


def _walk(name: str, place: str, value: object, what: Variable) -> Iterator[Variable]:
    """Yield the numbers of a value, of which `what` is known."""
    if isinstance(value, bool | int | float):
        # A float of numpy is one of Python's, too, but is not written as one.
        yield what._replace(name=name, place=place, value=float(value) if isinstance(value, float) else value)
    elif isinstance(value, AugmentedDamper | Rig):
        if isinstance(value, Rig):
            yield from _walk("plant", f"{place}.plant", value.plant, what)
            name = "damper"
        yield from _walk(name, f"{place}.damper", value.damper, what)
        yield from _walk_effects(f"{place}.effects", value.effects, what)
    elif hasattr(value, "_fields"):
        yield from _walk_record(name, place, value, what)
    elif isinstance(value, tuple):
        for k, (item, code) in enumerate(zip(value, _places(value), strict=True)):
            inner = f"{name[:-1]},{k + 1}]" if name.endswith("]") else f"{name}[{k + 1}]"
            yield from _walk(inner, f"{place}{code}", item, what)


def _walk_record(name: str, place: str, record: object, what: Variable) -> Iterator[Variable]:
    cls = type(record)
    for known, code in zip(describe(cls), _places(record), strict=True):
        inner = f"{name}.{known.name}" if name else known.name
        value = getattr(record, known.name)
        meaning = known.meaning or inner.replace("_", " ")
        low, high = bounds(cls, known.name) if isinstance(value, int | float) else (-math.inf, math.inf)
        found = what._replace(unit=known.unit, meaning=meaning, low=low, high=high)
        for variable in _walk(inner, f"{place}{code}", value, found):
            yield _with_unit_of_element(variable, cls, known.name) if isinstance(value, tuple) else variable


def _with_unit_of_element(variable: Variable, cls: type, field: str) -> Variable:
    """Return a coefficient of a law with its own unit: that of the law per power of the current."""
    units, position = item_units(cls, field), variable.name.rpartition("[")[2].rstrip("]")
    if not position.isdigit() or not variable.unit or len(units) < int(position):
        return variable
    per = units[int(position) - 1].removeprefix("1/")
    return variable._replace(unit=f"{variable.unit}/{per}") if per else variable


def _walk_effects(place: str, effects: tuple[object, ...], what: Variable) -> Iterator[Variable]:
    """Yield the parameters of effects under their names, those of a body on the seat under `driver`."""
    seen: list[str] = []
    for effect, code in zip(effects, _places(effects), strict=True):
        name = "driver" if isinstance(effect, SeatedBody) else f"effects.{EFFECTS.name_of(type(effect))}"
        seen.append(name)
        number = f"_{seen.count(name)}" if seen.count(name) > 1 else ""
        yield from _walk(f"{name}{number}", f"{place}{code}", effect, what)


def _places(value: object) -> list[str]:
    """Return how C reaches the elements of a tuple or record."""
    kind: types.Type = numba.typeof(value)
    if is_empty(kind):
        return [""] * len(kind)
    if is_row(kind):
        return [f".at[{k}]" for k in range(len(kind))]
    return [f".{name}" for name in c_names(kind)]
