"""Draws a case: some runs of the carrier, one change of it, and the amount at which it has a drawn size."""

from __future__ import annotations

import dataclasses
import math
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from seatsim.blind.carrier.change import Altered, Change
from seatsim.blind.carrier.recorded import Carrier
from seatsim.blind.carrier.replays import Ruler

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
    """Return the change at the amount at which it has a size, None where no amount inside its span has about that."""
    low, high = change.span
    for _ in range(EVALUATIONS):
        middle = 0.5 * (low + high) if low > 0.0 else 0.25 * high
        found = ruler.size(change.alter(middle).carrier)
        if abs(found - size) < CLOSE * size:
            break
        low, high = (middle, high) if found < size else (low, middle)
    altered = change.alter(middle)
    found = ruler.size(altered.carrier)
    fits = 1.0 - 2.0 * CLOSE < found / size < 1.0 + 4.0 * CLOSE and ruler.stands_out(altered.carrier)
    return DrawnCase(change, altered, found) if fits else None


def draw_size(rng: Generator) -> float:
    """Draw a size, log-uniform from just material to strong."""
    return float(np.exp(rng.uniform(math.log(WEAKEST), math.log(STRONGEST))))
