"""A damper model as a fit sees it: fields by name, their units, laws in the current, and all of them as a vector.

Every component of the vector is a pure number of order one: a parameter over its size, or the logarithm of that ratio
where it must be positive. A law in the current counts by its values at currents spread over its range, not by its
coefficients, which are strongly correlated; these values stay at least zero where they are so at the start, since a
damping below zero lets a state run away at currents that the data hardly hold.
"""

import math
import re
from collections.abc import Mapping, Sequence
from functools import cache
from typing import NamedTuple, Protocol, Self, TypeAlias, TypeVar, cast

import numpy as np

from seatsim.dampers.base import DAMPERS
from seatsim.kernel.generic import DamperModel
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError, permit
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
        InputError: no damper has this name.
    """
    # A damper's record has fields of any type; those that a fit reads and replaces are numbers, words and laws.
    return cast("type[DamperRecord]", DAMPERS.find(name))


def _law_range(fields: Mapping[str, FieldValue], default: float) -> float:
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


def _interpolate_law(values: Array, end: float) -> list[float]:
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
        powers = _parse_unit(unit)
        time = self.stroke / self.speed
        sizes = {"N": self.force, "m": self.stroke, "s": time, "A": self.current}
        return float(math.prod(sizes[name] ** power for name, power in powers.items()))


def _parse_unit(unit: str) -> dict[str, float]:
    """Return the powers of N, m, s and A in a unit such as `N s/(m A)`."""
    top, _, bottom = unit.partition("/")
    powers: dict[str, float] = {}
    for text, sign in ((top, 1.0), (bottom, -1.0)):
        for name, power in _UNIT.findall(text):
            powers[name] = powers.get(name, 0.0) + sign * float(power or 1.0)
    return powers


R = TypeVar("R", bound=DamperRecord)

_RANGE_FIELDS = ("law_end",)
"""Fields that state where a model holds; they are set from the data, not fitted."""


def rescale_damper(record: R, force: float, end: float) -> R:
    """Return a record for another damper: its forces times `force`, its laws stretched to the current `end` in A."""
    fields = record._asdict()
    stretch = end / (_law_range(fields, end) or end)
    changed: dict[str, FieldValue] = {"law_end": end} if "law_end" in fields else {}
    for specification in describe(type(record)):
        value = fields[specification.name]
        powers = _parse_unit(specification.unit)
        factor = force ** powers.get("N", 0.0)
        if specification.name in _RANGE_FIELDS or isinstance(value, int | str):
            continue
        if isinstance(value, tuple):
            law = is_current_law(type(record), specification.name)
            changed[specification.name] = tuple(factor * c / (stretch**k if law else 1.0) for k, c in enumerate(value))
        else:
            changed[specification.name] = value * factor * stretch ** powers.get("A", 0.0)
    return record._replace(**changed)


def _default_record(cls: type[DamperRecord], current: float) -> DamperRecord:
    """Return a class at its defaults, with its laws stretched to a current in A."""
    blank = [specification.name for specification in describe(cls) if specification.required]
    if blank:
        raise InputError(f"{cls.__name__}: a fit starts from defaults; give {', '.join(blank)} one")
    return rescale_damper(cls(), 1.0, current)


def start_record(
    cls: type[DamperRecord], known: DamperRecord | None, current: float, fix: Mapping[str, float]
) -> DamperRecord:
    """Return the record from which a fit starts: a known one, or the defaults, some numbers as the user fixes them."""
    return fix_parameters(known or _default_record(cls, current), fix)


def fix_parameters(record: R, values: Mapping[str, float]) -> R:
    """Return a record with some numbers as the user fixes them.

    Raises:
        InputError: a name is no number of the model, or its value is none or out of bounds.
    """
    known = numeric_fields(type(record))
    for name, value in values.items():
        if name not in known:
            raise InputError(f"--fix {name}: no such number{permit(name, known)}")
        low, high = bounds(type(record), name)
        whole = isinstance(record._asdict()[name], int)
        # A value may be any word of the command line.
        if not is_finite_number(value) or not low <= value <= high or (whole and value != int(value)):
            kind = "a whole number" if whole else "a number"
            raise InputError(f"--fix {name}={value} is not permitted; it must be {kind} from {low:g} to {high:g}")
        record = record._replace(**{name: int(value) if whole else float(value)})
    return record


def numeric_fields(cls: type) -> list[str]:
    """Return the names of the numbers of a record class, those that can be fixed."""
    return [specification.name for specification in describe(cls) if isinstance(specification.default, int | float)]


_SPAN = 1e3
"""Factor by which a positive parameter may differ from its start, and from its size in the data, where its bounds do
not say."""
_DATA_SHARE = 0.1
"""Share of what its unit is worth in the data that a parameter counts in where it is zero at the start."""
_LEAST_RATIO = 1e-12
"""Least ratio of a positive parameter to its size, so that its logarithm exists."""


class Component(NamedTuple):
    """One component of the vector: where it belongs, and how it is scaled.

    `position` is that in a tuple field, None for a number. A law's component is its value at the current `at` in A.
    `size` is what the component counts in, `natural` a tenth of the size that a quantity of its unit has in the data.
    `low` and `high` bound the component itself, a pure number.
    """

    field: str
    position: int | None
    unit: str
    size: float
    natural: float
    logarithmic: bool
    low: float
    high: float
    at: float | None = None

    @property
    def name(self) -> str:
        """Name as the parameter files have it."""
        return self.field if self.position is None else f"{self.field}[{self.position}]"

    @property
    def label(self) -> str:
        """Name of what the component is: the same, or the value of a law at a current."""
        return self.name if self.at is None else f"{self.field}({self.at:.3g} A)"

    def read(self, value: FieldValue) -> float:
        """Return the number of a field's value, or the coefficient of a law, that the component belongs to."""
        number = value[self.position] if isinstance(value, tuple) and self.position is not None else value
        assert isinstance(number, int | float)
        return number

    def to_number(self, value: FieldValue) -> float:
        """Return the component of a field's value."""
        if self.at is not None:
            assert isinstance(value, tuple)
            return float(evaluate_law(value, np.array([self.at]))[0]) / self.size
        number = self.read(value)
        return math.log(max(number, _LEAST_RATIO * self.size) / self.size) if self.logarithmic else number / self.size

    def to_value(self, number: float) -> float:
        """Return the parameter in its unit, or the value of the law, that a component stands for."""
        return self.size * (math.exp(number) if self.logarithmic else float(number))


