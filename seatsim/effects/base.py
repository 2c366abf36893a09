"""What an effect is: a small physical change of the simulated rig, switched on in a scenario.

An effect is a record of parameters with `def change(self, rig)`, which returns the rig with the effect added; at its
parameters' zero it returns the rig unchanged. Its name is `block.effect`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, TypeVar

from seatsim.registry import register

T = TypeVar("T", bound=type)


class EffectCard(NamedTuple):
    """What is stated of an effect: its source."""

    source: str


def effect(name: str, source: str = "") -> Callable[[T], T]:
    """Register a record class as `effect: name`, where the part before the dot is the block it lives in."""
    return register("effect", name, EffectCard(source))
