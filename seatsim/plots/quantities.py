"""How quantities are shown: in words, and in a unit in which their values are neither small nor large."""

from __future__ import annotations

from typing import NamedTuple

FACTORS = {"m": (1e3, "mm")}
"""Factor and unit of quantities whose values are small in SI units."""


class Quantity(NamedTuple):
    """How a quantity is shown: its words, the unit shown, and the factor from SI to that unit."""

    words: str
    unit: str
    factor: float = 1.0

    @property
    def axis(self) -> str:
        """The label of an axis."""
        return f"{self.words} [{self.unit}]"
