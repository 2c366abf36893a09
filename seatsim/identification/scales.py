"""How large quantities of a unit are in bench data, so that parameters of all units count as numbers near 1."""

from __future__ import annotations

import math
import re
from typing import NamedTuple

UNIT = re.compile(r"(?<![A-Za-z\[])(N|m|s|A)(?![A-Za-z\]])(?:\^(-?\d+(?:\.\d+)?))?")
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
        for name, power in UNIT.findall(text):
            powers[name] = powers.get(name, 0.0) + sign * float(power or 1.0)
    return powers
