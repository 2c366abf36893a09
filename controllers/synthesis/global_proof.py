"""Proof that no gain in a box is better than a level: branch and bound over boxes of gains.

`controllers.synthesis.exclusion` says why no gain in a box is good enough; a box of which it cannot say so is divided.
Corners and inequalities are exact in binary, so that the list of boxes can be checked in fractions
(`benchmarks/exact_global_proofs.py`). The cost grows with two to the power of the number of gains.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from controllers.synthesis import exclusion
from controllers.synthesis.plant import MATRICES, GeneralisedPlant
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.schema.files import write_whole

MOST_GAINS = 4
"""Free gains up to which boxes are searched."""
FACTOR = 1 - 1e-3
"""Level that is proven, over the norm of the design."""
_SMALLEST = 1e-12
_LEAST_SHARE = 0.1
# Rounds in which inequalities are sought that help at the corners where the sum still falls short of one, and by how
# much it may.
_ROUNDS = 10
_MET = 0.5
# An inequality that holds in part of a box by interpolation holds there in floating-point numbers too.
_ROUNDING = 1e-6


class Split(NamedTuple):
    """A box that was divided: the number of the free gain, and where."""

    gain: int
    at: float


_Reason = exclusion.WeightedSum | exclusion.Unstable | exclusion.OutOfReach


@dataclass(eq=False)
class GlobalProof:
    """What is proven of a box `low` to `high` of the free gains (row by row), in the order in which boxes were halved.

    `level` is what no gain in the box is below; `steps` lists, for a box, its halving followed by the steps of its
    lower and then of its upper half, or what excludes it. `better` is a gain with a norm below the level that was
    found on the way, `open_boxes` what time did not suffice for: with either nothing is proven.
    """

    plants: Sequence[GeneralisedPlant]
    low: Array
    high: Array
    level: float
    steps: list[Split | _Reason] = field(default_factory=list)
    better: Array | None = None
    open_boxes: int = 0

    @property
    def is_proven(self) -> bool:
        """Whether every part of the box is excluded."""
        return self.better is None and self.open_boxes == 0

    @property
    def boxes(self) -> int:
        """Number of boxes that are excluded."""
        return sum(not isinstance(step, Split) for step in self.steps)

    def save(self, path: Path) -> None:
        """Write plants, box, level (null: infinite) and steps as JSON; the file appears whole or not at all."""
        matrices = [{name: getattr(plant, name) for name in MATRICES} for plant in self.plants]
        plants = [each | {"free": plant.free.astype(int)} for each, plant in zip(matrices, self.plants, strict=True)]
        level = self.level if np.isfinite(self.level) else None
        steps = [_name_parts(step) for step in self.steps]
        content = {"low": self.low, "high": self.high, "level": level, "plants": plants, "steps": steps}
        write_whole(path, lambda part: part.write_text(json.dumps(content, default=_to_plain)))


def _name_parts(step: Split | _Reason) -> dict[str, object]:
    if not isinstance(step, exclusion.WeightedSum):
        return step._asdict()
    return {"inequalities": [one._asdict() | {"weight": weight} for weight, one in zip(*step, strict=True)]}


def _to_plain(value: Array | complex) -> object:
    """Return an array as lists, a complex number as its parts; None is a point at infinity."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    return [value.real, value.imag] if np.isfinite(value) else None


def prove_no_better(
    plants: Sequence[GeneralisedPlant],
    level: float,
    low: ArrayLike,
    high: ArrayLike,
    time_budget: float = 600.0,
    progress: Callable[[str], object] = lambda text: None,
) -> GlobalProof:
    """Return the proof that no gain in a box gives stable loops around all plants with norms below a level.

    Boxes are searched depth first. Where the middle of a box is a gain below the level, the search ends with it.

    Args:
        plants: of one shape and structure; one gain serves all, and the largest norm counts.
        level: positive; inf proves that no gain in the box makes all loops stable.
        low: least values of the free gains, row by row, shape (free gains,).
        high: largest values of the free gains.
        time_budget: in s; what is not excluded by then is counted in `open_boxes`.
        progress: is told, now and then, how much of the box is excluded.

    Raises:
        InputError: more free gains than `MOST_GAINS`, or a box of another shape.
    """
    low, high = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
    count = int(plants[0].free.sum())
    if count > MOST_GAINS:
        raise InputError(f"{count} free gains; at most {MOST_GAINS} are searched over their whole box")
    if not low.shape == high.shape == (count,) or not np.all(low < high):
        raise InputError(f"the box needs bounds low < high of {count} gains each")
    proof = GlobalProof(plants, low, high, level)
    views = [exclusion.BoxView(number, plant, level) for number, plant in enumerate(plants)]
    # Depth first, the lower half first: the order in which a checker walks through the steps again.
    known = filter(None, (view.prove_out_of_reach() for view in views if np.isfinite(level)))
    waiting = [_Box(low, high, 1.0, next(known, None))]
    done, end, told = 0.0, time.monotonic() + time_budget, 0.0
    while waiting:
        box = waiting.pop()
        if time.monotonic() > end or np.all(box.high - box.low < _SMALLEST * (high - low)):
            proof.open_boxes = len(waiting) + 1
            break
        if time.monotonic() - told > 1.0:
            told = time.monotonic()
            progress(f"no better gain in {100 * done:.1f} % of the box, {proof.boxes} boxes")
        step, parts = (box.reason, []) if box.reason else _exclude_or_divide(views, box, high - low)
        if isinstance(step, np.ndarray):
            proof.better = step
            break
        proof.steps.append(step)
        waiting += parts
        done += 0.0 if parts else box.share
    return proof


