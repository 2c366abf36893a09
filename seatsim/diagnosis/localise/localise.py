"""Which block the gap lies in: from the causes found, or from what an unknown input in each block would explain."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from seatsim.diagnosis.decide import movements
from seatsim.diagnosis.fit import Engine, State
from seatsim.diagnosis.localise.hypotheses import Suspect, suspects
from seatsim.diagnosis.result import Share
from seatsim.diagnosis.select import Search

DECISIVE = 0.1
"""Share of what the best block explains by which another must fall short to be told from it."""
ON_FRAME = ("damper", "suspension", "floor")
"""Blocks whose unknown input is a force on the frame."""
SLIGHT = 0.02
"""Share of the gap by which effects that do not explain it must help an unknown input, not to be given up for it."""


class Rest(NamedTuple):
    """What is unexplained: the blocks that could hold it, likeliest first, each with its share of the belief."""

    suspects: dict[str, Suspect]
    shares: dict[str, float]

    @property
    def block(self) -> str:
        """The likeliest block."""
        return next(iter(self.shares))


def places(engine: Engine, chosen: State, rest: Rest | None) -> list[Share]:
    """Return the blocks, ranked by their share of the gap; with an unexplained rest the first is where that lies."""
    shares: dict[str, float] = {}
    for term, move in zip(chosen.point.terms, movements(engine, chosen), strict=True):
        shares[term.block] = shares.get(term.block, 0.0) + float(np.mean(move**2))
    if rest is not None:
        scale = 1.2 * max(shares.values(), default=1.0) / rest.shares[rest.block]
        for block, share in rest.shares.items():
            shares[block] = shares.get(block, 0.0) + share * scale
    total = sum(shares.values())
    ranked = sorted(shares.items(), key=lambda item: -item[1])
    return [Share(block, size / total) for block, size in ranked if size > 0.0]


def unexplained(engine: Engine, found: Search, chosen: State) -> tuple[Rest, State]:
    """Return what is unexplained, and the state that it is missing from: the calibrated rig where one block will do.

    Effects that were chosen and do not explain the gap are given up for one unknown input, unless that leaves more.
    """
    plain = _rest(engine, found.calibrated)
    if not chosen.point.terms:
        return plain, chosen
    beside = _rest(engine, chosen)
    slight = SLIGHT * found.excess(found.calibrated)
    if plain.suspects[plain.block].doubt < beside.suspects[beside.block].doubt + slight:
        return plain, found.calibrated
    return beside, chosen


def _rest(engine: Engine, state: State) -> Rest:
    """Return the blocks that could hold what a state leaves.

    A slow force on the driver is one on the frame, since the two move as one: where both explain nearly the same, it is
    the frame's.
    """
    engine.refresh(state)
    found = suspects(engine, state)
    rows = sum(values.size for values in state.whitened.values())
    before, best = state.cost / rows - 1.0, min(suspect.doubt for suspect in found.values())
    width = DECISIVE * max(before - best, 1e-6)
    driver = found["driver"].doubt + width
    if min(found[block].doubt for block in ON_FRAME if block in found) < driver:
        found["driver"] = found["driver"]._replace(doubt=driver)
    best = min(suspect.doubt for suspect in found.values())
    weights = {block: math.exp(-(suspect.doubt - best) / width) for block, suspect in found.items()}
    ranked = sorted(weights.items(), key=lambda item: -item[1])
    return Rest(found, {block: weight / sum(weights.values()) for block, weight in ranked})
