"""The unit table of the whole project: what a unit's name means, and how its values become those of another unit.

Units are those of `pint`, in the spellings that loggers and tables use: `m/s2`, `m/s²`, `m_s2`, `g` of an acceleration,
`degF`, `°C`, `lbf`, `daN`, `kp`. Pint is loaded only for what is not among the usual units.
"""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

from seatsim.schema.errors import InputError, nearest

if TYPE_CHECKING:
    import pint

DIMENSIONS = {
    "acceleration": "m/s^2",
    "length": "m",
    "velocity": "m/s",
    "force": "N",
    "current": "A",
    "voltage": "V",
    "temperature": "degC",
    "time": "s",
    "angular_acceleration": "rad/s^2",
}
"""The unit of every kind of quantity that a measured channel may hold."""
STANDARD_GRAVITY = 9.80665
"""m/s^2."""


class Conversion(NamedTuple):
    """`factor` value + `zero` is the value in the wanted unit."""

    factor: float
    zero: float = 0.0


_FAHRENHEIT, _KELVIN = Conversion(5.0 / 9.0, -160.0 / 9.0), Conversion(1.0, -273.15)
_USUAL: Mapping[str, Mapping[str, float | Conversion]] = {
    "m/s^2": {"m/s^2": 1.0, "g": STANDARD_GRAVITY, "mm/s^2": 1e-3, "cm/s^2": 0.01, "ft/s^2": 0.3048},
    "m": {"m": 1.0, "cm": 0.01, "mm": 1e-3, "um": 1e-6, "inch": 0.0254},
    "m/s": {"m/s": 1.0, "cm/s": 0.01, "mm/s": 1e-3, "km/h": 1.0 / 3.6},
    "N": {"N": 1.0, "kN": 1e3, "daN": 10.0, "lbf": 4.4482216152605, "kgf": STANDARD_GRAVITY},
    "A": {"A": 1.0, "mA": 1e-3},
    "V": {"V": 1.0, "mV": 1e-3},
    "degC": {"degC": 1.0, "degF": _FAHRENHEIT, "K": _KELVIN},
    "s": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0},
    "rad/s^2": {"rad/s^2": 1.0, "deg/s^2": math.pi / 180.0},
    "kg": {"g": 1e-3, "t": 1e3},
    "N/m": {"N/mm": 1e3, "N/cm": 1e2},
    "N s/m": {"N s/mm": 1e3, "N s/cm": 1e2},
}
CONVERSIONS = {
    si: {unit: how if isinstance(how, Conversion) else Conversion(how) for unit, how in units.items()}
    for si, units in _USUAL.items()
}
"""Conversions from the units in which a quantity is usually recorded or stated: to load pint takes 0.6 s."""
USUAL = {si: tuple(CONVERSIONS[si]) for si in DIMENSIONS.values()}
"""Units in which a quantity is usually recorded, by its SI unit; errors list them, doubts compare with them."""
OWN_SPELLINGS = {
    "m/s^2": dict.fromkeys(("g", "gn", "g_n", "g0"), "standard_gravity")
    | dict.fromkeys(("ms2", "ms-2", "ms^-2", "ms⁻²", "m.s-2"), "m/s^2")
    | {"gal": "cm/s^2", "mg": "millistandard_gravity"},
    "degC": dict.fromkeys(("c", "celsius", "deg c", "grad c"), "degC")
    | dict.fromkeys(("f", "fahrenheit", "deg f"), "degF")
    | {"k": "kelvin"},
    "N": {"lb": "lbf", "lbs": "lbf", "kg": "kgf", "kp": "kgf", "newton": "N", "newtons": "N"},
    "A": {"amp": "A", "amps": "A", "ampere": "A", "amperes": "A"},
    "V": {"volt": "V", "volts": "V"},
    "s": {"sec": "s", "msec": "ms", "usec": "us", "sek": "s"},
    "m": {'"': "inch", "in": "inch", "zoll": "inch"},
}
"""Spellings that mean something else, or nothing, to pint, by the unit that is wanted: `g` of a mass is a gram."""
_SIGNS = {"⁻²": "^-2", "²": "^2", "³": "^3", "°": "deg", "℃": "degC", "℉": "degF"}
_SIGNS |= dict.fromkeys("µμ", "u") | dict.fromkeys("·⋅", "*")
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
    for sign, ascii_sign in _SIGNS.items():
        plain = plain.replace(sign, ascii_sign)
    plain = plain if own else re.sub(r"^([A-Za-z]+)_([A-Za-z]+\d?)$", r"\1/\2", plain)
    plain = re.sub(r"\bsec\b", "s", plain)
    return re.sub(r"([A-Za-z])\^?(-?\d)", r"\1**\2", plain)


@functools.cache
def _registry() -> pint.UnitRegistry[float]:
    import pint

    return pint.UnitRegistry()
