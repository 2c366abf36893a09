"""The parameters of a damper model as a vector that a fit can search.

Every component is a pure number of order one: a parameter over its size, or the logarithm of that ratio where it must
be positive. A law in the current counts by its values at currents spread over its range, not by its coefficients, which
are strongly correlated.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, get_args, get_type_hints

import numpy as np
from numpy.typing import NDArray

from seatsim.errors import InputError, nearest
from seatsim.fields import bounds, describe

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
    """

    field: str
    place: int | None
    unit: str
    size: float
    logarithmic: bool
    low: float
    high: float
    at: float | None

    @property
    def name(self) -> str:
        """Name as the parameter files have it."""
        return self.field if self.place is None else f"{self.field}[{self.place}]"


class Coordinates:
    """The free parameters of a record class, between the record and a vector of shape (P,).

    start: a record of the class, from which sizes are taken; held: fields that stay as they are in it; levels: how many
    currents the data hold, which a law's degree stays below.
    """

    def __init__(self, start: Any, scales: Scales, held: Sequence[str] = (), levels: int = 99) -> None:
        self.start, self.cls, self.levels = start, type(start), levels
        self.end = float(getattr(start, "law_end", scales.current) or 1.0)
        self.components: list[Component] = []
        for card in describe(self.cls):
            value = getattr(start, card.name)
            moot = scales.current == 0.0 and dimension(card.unit).get("A", 0.0) < 0.0
            if card.name not in (*SETTINGS, *held) and not moot and not isinstance(value, int | str):
                self.components += self._of_field(card.name, card.unit, value, scales)
        self.low = np.array([c.low for c in self.components])
        self.high = np.array([c.high for c in self.components])

    def _of_field(self, name: str, unit: str, value: Any, scales: Scales) -> list[Component]:
        guess = 0.1 * scales.size(unit)
        if not isinstance(value, tuple):
            low, high = bounds(self.cls, name)
            positive = low > 0.0 or (low == 0.0 and value > 0.0)
            size = abs(value) or guess
            if positive:
                least, most = max(low, size / SPAN), min(high, size * SPAN)
                return [Component(name, None, unit, size, True, math.log(least / size), math.log(most / size), None)]
            return [Component(name, None, unit, size, False, low / size, high / size, None)]
        count, law = len(value), is_law(self.cls, name)
        at = np.linspace(0.0, self.end, min(count, self.levels)) if law else np.full(count, math.nan)
        size = float(np.max(np.abs(law_values(value, at) if law else np.array(value)))) or guess
        return [
            Component(name, k, unit, size, False, -math.inf, math.inf, float(a) if law else None)
            for k, a in enumerate(at)
        ]

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
                changed[c.field] = value
            else:
                changed.setdefault(c.field, []).append(value)
        for name, values in changed.items():
            if isinstance(values, list):
                law = is_law(self.cls, name)
                rest = [0.0] * (len(getattr(self.start, name)) - len(values))
                changed[name] = (*law_coefficients(np.array(values), self.end), *rest) if law else tuple(values)
        return self.start._replace(**changed)


def is_law(cls: type, name: str) -> bool:
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
    cls = type(record)
    stretch = end / float(getattr(record, "law_end", end) or end)
    changed: dict[str, Any] = {"law_end": end} if hasattr(record, "law_end") else {}
    for card in describe(cls):
        value = getattr(record, card.name)
        powers = dimension(card.unit)
        factor = force ** powers.get("N", 0.0)
        if card.name in SETTINGS or isinstance(value, int | str):
            continue
        if isinstance(value, tuple):
            law = is_law(cls, card.name)
            changed[card.name] = tuple(factor * c / (stretch**k if law else 1.0) for k, c in enumerate(value))
        else:
            changed[card.name] = value * factor * stretch ** powers.get("A", 0.0)
    return record._replace(**changed)


def fixed(record: Any, values: Mapping[str, float]) -> Any:
    """Return a record with some numbers as the user fixes them.

    Raises:
        InputError: a name is no number of the model, or its value is out of bounds.
    """
    cls = type(record)
    known = [card.name for card in describe(cls) if not isinstance(card.default, tuple)]
    for name, value in values.items():
        if name not in known:
            raise InputError(f"--fix {name}: no such number{nearest(name, known)}; permitted: {', '.join(known)}")
        low, high = bounds(cls, name)
        if not low <= value <= high:
            raise InputError(f"--fix {name}={value:g}: is not permitted; it must lie between {low:g} and {high:g}")
    return record._replace(**values)
