"""Draws a case: some runs of the carrier, one change of it, and the amount at which it has a drawn size."""

from __future__ import annotations

import dataclasses
import math
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from seatsim.blind.carrier.change import Altered, Change
from seatsim.blind.carrier.recorded import Carrier
from seatsim.blind.carrier.replays import MATERIAL_SHARE, Ruler

WEAKEST, STRONGEST = 0.06, 0.3
"""Standard deviations of a compared channel by which a change moves it: just material, and strong."""
MOST_RUNS = 6
"""Of a case, one of which may be withheld: a diagnosis is to take seconds."""
CLOSE = 0.1
"""Relative difference of a size from the one drawn that is close enough."""
EVALUATIONS = 12


class DrawnCase(NamedTuple):
    """A carrier with an effect in it, and what is true of that."""

    change: Change
    altered: Altered
    size: float
    """Of the change, in standard deviations of the channel that it moves most."""


def choose_runs(carrier: Carrier, rng: Generator) -> Carrier:
    """Return the carrier with at most `MOST_RUNS` of its runs, drawn and in their own order."""
    names = list(carrier.tables)
    kept = sorted(rng.choice(len(names), min(MOST_RUNS, len(names)), replace=False))
    return dataclasses.replace(carrier, tables={names[k]: carrier.tables[names[k]] for k in kept})


def draw_amount(ruler: Ruler, change: Change, size: float) -> DrawnCase | None:
    """Return the change at the amount at which it has a size, None where no amount inside its span has about that.

    A change with a single amount, such as a removal, is taken as it is where it is material.
    """
    if change.span[0] == change.span[1]:
        return _at(ruler, change, change.span[0], MATERIAL_SHARE, math.inf)
    low, high = change.span
    for _ in range(EVALUATIONS):
        middle = 0.5 * (low + high) if low > 0.0 else 0.25 * high
        found = ruler.size(change.alter(middle).carrier)
        if abs(found - size) < CLOSE * size:
            break
        low, high = (middle, high) if found < size else (low, middle)
    return _at(ruler, change, middle, (1.0 - 2.0 * CLOSE) * size, (1.0 + 4.0 * CLOSE) * size)


def _at(ruler: Ruler, change: Change, amount: float, least: float, most: float) -> DrawnCase | None:
    altered = change.alter(amount)
    size = ruler.size(altered.carrier)
    fits = least < size < most and ruler.stands_out(altered.carrier)
    return DrawnCase(change, altered, size) if fits else None


def draw_size(rng: Generator) -> float:
    """Draw a size, log-uniform from just material to strong."""
    return float(np.exp(rng.uniform(math.log(WEAKEST), math.log(STRONGEST))))
