"""The unit table of the whole project: what a unit's name means, and how its values become those of another unit.

Units are those of `pint`, in the spellings that loggers and tables use: `m/s2`, `m/s²`, `m_s2`, `g` of an acceleration,
`degF`, `°C`, `lbf`, `daN`, `kp`. Pint is loaded only for what is not among the usual units.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from seatsim.schema.errors import InputError, nearest
from seatsim.schema.yaml_text import parse_value

if TYPE_CHECKING:
    import pint

STANDARD_GRAVITY = 9.80665
"""m/s^2."""


class Conversion(NamedTuple):
    """`factor` value + `zero` is the value in the wanted unit."""

    factor: float
    zero: float = 0.0


_STATED: Any = parse_value(Path(__file__).with_name("units.yaml").read_text(encoding="utf-8"))
DIMENSIONS: dict[str, str] = _STATED["dimensions"]
"""The unit of every kind of quantity that a measured channel may hold."""
CONVERSIONS = {
    si: {unit: Conversion(*how) if isinstance(how, list) else Conversion(how) for unit, how in units.items()}
    for si, units in _STATED["usual"].items()
}
"""Conversions from the units in which a quantity is usually recorded or stated: to load pint takes 0.6 s."""
USUAL = {si: tuple(CONVERSIONS[si]) for si in DIMENSIONS.values()}
"""Units in which a quantity is usually recorded, by its SI unit; errors list them, doubts compare with them."""
OWN_SPELLINGS: Mapping[str, Mapping[str, str]] = {
    wanted: {word: unit for unit, words in spellings.items() for word in words}
    for wanted, spellings in _STATED["spellings"].items()
}
"""Spellings that mean something else, or nothing, to pint, by the unit that is wanted."""
_NO_UNITS = ("links",)
"""Words in names that pint takes for units: `links` is German for left."""


def conversion(unit: str, wanted: str) -> Conversion:
    """Return how values in a unit become values in the wanted one, such as `g` in `m/s^2`.

    Raises:
        InputError: there is no such unit, or it is one of another quantity.
    """
    if unit == wanted:
        return Conversion(1.0)
    found = find_conversion(unit, wanted)
    if found is None:
        usual = USUAL.get(wanted, (wanted,))
        hint = nearest(unit, [each for each in usual if each != unit])
        raise InputError(f"'{unit}' is no unit of a value in {wanted}{hint}; such are {', '.join(usual)}")
    return found


_LONGEST = 60
"""Letters of a unit: pint takes ever longer for more."""


@functools.lru_cache(maxsize=256)
def find_conversion(unit: str, wanted: str) -> Conversion | None:
    """Return the conversion, None where there is none."""
    return CONVERSIONS.get(wanted, {}).get(unit) or _look_up(unit, wanted)


@functools.lru_cache(maxsize=256)
def is_unit(text: str) -> bool:
    """Say whether a text is a unit, of whatever quantity."""
    plain = text.strip().lower()
    if len(text) > _LONGEST or not plain or plain in _NO_UNITS or plain.isdigit():
        return False
    if any(text in units for units in USUAL.values()) or any(plain in units for units in OWN_SPELLINGS.values()):
        return True
    try:
        _registry().Unit(_spelt(text, ""))
    except Exception:  # as in `_look_up`
        return False
    return True


def _look_up(unit: str, wanted: str) -> Conversion | None:
    """Return the conversion that pint knows."""
    if len(unit) > _LONGEST:
        return None
    text, target = _spelt(unit, wanted), _spelt(wanted, wanted)
    if text == target:
        return Conversion(1.0)
    registry = _registry()
    try:
        source = registry.Unit(text)
        at_zero, at_one = (float(registry.Quantity(each, source).to(target).magnitude) for each in (0.0, 1.0))
    except Exception:
        # Pint parses an expression, and a text that is none fails in many ways.
        return None
    # The difference of two temperatures in degC is exact to 1e-13 only; factors of units have far fewer digits.
    return Conversion(float(f"{at_one - at_zero:.13g}"), float(f"{at_zero:.13g}"))


def _spelt(unit: str, wanted: str) -> str:
    """Return a unit as pint spells it: `m_s2`, `m/s²` and `m/s2` are `m/s**2`."""
    plain = unit.strip().strip("[]()")
    own = OWN_SPELLINGS.get(wanted, {}).get(plain.lower())
    plain = own or plain
    for sign, ascii_sign in _STATED["signs"].items():
        plain = plain.replace(sign, ascii_sign)
    plain = plain if own else re.sub(r"^([A-Za-z]+)_([A-Za-z]+\d?)$", r"\1/\2", plain)
    plain = re.sub(r"\bsec\b", "s", plain)
    return re.sub(r"([A-Za-z])\^?(-?\d)", r"\1**\2", plain)


@functools.cache
def _registry() -> pint.UnitRegistry[float]:
    import pint

    return pint.UnitRegistry()
