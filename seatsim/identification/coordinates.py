"""The parameters of a damper model as a vector that a fit can search.

Every component is a pure number of order one: a parameter over its size, or the logarithm of that ratio where it must
be positive. A law in the current counts by its values at currents spread over its range, not by its coefficients, which
are strongly correlated; these values stay at least zero where they are so at the start, since a damping below zero lets
a state run away at currents that the data hardly hold.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any, NamedTuple, get_args, get_type_hints

import numpy as np
from numpy.typing import NDArray

from seatsim.schema.errors import InputError, nearest
from seatsim.schema.fields import bounds, describe

Array = NDArray[np.float64]

SETTINGS = ("law_end",)
"""Fields that state where a model holds; they are set from the data, not fitted."""
SPAN = 1e3
"""Factor by which a positive parameter may differ from its start where its bounds do not say."""
UNIT = re.compile(r"(?<![A-Za-z\[])(N|m|s|A)(?![A-Za-z\]])(?:\^(-?\d+(?:\.\d+)?))?")


class Scales(NamedTuple):
    """Sizes of the data: force [N], stroke [m], speed [m/s], current [A]."""

    force: float
    stroke: float
    speed: float
    current: float

    def size(self, unit: str) -> float:
        """Return the size that a quantity of this unit has in these data."""
        powers = dimension(unit)
        time = self.stroke / self.speed
        sizes = {"N": self.force, "m": self.stroke, "s": time, "A": self.current}
        return float(math.prod(sizes[name] ** power for name, power in powers.items()))


def dimension(unit: str) -> dict[str, float]:
    """Return the powers of N, m, s and A in a unit such as `N s/(m A)`."""
    top, _, bottom = unit.partition("/")
    powers: dict[str, float] = {}
    for text, sign in ((top, 1.0), (bottom, -1.0)):
        for name, power in UNIT.findall(text):
            powers[name] = powers.get(name, 0.0) + sign * float(power or 1.0)
    return powers


class Component(NamedTuple):
    """One component of the vector: where it belongs, and how it is scaled.

    `place` is the index in a tuple field, None for a number. A law's component is its value at the current `at`.
    `size` is what the component counts in, `natural` a tenth of the size that a quantity of its unit has in the data.
    """

    field: str
    place: int | None
    unit: str
    size: float
    natural: float
    logarithmic: bool
    low: float
    high: float
    at: float | None

    @property
    def name(self) -> str:
        """Name as the parameter files have it."""
        return self.field if self.place is None else f"{self.field}[{self.place}]"

    @property
    def label(self) -> str:
        """Name of what the component is: the same, or the value of a law at a current."""
        return self.name if self.at is None else f"{self.field}({self.at:.3g} A)"


class Coordinates:
    """The free parameters of a record class, between the record and a vector of shape (P,).

    start: a record of the class, from which sizes are taken; fixed: fields that stay as they are in it; levels: how
    many currents the data hold, which a law's degree stays below, None for any number.
    """

    def __init__(self, start: Any, scales: Scales, fixed: Sequence[str] = (), levels: int | None = None) -> None:
        self.start, self.levels = start, levels
        self.cls: Any = type(start)
        self.end = float(getattr(start, "law_end", scales.current) or 1.0)
        self.components: list[Component] = []
        self.bounds = {specification.name: bounds(self.cls, specification.name) for specification in describe(self.cls)}
        for specification in describe(self.cls):
            value = getattr(start, specification.name)
            moot = scales.current == 0.0 and dimension(specification.unit).get("A", 0.0) != 0.0
            if specification.name not in (*SETTINGS, *fixed) and not moot and not isinstance(value, int | str):
                self.components += self._of_field(specification.name, specification.unit, value, scales)
        self.low = np.array([c.low for c in self.components])
        self.high = np.array([c.high for c in self.components])

    def _of_field(self, name: str, unit: str, value: Any, scales: Scales) -> list[Component]:
        natural = 0.1 * scales.size(unit)
        if isinstance(value, tuple):
            return self._of_tuple(name, unit, value, natural)
        low, high = self.bounds[name]
        size = abs(value) or natural
        if low > 0.0 or (low == 0.0 and value > 0.0):
            ends = math.log(max(low, size / SPAN) / size), math.log(min(high, size * SPAN) / size)
            return [Component(name, None, unit, size, natural, True, *ends, None)]
        return [Component(name, None, unit, size, natural, False, low / size, high / size, None)]

    def _of_tuple(self, name: str, unit: str, value: Any, natural: float) -> list[Component]:
        if not is_law(self.cls, name):
            size = float(np.max(np.abs(value))) or natural
            return [
                Component(name, k, unit, size, natural, False, -math.inf, math.inf, None) for k in range(len(value))
            ]
        at = np.linspace(0.0, self.end, min(len(value), self.levels or len(value)))
        values = law_values(value, at)
        size = float(np.max(np.abs(values))) or natural
        low = 0.0 if np.min(values) >= 0.0 < np.max(values) else -math.inf
        return [Component(name, k, unit, size, natural, False, low, math.inf, float(a)) for k, a in enumerate(at)]

    def vector(self, record: Any) -> Array:
        """Return the vector of a record."""
        values = []
        for c in self.components:
            value = getattr(record, c.field)
            if c.at is not None:
                value = float(law_values(value, np.array([c.at]))[0])
            elif c.place is not None:
                value = value[c.place]
            values.append(math.log(max(value, 1e-12 * c.size) / c.size) if c.logarithmic else value / c.size)
        return np.asarray(np.clip(values, self.low, self.high), dtype=float)

    def record(self, vector: Array) -> Any:
        """Return the record of a vector."""
        changed: dict[str, Any] = {}
        for c, number in zip(self.components, vector, strict=True):
            value = c.size * (math.exp(number) if c.logarithmic else float(number))
            if c.place is None:
                low, high = self.bounds[c.field]
                changed[c.field] = min(max(value, low), high)
            else:
                changed.setdefault(c.field, []).append(value)
        for name, values in changed.items():
            if isinstance(values, list):
                law = is_law(self.cls, name)
                rest = [0.0] * (len(getattr(self.start, name)) - len(values))
                changed[name] = (*law_coefficients(np.array(values), self.end), *rest) if law else tuple(values)
        return self.start._replace(**changed)


@cache
def is_law(cls: Any, name: str) -> bool:
    """Whether a tuple field holds the coefficients of a polynomial in the current."""
    hint = get_type_hints(cls, include_extras=True)[name]
    parts = get_args(get_args(hint)[0])
    inner = [str(getattr(get_args(part)[1], "json_schema_extra", {}).get("unit", "")) for part in parts]
    return len(inner) > 1 and inner[:2] == ["", "1/A"]


def law_values(coefficients: Any, currents: Array) -> Array:
    """Return a law's values at some currents."""
    return np.asarray(np.polynomial.polynomial.polyval(currents, np.array(coefficients)), dtype=float)