class _Box(NamedTuple):
    """A box of free gains, its share of the whole, why no gain in it is good enough, where known; points to look at."""

    low: Array
    high: Array
    share: float
    reason: _Reason | None
    points: tuple[complex, ...] = ()


def _exclude_or_divide(
    views: Sequence[exclusion.BoxView], box: _Box, whole: Array
) -> tuple[_Reason | Split | Array, list[_Box]]:
    """Return why no gain in a box is good enough, its split and both parts, or a better gain; `whole`: all's width."""
    corners = exclusion.corners_of(box.low, box.high)
    listed, weights = _weigh(views, corners, box.points)
    reason, at_corners = exclusion.state_sum(weights, listed)
    if at_corners.min() > 0:
        return reason, []
    for view in views:
        if (unstable := view.prove_unstable(corners)) is not None:
            return unstable, []
    middle = corners.mean(axis=0)
    peaks = [view.norm_at(middle) for view in views]
    # Where the sum falls short most is where a better gain is likely to be, if there is one.
    worst = corners[int(at_corners.argmin())]
    for values, found in ((middle, peaks), (worst, [view.norm_at(worst) for view in views])):
        if all(peak.value < view.level for view, peak in zip(views, found, strict=True)):
            return views[0].gain(values[None])[0], []
    points = {one.s for one in reason.inequalities if isinstance(one, exclusion.AtPoint)}
    points |= {1j * peak.frequency for peak in peaks if 0 < peak.frequency < np.inf}
    box = box._replace(points=tuple(points))
    slab = _largest_slab(np.vstack([listed.values, at_corners]))
    if slab.share > _LEAST_SHARE:
        alone = exclusion.WeightedSum((1.0,), (listed.rows[slab.row],)) if slab.row < len(listed.rows) else reason
        return _divide(box, slab, alone)
    # That gain is halved which changes most of what was weighed; of nothing, the widest.
    cube = (weights[:, None] * listed.values).reshape(len(weights), *(2,) * len(middle))
    changes = np.array([np.abs(np.diff(cube, axis=axis)).sum() for axis in range(1, cube.ndim)])
    spans = (box.high - box.low) / whole
    return _divide(box, _Slab(0, 0.5, int(np.argmax(changes if changes.any() else spans)), False), None)


def _weigh(
    views: Sequence[exclusion.BoxView], corners: Array, points: tuple[complex, ...]
) -> tuple[exclusion.Inequalities, Array]:
    """Return inequalities and weights whose sum comes as near as was found to holding at all corners of a box."""
    seen = [view.look(corners, np.array(points, dtype=complex)) for view in views]
    listed, weights = exclusion.Inequalities(np.zeros((0, len(corners))), np.zeros(0), []), np.zeros(0)
    mixture = np.ones(len(corners))
    for _ in range(_ROUNDS):
        more = [one.list_inequalities(mixture) for one in seen]
        # Where none has a positive mean, no sum holds at all corners.
        if not any(one.rows for one in more):
            break
        listed = listed.joined(more)
        weights, mixture = exclusion.weigh(listed.values)
        if mixture.max() < _MET:
            break
    return listed, weights


class _Slab(NamedTuple):
    """The part of a box in which an inequality holds: its row, the share of the box, its gain, whether at its top."""

    row: int
    share: float
    gain: int
    at_the_top: bool


def _largest_slab(values: Array) -> _Slab:
    """Return the largest part of a box at one of its ends in which one of the inequalities holds; rows by corners.

    Along an edge of the box an inequality is concave, hence at least as large as the straight line between its ends.
    """
    best = _Slab(0, 0.0, 0, False)
    cube = values.reshape(len(values), *(2,) * (values.shape[1].bit_length() - 1))
    for gain in range(cube.ndim - 1):
        low, high = np.moveaxis(cube, gain + 1, 0).reshape(2, len(values), -1)
        for near, far, at_the_top in ((low, high, False), (high, low, True)):
            crossing = (near > 0) & (far < 0)
            shares = np.where(crossing, near / np.where(crossing, near - far, 1.0), 1.0).min(axis=1)
            shares[near.min(axis=1) <= 0] = 0.0
            row = int(shares.argmax())
            if shares[row] > best.share:
                best = _Slab(row, float(shares[row]) * (1 - _ROUNDING), gain, at_the_top)
    return best


def _divide(box: _Box, slab: _Slab, reason: _Reason | None) -> tuple[Split, list[_Box]]:
    """Cut a slab off a box, for which there is a reason or none; the upper part comes first."""
    gain, part = slab.gain, 1 - slab.share if slab.at_the_top else slab.share
    at = float(box.low[gain] + part * (box.high[gain] - box.low[gain]))
    middle_low, middle_high = box.low.copy(), box.high.copy()
    middle_low[gain] = middle_high[gain] = at
    below = _Box(box.low, middle_high, box.share * part, None if slab.at_the_top else reason, box.points)
    above = _Box(middle_low, box.high, box.share * (1 - part), reason if slab.at_the_top else None, box.points)
    return Split(gain, at), [above, below]
