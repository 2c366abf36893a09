"""What the cases of a set are to be: kind, faults, rig and channels, shuffled; and how strong their faults are."""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from seatsim.blind.make.draw_experiment import draw_experiment, draw_varied_experiment
from seatsim.blind.sealed import EFFECTS, KINDS, Kind
from seatsim.blind.truth.experiment import CHANNELS, Experiment
from seatsim.blind.truth.faults import scenarios_of
from seatsim.schema.errors import InputError, nearest

_PRESETS = ("mixed", "varied")
_BINGHAM_SHARE = 0.5
"""Of the rigs."""
_COMPLETE_SHARE, _AT_MOST_ONE_MISSING = 0.6, 0.93
"""Shares of the rigs that record every channel, and that lack at most one; the others lack two."""
_OPTIONAL = {"damper_force": 0.7, "coil_current": 0.3}
"""Channels that a rig may lack, and how likely each is the one: a load cell is what is saved first.

A fade could not be found without thermometer, so that no rig lacks it, whatever is wrong with it.
"""
LOG_TOLERANCE = 0.2
"""Of the logarithm of a materiality; closer would only cost simulations, as the target is drawn."""
_EVALUATIONS = 9
_MATERIAL = 1.03
"""A little above the limit, as sizes are measured with a coarse step."""
_WEAKEST_TARGET, _STRONGEST_TARGET = 1.1, 8.0
_TINY = 1e-9
"""In place of a materiality of zero, where its logarithm is taken."""
_UNSTABLE_FACTOR = 0.6
"""Of a severity at which the rig was unstable: the new upper bound."""

_Known = list[tuple[float, float]]
"""Severities and their materialities."""


def draw_missing_channels(rng: Generator) -> tuple[str, ...]:
    """Draw the channels that are not recorded: none in 60 % of cases, rarely two."""
    u = rng.random()
    if u < _COMPLETE_SHARE:
        return ()
    count = 1 if u < _AT_MOST_ONE_MISSING else 2
    return tuple(str(name) for name in rng.choice(list(_OPTIONAL), count, replace=False, p=list(_OPTIONAL.values())))


class CaseSpecification(NamedTuple):
    """Specification of a case: its kind, its effects (or the scenarios outside the library), on what kind of rig."""

    kind: Kind
    names: tuple[str, ...] = ()
    varied: bool = False

    def draw_rig(self, rng: Generator) -> Experiment:
        """Draw a rig and its protocol; neither kind nor names are used, so that nothing of it tells what is wrong."""
        gone = draw_missing_channels(rng)
        channels = tuple(name for name in CHANNELS if name not in gone)
        bingham = rng.random() < _BINGHAM_SHARE
        return (draw_varied_experiment if self.varied else draw_experiment)(rng, bingham, channels)


def compose(cases: int, kinds: str | Sequence[str], rng: Generator) -> list[CaseSpecification]:
    """Return the specifications of a set, shuffled.

    `mixed`: a fifth none, a fifth two effects, a fifth outside, the rest one effect, the 24 effects equally often.
    `varied`: the same mix, every case on another rig. Otherwise a kind, which all cases are, or kinds that are gone
    through in turn.

    Raises:
        InputError: there is no such preset or kind.
    """
    specifications = _specify(_kinds(cases, kinds), rng, kinds == "varied")
    return [specifications[k] for k in rng.permutation(cases)]


def _kinds(cases: int, kinds: str | Sequence[str]) -> list[Kind]:
    """Return the kind of each case, before shuffling."""
    if kinds in ("mixed", "varied"):
        fifth = round(cases / 5)
        parts: dict[Kind, int] = {"none": fifth, "two": fifth, "outside": fifth, "one": max(cases - 3 * fifth, 0)}
        return [kind for kind, count in parts.items() for _ in range(count)][:cases]
    by_name, known = {str(kind): kind for kind in KINDS}, (*_PRESETS, *KINDS)
    chosen = [kinds] if isinstance(kinds, str) else kinds
    for name in chosen:
        if name not in by_name:
            raise InputError(f"kinds: {name!r} is not one of {', '.join(known)}{nearest(name, known)}")
    return [by_name[chosen[k % len(chosen)]] for k in range(cases)]


def _specify(kinds: list[Kind], rng: Generator, varied: bool) -> list[CaseSpecification]:
    """Return a specification for each kind; effects and scenarios are dealt so that each comes equally often."""
    singles, pairs = _Dealer(EFFECTS, rng), _Dealer(EFFECTS, rng)
    outside = _Dealer([scenario.name for scenario in scenarios_of("outside")], rng)

    def take(kind: Kind) -> tuple[str, ...]:
        if kind == "two":
            first = pairs.take()
            return first, pairs.take(first)
        return () if kind == "none" else ((singles if kind == "one" else outside).take(),)

    return [CaseSpecification(kind, take(kind), varied=varied) for kind in kinds]


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


def draw_target(rng: Generator, top: float = _STRONGEST_TARGET) -> float:
    """Draw a materiality, log-uniform from the material limit to strong."""
    return float(np.exp(rng.uniform(math.log(_WEAKEST_TARGET), math.log(max(top, _WEAKEST_TARGET * 1.01)))))


def find_severity(
    size_of: Callable[[float], float], span: tuple[float, float], rng: Generator
) -> tuple[float, float] | None:
    """Return severity and materiality near a drawn target, or None where nothing plausible is material.

    Secant steps in the logarithms between bounds that close in; a fault too weak for the target gets a new, lower one.
    `size_of` returns the materiality of a severity, infinite where the rig is unstable.
    """
    target = draw_target(rng)
    low, high = span
    known: _Known = []
    s = min(max(1.0, low), high)
    for _ in range(_EVALUATIONS):
        size = size_of(s)
        if not math.isfinite(size):
            high = _UNSTABLE_FACTOR * s
            s = math.sqrt(max(low, s / 8.0) * high)
            if high <= low:
                return None
            continue
        known.append((s, size))
        if abs(math.log(max(size, _TINY) / target)) < LOG_TOLERANCE:
            break
        if size < target and s >= high * 0.999:
            if size < 1.15:
                return None
            target = draw_target(rng, size)
            s = min(max(s * (target / size), low), high)
            if s >= high * 0.999:
                break
            continue
        s = _next_severity(known, target, low, high)
    material = [pair for pair in known if pair[1] >= _MATERIAL]
    return min(material, key=lambda pair: abs(math.log(pair[1] / target)), default=None)


def _next_severity(known: _Known, target: float, low: float, high: float) -> float:
    """Return the next severity: between the closest below and above, else on from the closest.

    The secant keeps a tenth away from both ends, and an extrapolation to a factor of 0.1 to 6, as materiality is not
    quite a power of the severity.
    """
    below = [pair for pair in known if pair[1] < target]
    above = [pair for pair in known if pair[1] >= target]
    if below and above:
        (s0, m0), (s1, m1) = max(below, key=lambda pair: pair[1]), min(above, key=lambda pair: pair[1])
        share = math.log(target / max(m0, _TINY)) / math.log(m1 / max(m0, _TINY))
        return float(math.exp(math.log(s0) + min(max(share, 0.1), 0.9) * math.log(s1 / s0)))
    s, size = (below or above)[-1]
    return float(min(max(s * min(max(target / max(size, _TINY), 0.1), 6.0), low), high))