def law_coefficients(values: Array, end: float) -> list[float]:
    """Return the coefficients of the law that has these values at its nodes."""
    count = len(values)
    powers = np.vander(np.linspace(0.0, 1.0, count), increasing=True)
    return [float(c / end**k) for k, c in enumerate(np.linalg.solve(powers, values))]


def scaled(record: Any, force: float, end: float) -> Any:
    """Return a record for another damper: its forces times `force`, its laws stretched to the current `end`."""
    cls: Any = type(record)
    stretch = end / float(getattr(record, "law_end", end) or end)
    changed: dict[str, Any] = {"law_end": end} if hasattr(record, "law_end") else {}
    for specification in describe(cls):
        value = getattr(record, specification.name)
        powers = dimension(specification.unit)
        factor = force ** powers.get("N", 0.0)
        if specification.name in SETTINGS or isinstance(value, int | str):
            continue
        if isinstance(value, tuple):
            law = is_law(cls, specification.name)
            changed[specification.name] = tuple(factor * c / (stretch**k if law else 1.0) for k, c in enumerate(value))
        else:
            changed[specification.name] = value * factor * stretch ** powers.get("A", 0.0)
    return record._replace(**changed)


def fixed(record: Any, values: Mapping[str, float]) -> Any:
    """Return a record with some numbers as the user fixes them.

    Raises:
        InputError: a name is no number of the model, or its value is none or out of bounds.
    """
    known = numbers_of(type(record))
    for name, value in values.items():
        if name not in known:
            raise InputError(f"--fix {name}: no such number{nearest(name, known)}; permitted: {', '.join(known)}")
        low, high = bounds(type(record), name)
        whole = isinstance(getattr(record, name), int)
        number = isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
        if not number or not low <= value <= high or (whole and value != int(value)):
            kind = "a whole number" if whole else "a number"
            raise InputError(f"--fix {name}={value} is not permitted; it must be {kind} from {low:g} to {high:g}")
        record = record._replace(**{name: int(value) if whole else float(value)})
    return record


def numbers_of(cls: type) -> list[str]:
    """Return the names of the numbers of a record class, those that can be fixed."""
    return [specification.name for specification in describe(cls) if isinstance(specification.default, int | float)]
