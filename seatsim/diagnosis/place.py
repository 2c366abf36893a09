"""Which block the gap lies in: from the causes found, or from what each block lacks on its own."""

from __future__ import annotations

import numpy as np

from seatsim.diagnosis.blocks import lacking, missing
from seatsim.diagnosis.findings import Share
from seatsim.diagnosis.fit import Engine, State
from seatsim.diagnosis.search import Search
from seatsim.diagnosis.verdict import movements

ALONE = 0.9
"""Share of the whitened excess in one channel from which that channel's sensor is suspected."""
OPPOSED = 0.5
"""Share of the forces on frame and driver that remains of their sum where the cushion exchanges them."""


def places(engine: Engine, found: Search, chosen: State, explained: bool) -> list[Share]:
    """Return the blocks, ranked by their share of the gap; with an unexplained rest the first is where that lies."""
    shares: dict[str, float] = {}
    for term, move in zip(chosen.point.terms, movements(engine, chosen), strict=True):
        shares[term.block] = shares.get(term.block, 0.0) + float(np.mean(move**2))
    if not explained:
        rest = unexplained(engine, chosen if _helps(found, chosen) else found.calibrated)
        if not _helps(found, chosen):
            shares = {}
        top = max(shares.values(), default=0.0)
        leader = max(rest, key=lambda block: rest[block])
        scale = 1.2 * max(top, 1e-9) / rest[leader]
        for block, size in rest.items():
            shares[block] = shares.get(block, 0.0) + size * scale
    total = sum(shares.values())
    ranked = sorted(shares.items(), key=lambda item: -item[1])
    return [Share(block, size / total) for block, size in ranked if size > 0.0]


def _helps(found: Search, chosen: State) -> bool:
    return found.excess(chosen) < 0.5 * found.excess(found.calibrated)


def unexplained(engine: Engine, state: State) -> dict[str, float]:
    """Return the power that each block lacks at a state, relative to what acts in it; at least one is above zero."""
    problem = engine.problem
    excess = sum(np.mean(values**2, axis=1) - 1.0 for values in state.whitened.values()).clip(0.0)
    alone = int(np.argmax(excess))
    if len(excess) > 1 and excess[alone] > ALONE * excess.sum() and np.delete(excess, alone).max() < 1.0:
        return {"sensor": 1.0}
    if problem.bench:
        electric = problem.channels[alone] == "coil_current"
        return {"coil": 1.0} if electric else {"damper": 1.0}
    lack = lacking(problem, state.point, missing(problem, state.point))
    if lack.get("coil", 0.0) > 0.3 * max(lack["damper"], lack["suspension"], lack["driver"], 0.02):
        return {"coil": 1.0}
    if lack.get("sensor", 0.0) > 1.5 * max(lack["damper"], lack["suspension"], lack["driver"]):
        return {"sensor": 1.0}
    damper, frame, driver, total = lack["damper"], lack["suspension"], lack["driver"], lack["total"]
    powers = {"damper": damper**2, "suspension": frame**2, "driver": driver**2, "cushion": 0.0}
    if min(frame, driver) > 0.5 * max(frame, driver, damper) and total < OPPOSED * max(frame, driver):
        powers |= {"suspension": total**2, "driver": 0.0, "cushion": max(frame, driver) ** 2}
    if "damper_force" not in problem.channels:
        powers["damper"], powers["suspension"] = powers["suspension"], 0.5 * powers["suspension"]
    powers["damper"] = powers["damper"] or 1e-9
    return powers