class Coordinates:
    """The free parameters of a record class, between the record and a vector of shape (P,).

    start: a record of the class, from which sizes are taken. fixed: fields that stay as they are in it. levels: how
    many currents the data hold, which a law's degree stays below, None for any number. `end` is the current in A up to
    which laws are counted; `low` and `high` bound the vector.
    """

    def __init__(
        self, start: DamperRecord, scales: Scales, fixed: Sequence[str] = (), levels: int | None = None
    ) -> None:
        self.start, self.levels = start, levels
        self.cls = type(start)
        self.fields: Mapping[str, FieldValue] = start._asdict()
        self.end = _law_range(self.fields, scales.current) or 1.0
        self.bounds = {name: bounds(self.cls, name) for name in self.fields}
        self.components: list[Component] = []
        for specification in describe(self.cls):
            value = self.fields[specification.name]
            # Without any current in the data, what multiplies it has no influence at all.
            moot = scales.current == 0.0 and _parse_unit(specification.unit).get("A", 0.0) != 0.0
            kept = specification.name in (*_RANGE_FIELDS, *fixed) or moot
            if not kept and not isinstance(value, int | str):
                natural = _DATA_SHARE * scales.size(specification.unit)
                self.components += self._of_field(specification.name, specification.unit, value, natural)
        self.low = np.array([c.low for c in self.components])
        self.high = np.array([c.high for c in self.components])

    def _of_field(self, name: str, unit: str, value: float | tuple[float, ...], natural: float) -> list[Component]:
        if isinstance(value, tuple):
            return self._of_tuple(name, unit, value, natural)
        low, high = self.bounds[name]
        size = abs(value) or natural
        if low > 0.0 or (low == 0.0 and value > 0.0):
            # What the data are a thousand times larger than has no influence, whatever the default is.
            least = max(low, min(size, natural) / _SPAN)
            most = high if math.isfinite(high) else _SPAN * max(size, natural)
            ends = math.log(least / size), math.log(most / size)
            return [Component(name, None, unit, size, natural, True, *ends)]
        return [Component(name, None, unit, size, natural, False, low / size, high / size)]

    def _of_tuple(self, name: str, unit: str, value: tuple[float, ...], natural: float) -> list[Component]:
        if not is_current_law(self.cls, name):
            size = float(np.max(np.abs(value))) or natural
            return [Component(name, k, unit, size, natural, False, -math.inf, math.inf) for k in range(len(value))]
        at = np.linspace(0.0, self.end, min(len(value), self.levels or len(value)))
        values = evaluate_law(value, at)
        size = float(np.max(np.abs(values))) or natural
        low = 0.0 if np.min(values) >= 0.0 < np.max(values) else -math.inf
        return [Component(name, k, unit, size, natural, False, low, math.inf, float(a)) for k, a in enumerate(at)]

    def to_vector(self, record: DamperRecord) -> Array:
        """Return the vector of a record, shape (P,), moved into its bounds."""
        fields = record._asdict()
        values = [c.to_number(fields[c.field]) for c in self.components]
        return np.asarray(np.clip(values, self.low, self.high), dtype=float)

    def to_record(self, vector: Array) -> DamperRecord:
        """Return the record of a vector of shape (P,); numbers are moved into the bounds of their fields."""
        changed: dict[str, FieldValue] = {}
        tuples: dict[str, list[float]] = {}
        for c, number in zip(self.components, vector, strict=True):
            value = c.to_value(number)
            if c.position is None:
                low, high = self.bounds[c.field]
                changed[c.field] = min(max(value, low), high)
            else:
                tuples.setdefault(c.field, []).append(value)
        changed |= {name: self._to_tuple(name, values) for name, values in tuples.items()}
        return self.start._replace(**changed)

    def _to_tuple(self, name: str, values: list[float]) -> tuple[float, ...]:
        """Return a tuple field from its components; coefficients that a law of few values lacks are zero."""
        if not is_current_law(self.cls, name):
            return tuple(values)
        before = self.fields[name]
        assert isinstance(before, tuple)
        return (*_interpolate_law(np.array(values), self.end), *[0.0] * (len(before) - len(values)))
