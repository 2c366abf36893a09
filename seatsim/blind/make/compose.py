"""The composition of a set: what each case shall be, shuffled."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

from numpy.random import Generator

from seatsim.blind.make.case import COMPARED
from seatsim.blind.make.draw import KINDS, Order
from seatsim.blind.truth.catalogue import forms_of
from seatsim.blind.truth.truth import EFFECTS
from seatsim.schema.errors import InputError, nearest

PRESETS = ("mixed", "null", "background")
BACKGROUND = 6.0
"""Random force on the frame of the preset `background`, N rms."""


def compose(cases: int, kinds: str | Sequence[str] | None, rng: Generator) -> list[Order]:
    """Return the orders of a set, shuffled.

    `mixed` (or None): a fifth none, a fifth two effects, a fifth outside, the rest one effect, the 24 effects equally
    often. `null`: faultless over every subset of channels. `background`: faultless, a random force on the frame, and a
    repeated run that shows it. A list of kinds is gone through in turn.
    """
    if kinds == "null":
        subsets = null_subsets()
        orders = [Order("none", (), subsets[k % len(subsets)]) for k in range(cases)]
    elif kinds == "background":
        orders = [Order("none", background=BACKGROUND) for _ in range(cases)]
    else:
        orders = _mixed(_kinds(cases, kinds), rng)
    return [orders[k] for k in rng.permutation(cases)]


def null_subsets() -> list[tuple[str, ...]]:
    """Return every set of channels to leave out that leaves a floor, a current and something to compare."""
    loose = (*COMPARED, "damper_temperature", "current_command")
    subsets = [some for count in range(len(loose) + 1) for some in combinations(loose, count)]
    return [some for some in subsets if _usable(some)]


def _usable(missing: tuple[str, ...]) -> bool:
    gone = set(missing)
    if {"current_command", "coil_current"} <= gone:
        return False
    motion = {"frame_acceleration", "driver_acceleration", "suspension_displacement", "damper_force"}
    return not motion <= gone


def _kinds(cases: int, kinds: str | Sequence[str] | None) -> list[str]:
    if kinds is None or kinds == "mixed":
        fifth = round(cases / 5)
        return (["none"] * fifth + ["two"] * fifth + ["outside"] * fifth + ["one"] * max(cases - 3 * fifth, 0))[:cases]
    if isinstance(kinds, str):
        if kinds not in KINDS:
            known = (*PRESETS, *KINDS)
            raise InputError(f"kinds: {kinds!r} is not one of {', '.join(known)}{nearest(kinds, known)}")
        kinds = [kinds]
    for kind in kinds:
        if kind not in KINDS:
            raise InputError(f"kinds: {kind!r} is not one of {', '.join(KINDS)}{nearest(kind, KINDS)}")
    return [kinds[k % len(kinds)] for k in range(cases)]


def _mixed(kinds: list[str], rng: Generator) -> list[Order]:
    singles, pairs, outside = (
        _Deck(EFFECTS, rng),
        _Deck(EFFECTS, rng),
        _Deck([t.name for t in forms_of("outside")], rng),
    )
    orders = []
    for kind in kinds:
        match kind:
            case "one":
                names: tuple[str, ...] = (singles.take(),)
            case "two":
                first = pairs.take()
                names = (first, pairs.take(first))
            case "outside":
                names = (outside.take(),)
            case _:
                names = ()
        orders.append(Order(kind, names))
    return orders


class _Deck:
    """Cards dealt until none is left, then shuffled anew: every name equally often."""

    def __init__(self, names: Sequence[str], rng: Generator) -> None:
        self.names, self.rng = list(names), rng
        self.left: list[str] = []

    def take(self, but: str = "") -> str:
        """Deal a card that is not `but`."""
        if not self.left or self.left == [but]:
            self.left = [self.names[k] for k in self.rng.permutation(len(self.names))]
        place = -1 if self.left[-1] != but else -2
        return self.left.pop(place)
