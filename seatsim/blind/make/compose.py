"""The composition of a set: the specification of each case, shuffled."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

from numpy.random import Generator

from seatsim.blind.labels import EFFECTS, KINDS, Kind
from seatsim.blind.make.draw_case import CaseSpecification
from seatsim.blind.truth.experiment import COMPARED
from seatsim.blind.truth.outside_faults import scenarios_of
from seatsim.schema.errors import InputError, nearest

_PRESETS = ("mixed", "varied", "null", "background")
BACKGROUND = 6.0
"""Random force on the frame of the preset `background`, N rms: half of that which counts as an effect of severity 1."""


def compose(cases: int, kinds: str | Sequence[str], rng: Generator) -> list[CaseSpecification]:
    """Return the specifications of a set, shuffled.

    `mixed`: a fifth none, a fifth two effects, a fifth outside, the rest one effect, the 24 effects equally often.
    `varied`: the same mix, every case on another rig. `null`: faultless over every subset of channels. `background`:
    faultless, a random force on the frame, and a repeated run that shows it. Otherwise a kind, which all cases are, or
    kinds that are gone through in turn.

    Raises:
        InputError: there is no such preset or kind.
    """
    if kinds == "null":
        subsets = null_subsets()
        specifications = [CaseSpecification("none", (), subsets[k % len(subsets)]) for k in range(cases)]
    elif kinds == "background":
        specifications = [CaseSpecification("none", background=BACKGROUND) for _ in range(cases)]
    else:
        specifications = _specify(_kinds(cases, kinds), rng, kinds == "varied")
    return [specifications[k] for k in rng.permutation(cases)]


def null_subsets() -> list[tuple[str, ...]]:
    """Return every set of channels to leave out that leaves a floor, a current and something to compare."""
    optional = (*COMPARED, "damper_temperature", "current_command")
    subsets = [some for count in range(len(optional) + 1) for some in combinations(optional, count)]
    needed: list[set[str]] = [{"current_command", "coil_current"}, set(COMPARED) - {"coil_current"}]
    return [some for some in subsets if not any(either <= set(some) for either in needed)]


def _kinds(cases: int, kinds: str | Sequence[str]) -> list[Kind]:
    """Return the kind of each case, before shuffling."""
    if kinds in ("mixed", "varied"):
        fifth = round(cases / 5)
        parts: dict[Kind, int] = {"none": fifth, "two": fifth, "outside": fifth, "one": max(cases - 3 * fifth, 0)}
        return [kind for kind, count in parts.items() for _ in range(count)][:cases]
    chosen = [_known_kind(kind) for kind in ([kinds] if isinstance(kinds, str) else kinds)]
    return [chosen[k % len(chosen)] for k in range(cases)]


def _known_kind(name: str) -> Kind:
    for kind in KINDS:
        if kind == name:
            return kind
    known = (*_PRESETS, *KINDS)
    raise InputError(f"kinds: {name!r} is not one of {', '.join(known)}{nearest(name, known)}")


def _specify(kinds: list[Kind], rng: Generator, varied: bool) -> list[CaseSpecification]:
    """Return a specification for each kind; effects and scenarios are dealt so that each comes equally often."""
    singles, pairs = _Dealer(EFFECTS, rng), _Dealer(EFFECTS, rng)
    outside = _Dealer([scenario.name for scenario in scenarios_of("outside")], rng)
    specifications = []
    for kind in kinds:
        match kind:
            case "one":
                names: tuple[str, ...] = (singles.take(),)
            case "two":
                first = pairs.take()
                names = (first, pairs.take(first))
            case "outside":
                names = (outside.take(),)
            case "none":
                names = ()
        specifications.append(CaseSpecification(kind, names, varied=varied))
    return specifications


class _Dealer:
    """Names dealt until none is left, then shuffled anew: every name equally often."""

    def __init__(self, names: Sequence[str], rng: Generator) -> None:
        self.names, self.rng = list(names), rng
        self.left: list[str] = []

    def take(self, but: str = "") -> str:
        """Deal a name that is not `but`."""
        if not self.left or self.left == [but]:
            self.left = [self.names[k] for k in self.rng.permutation(len(self.names))]
        place = -1 if self.left[-1] != but else -2
        return self.left.pop(place)
