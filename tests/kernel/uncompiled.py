"""Records made up for tests that call the kernel's functions as plain Python, without compiling them."""

import math
from types import SimpleNamespace
from typing import NamedTuple

from seatsim.schema.registry import register


def plugged(name, initial=(), current_order=0):
    """Enter a record with its state at rest and the degree of its force in the current.

    It has a kind of its own: scenarios and other tests do not see it.
    """
    return register("part of a test", name, SimpleNamespace(initial=initial, current_order=current_order))


@plugged("linear")
class Linear(NamedTuple):
    """`F = (c + b i) v + k x`, with a set-valued friction and temperature factors on every part."""

    c: float = 800.0
    b: float = 300.0
    k: float = 1000.0
    friction: float = 0.0

    def force(self, x, v, i, scaling, z):
        return (self.c + self.b * i) * scaling.viscous * v + self.k * scaling.stiffness * x

    def coulomb(self, i, scaling):
        return self.friction * scaling.yield_force


@plugged("hysteretic", initial=(0.0, 0.0))
class Hysteretic(NamedTuple):
    """`F = c v + s i z0 + 100 z1` with `z0' = a (v - z0)` and `z1' = x`."""

    c: float = 300.0
    s: float = 2000.0
    a: float = 50.0

    def force(self, x, v, i, scaling, z):
        return self.c * scaling.viscous * v + self.s * i * scaling.yield_force * z[0] + 100.0 * z[1]

    def rates(self, x, v, i, scaling, z):
        return (self.a * (v - z[0]), x)


@plugged("yielding")
class Yielding(NamedTuple):
    """`F = c v + (fa + fb i) tanh(v / 1 cm/s)`, the second term by the yield factor; `offset` is part of it."""

    c: float = 400.0
    fa: float = 50.0
    fb: float = 600.0
    offset: float = 0.0
    coulomb_force: float = 0.0

    def force(self, x, v, i, scaling, z):
        part = (self.fa + self.fb * i) * math.tanh(v / 0.01) + self.offset
        return self.c * scaling.viscous * v + scaling.yield_force * part

    def coulomb(self, i, scaling):
        return self.coulomb_force * (1.0 + i) * scaling.yield_force


class Feedback(NamedTuple):
    """A law that wants `gain v` and counts its samples in its state."""

    gain: float = 1000.0

    def wanted_force(self, y, state):
        return self.gain * y.velocity

    def update(self, y, state):
        return (state[0] + 1.0,)


class Commanded(NamedTuple):
    """A law that asks for one current at all times."""

    current: float = 0.5

    def wanted_current(self, y, state):
        return self.current
