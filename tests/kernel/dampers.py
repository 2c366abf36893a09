"""Dampers made up to try the inverse: a force that is no monotone function of the current, and a parabola."""

import math
from typing import NamedTuple

from .uncompiled import plugged


class Wavy(NamedTuple):
    """`F = v (500 + 400 sin(3 pi i))`: 900 v at 1/6 A, 100 v at 1/2 A, 900 v again at 5/6 A."""

    mean: float = 500.0
    swing: float = 400.0

    def force(self, x: float, v: float, i: float, scaling, z) -> float:
        return v * (self.mean + self.swing * math.sin(3.0 * math.pi * i))


class Bump(NamedTuple):
    """`F = v (500 + slope i + height exp(-((i - centre) / width)^2))`: a turn at a current, up or down."""

    centre: float = 0.5
    width: float = 0.1
    height: float = 300.0
    slope: float = 0.0

    def force(self, x: float, v: float, i: float, scaling, z) -> float:
        return v * (500.0 + self.slope * i + self.height * math.exp(-(((i - self.centre) / self.width) ** 2)))


@plugged("parabola", current_order=2)
class Parabola(NamedTuple):
    """`F = v (a + b i + c i^2)`."""

    a: float = 200.0
    b: float = 1200.0
    c: float = -1000.0

    def force(self, x: float, v: float, i: float, scaling, z) -> float:
        return v * (self.a + self.b * i + self.c * i * i)


class Steep(NamedTuple):
    """`F = v (500 + height s^power)` with `s = (i - start) / width`, and 500 v below the start."""

    start: float
    width: float
    height: float = 1000.0
    power: float = 9.0

    def force(self, x: float, v: float, i: float, scaling, z) -> float:
        return v * (500.0 + self.height * (max(i - self.start, 0.0) / self.width) ** self.power)
