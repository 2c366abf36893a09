"""What can be moved on the page: numbers, choices, and effects that are switched on and off."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from seatsim.schema.errors import InputError
from seatsim.schema.validation import is_finite_number


class Slider(NamedTuple):
    """A number: its name in a request, what it is called, its unit, its range and where it starts, in that unit.

    `factor` leads from SI units to the unit shown.
    """

    name: str
    label: str
    unit: str
    low: float
    high: float
    value: float
    factor: float = 1.0


class Choice(NamedTuple):
    """One of several: its name in a request, what it is called, values with their words; the first is chosen."""

    name: str
    label: str
    options: Sequence[tuple[str, str]]


class Switch(NamedTuple):
    """Something that is on or off, with numbers that matter only while it is on."""

    name: str
    label: str
    meaning: str
    sliders: Sequence[Slider]


def read_number(request: Mapping[str, object], slider: Slider) -> float:
    """Return the value of a slider in a request in SI units, that at which it starts where the request has none.

    Raises:
        InputError: it is no number, or outside the range.
    """
    value = request.get(slider.name, slider.value)
    if not is_finite_number(value) or not slider.low <= value <= slider.high:
        raise InputError(f"{slider.label}: {value!r} is not permitted; {slider.low:g} to {slider.high:g} {slider.unit}")
    return float(value) / slider.factor


def read_choice(request: Mapping[str, object], choice: Choice) -> str:
    """Return the chosen value of a request, the first one where the request has none.

    Raises:
        InputError: there is no such value.
    """
    known = [value for value, _ in choice.options]
    value = request.get(choice.name, known[0])
    if value not in known:
        raise InputError(f"{choice.label}: {value!r} is not permitted; one of {', '.join(map(repr, known))}")
    return str(value)
