"""Quantities, units and numbers as they are printed: on a terminal, in reports and in pictures."""

from __future__ import annotations

import math
from typing import NamedTuple

LONGEST = 44
"""Letters of a label; longer ones are cut in the middle, so that its ends stay legible."""
_PRETTY = {"degC": "°C", "^1.75": "¹·⁷⁵", "^2": "²", "^3": "³", "ohm": "Ω", " s/m": "·s/m", " s/(m A)": "·s/(m·A)"}
"""What stands in files and in print, in the order in which it is replaced."""
FACTORS = {"m": (1e3, "mm")}
"""Factor and unit of quantities whose values are small in SI units."""
UNKNOWN = "–"
"""Printed in place of a value that is not known."""
MINUS = "−"
RAISED = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")


class Quantity(NamedTuple):
    """How a quantity is shown: its words, the unit shown, and the factor from SI to that unit."""

    words: str
    unit: str
    factor: float = 1.0

    @property
    def axis(self) -> str:
        """The label of an axis, with the unit where there is one."""
        return self.words if self.unit == "-" else f"{self.words} [{self.unit}]"

    @property
    def square(self) -> str:
        """The square of the unit."""
        return f"({self.unit})²" if "/" in self.unit or "·" in self.unit else f"{self.unit}²"


def describe_channel(name: str, unit: str) -> Quantity:
    """Return how a channel in SI units is shown."""
    factor, shown = FACTORS.get(unit, (1.0, format_unit(unit)))
    return Quantity(name.replace("_", " "), shown or "-", factor)


def format_unit(text: str) -> str:
    """Return a unit as it is printed: `N s/m` as `N·s/m`, `m/s^2` as `m/s²`."""
    for written, printed in _PRETTY.items():
        text = text.replace(written, printed)
    return text


def shorten(text: str, longest: int = LONGEST) -> str:
    """Return a text of at most `longest` letters, cut in the middle."""
    half = longest // 2
    return text if len(text) <= longest else f"{text[: half - 1]}…{text[-half:]}"


def format_number(value: float | None, digits: int = 3) -> str:
    """Return a number with that many significant digits, in powers of ten only where it is very large or very small."""
    if value is None or not math.isfinite(value):
        return UNKNOWN
    if value == 0:
        return "0"
    exponent = math.floor(math.log10(abs(float(f"{value:.{digits - 1}e}"))))
    if not -5 < exponent < 7:
        mantissa, _, power = f"{value:.{digits - 1}e}".partition("e")
        return f"{mantissa}\u00a0×\u00a010{str(int(power)).translate(RAISED)}".replace("-", MINUS)
    return f"{value:.{max(0, digits - 1 - exponent)}f}".replace("-", MINUS)


def format_percent(share: float | None) -> str:
    """Return a share (1 is all) in per cent with two significant digits or more, `< 0.1 %` in place of 0.0."""
    if share is None or not math.isfinite(share):
        return UNKNOWN
    value = 100.0 * share
    if 0 < abs(value) < 0.05:
        return "< 0.1 %"
    text = f"{value:.0f} %" if abs(value) >= 9.95 or value == 0 else f"{value:.1f} %"
    return text.replace("-", MINUS)
