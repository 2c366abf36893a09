"""A damper model as a fit sees it: fields read and replaced by name, their units, and laws in the current."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from functools import cache
from typing import NamedTuple, Protocol, Self, TypeAlias, TypeVar, cast

import numpy as np

from seatsim.cosimulation.damper import PREFIX
from seatsim.dampers.base import DAMPERS
from seatsim.kernel.generic import DamperModel
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError, nearest
from seatsim.schema.fields import bounds, describe, item_units
from seatsim.schema.validation import is_finite_number

FieldValue: TypeAlias = float | str | tuple[float, ...]
"""A number (an `int` too), one of several words, or the coefficients of a law in the current."""


class DamperRecord(DamperModel, Protocol):
    """A damper model's parameters: the `NamedTuple` that the model's class is."""

    def _asdict(self) -> dict[str, FieldValue]: ...

    def _replace(self, **changes: FieldValue) -> Self: ...


def find_model(name: str) -> type[DamperRecord]:
    """Return the class of a damper model.

    Raises:
        InputError: no damper has this name, or it is that of a unit.
    """
    if name.startswith(PREFIX):
        raise InputError(
            f"{name} is a unit of another program, whose parameters its supplier knows; a model of the library can be"
            " fitted to its bench tables, such as --model bouc_wen"
        )
    # A damper's record has fields of any type; those that a fit reads and replaces are numbers, words and laws.
    return cast("type[DamperRecord]", DAMPERS.find(name))


def law_range(fields: Mapping[str, FieldValue], default: float) -> float:
    """Return the current in A up to which a model's laws hold: its field `law_end`, or the default without one."""
    end = fields.get("law_end", default)
    assert isinstance(end, int | float)
    return float(end)


@cache
def is_current_law(cls: type, field: str) -> bool:
    """Whether a tuple field holds the coefficients of a polynomial in the current: units `-`, `1/A`, `1/A^2`, ..."""
    return item_units(cls, field)[:2] == ["", "1/A"]


def evaluate_law(coefficients: Sequence[float], currents: Array) -> Array:
    """Return a law's values, shape (N,), at currents in A of shape (N,)."""
    return np.asarray(np.polynomial.polynomial.polyval(currents, np.array(coefficients)), dtype=float)


def interpolate_law(values: Array, end: float) -> list[float]:
    """Return the coefficients of the law with these values, shape (K,), at K currents spread evenly over 0 to `end`."""
    # The system is solved in the current over `end`, where it is better conditioned.
    powers = np.vander(np.linspace(0.0, 1.0, len(values)), increasing=True)
    return [float(c / end**k) for k, c in enumerate(np.linalg.solve(powers, values))]


_UNIT = re.compile(r"(?<![A-Za-z\[])(N|m|s|A)(?![A-Za-z\]])(?:\^(-?\d+(?:\.\d+)?))?")
"""One of N, m, s, A with its power; letters in brackets are other quantities, such as `[z]`."""


class Scales(NamedTuple):
    """Sizes of the data: force [N], stroke [m], speed [m/s], current [A]."""

    force: float
    stroke: float
    speed: float
    current: float

    def size(self, unit: str) -> float:
        """Return the size that a quantity of this unit has in these data; time counts by stroke over speed."""
        powers = parse_unit(unit)
        time = self.stroke / self.speed
        sizes = {"N": self.force, "m": self.stroke, "s": time, "A": self.current}
        return float(math.prod(sizes[name] ** power for name, power in powers.items()))


def parse_unit(unit: str) -> dict[str, float]:
    """Return the powers of N, m, s and A in a unit such as `N s/(m A)`."""
    top, _, bottom = unit.partition("/")
    powers: dict[str, float] = {}
    for text, sign in ((top, 1.0), (bottom, -1.0)):
        for name, power in _UNIT.findall(text):
            powers[name] = powers.get(name, 0.0) + sign * float(power or 1.0)
    return powers


R = TypeVar("R", bound=DamperRecord)

RANGE_FIELDS = ("law_end",)
"""Fields that state where a model holds; they are set from the data, not fitted."""


def rescale_damper(record: R, force: float, end: float) -> R:
    """Return a record for another damper: its forces times `force`, its laws stretched to the current `end` in A."""
    fields = record._asdict()
    stretch = end / (law_range(fields, end) or end)
    changed: dict[str, FieldValue] = {"law_end": end} if "law_end" in fields else {}
    for specification in describe(type(record)):
        value = fields[specification.name]
        powers = parse_unit(specification.unit)
        factor = force ** powers.get("N", 0.0)
        if specification.name in RANGE_FIELDS or isinstance(value, int | str):
            continue
        if isinstance(value, tuple):
            law = is_current_law(type(record), specification.name)
            changed[specification.name] = tuple(factor * c / (stretch**k if law else 1.0) for k, c in enumerate(value))
        else:
            changed[specification.name] = value * factor * stretch ** powers.get("A", 0.0)
    return record._replace(**changed)


def fix_parameters(record: R, values: Mapping[str, float]) -> R:
    """Return a record with some numbers as the user fixes them.

    Raises:
        InputError: a name is no number of the model, or its value is none or out of bounds.
    """
    known = numeric_fields(type(record))
    for name, value in values.items():
        if name not in known:
            raise InputError(f"--fix {name}: no such number{nearest(name, known)}; permitted: {', '.join(known)}")
        low, high = bounds(type(record), name)
        whole = isinstance(record._asdict()[name], int)
        if not _is_permitted(value, low, high, whole):
            kind = "a whole number" if whole else "a number"
            raise InputError(f"--fix {name}={value} is not permitted; it must be {kind} from {low:g} to {high:g}")
        record = record._replace(**{name: int(value) if whole else float(value)})
    return record


def _is_permitted(value: object, low: float, high: float, whole: bool) -> bool:
    """Whether a value, which may be any word of the command line, is a finite number within bounds."""
    return is_finite_number(value) and low <= value <= high and not (whole and value != int(value))


def numeric_fields(cls: type) -> list[str]:
    """Return the names of the numbers of a record class, those that can be fixed."""
    return [specification.name for specification in describe(cls) if isinstance(specification.default, int | float)]
