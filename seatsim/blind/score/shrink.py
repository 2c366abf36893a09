"""The true shrink of the gap: the augmented scenario replayed on a run that the diagnosis was never given."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from seatsim.blind.score.rates import Rate, count_true
from seatsim.blind.score.verdicts import NAMING, Verdict
from seatsim.blind.sealed import Sealed
from seatsim.schema.errors import SeatsimError
from seatsim.schema.guarded import temporary_folder
from seatsim.schema.processes import Progress, run_jobs

_FEWEST_FOR_PROCESSES = 8
"""Cases below which a new process costs more time, for its imports, than it saves."""
_CaseShrink = tuple[str, float, float, bool | None]
"""Name, stated shrink, true shrink (NaN: cannot be replayed), whether the interval holds (None: none is given)."""


_ROUNDING = 1e-9
"""By how much a true shrink may lie beyond an interval of no width, as of a scenario that is left as it is."""


class ShrinkScore(NamedTuple):
    """Stated against true shrink on the unseen runs: mean absolute and mean difference, coverage, and each case.

    `predicted` holds the same of the shrink that is predicted from the inputs of these runs alone.
    """

    mean_difference: float
    bias: float
    coverage: Rate
    cases: list[_CaseShrink]
    predicted: ShrinkScore | None = None


class _UnseenShrink(NamedTuple):
    """The shrink on an unseen run: true, and predicted from its inputs with an interval; None where there is none."""

    true: float | None
    predicted: float | None = None
    interval: tuple[float, float] | None = None


def score_shrink(
    base: Path, opened: Sealed, verdicts: dict[str, Verdict], processes: int, progress: Progress | None
) -> ShrinkScore | None:
    """Return stated against true shrink of the cases below `base` that state one; None where none does."""
    claims = {n: augmented for n in opened.labels if (augmented := _find_augmented(verdicts[n])) is not None}
    if not claims:
        return None
    with temporary_folder() as temporary:
        jobs = [(base / n / "nominal.yaml", claimed, opened.extract(n, temporary)) for n, claimed in claims.items()]
        found = run_jobs(_find_unseen_shrink, jobs, processes if len(jobs) >= _FEWEST_FOR_PROCESSES else 1, progress)
    pairs = list(zip(claims, found, strict=True))
    stated = [_compare_case(n, verdicts[n].shrink, verdicts[n].shrink_interval, each.true) for n, each in pairs]
    foretold = [(n, each) for n, each in pairs if each.predicted is not None]
    expected = [_compare_case(n, each.predicted, each.interval, each.true) for n, each in foretold]
    return _compare(stated)._replace(predicted=_compare(expected) if expected else None)


def _find_augmented(verdict: Verdict) -> Path | None:
    """Return the scenario whose shrink can be checked, None where none is stated: under `none` nothing shrinks."""
    return verdict.augmented if verdict.verdict in (*NAMING, "unknown") and verdict.shrink is not None else None


def _compare_case(
    name: str, shrink: float | None, interval: tuple[float, float] | None, true: float | None
) -> _CaseShrink:
    covered = None if interval is None or true is None else interval[0] - _ROUNDING <= true <= interval[1] + _ROUNDING
    return name, float(shrink or 0.0), math.nan if true is None else true, covered


def _compare(cases: Sequence[_CaseShrink]) -> ShrinkScore:
    coverage = count_true([covered for *_, covered in cases if covered is not None])
    off = np.array([claimed - true for _, claimed, true, _ in cases if math.isfinite(true)])
    if not off.size:
        return ShrinkScore(math.nan, math.nan, coverage, list(cases))
    return ShrinkScore(float(np.mean(np.abs(off))), float(np.mean(off)), coverage, list(cases))


def _find_unseen_shrink(nominal: Path, augmented: Path, unseen: Path) -> _UnseenShrink:
    """Return `1 - after / before` of the overall gap on the unseen recording, and what its inputs let one expect.

    Raises:
        InputError: the diagnosis is of another kind of rig, so that these are not the diagnoses of this set.
    """
    # imported here, since both import the whole simulator, which only a score with unseen runs needs
    from seatsim.recordings.gap import measure_gap
    from seatsim.recordings.prediction import OtherRigError, predict_gap

    try:
        predicted = predict_gap(augmented, unseen, augmented.with_name("diagnosis.json"))
    except OtherRigError:
        raise
    except SeatsimError:
        predicted = None  # a diagnosis of another tool states no model error
    try:
        true = 1.0 - measure_gap(augmented, unseen).overall / measure_gap(nominal, unseen).overall
    except SeatsimError:
        return _UnseenShrink(None)
    return _UnseenShrink(true, predicted.shrink, predicted.shrink_interval) if predicted else _UnseenShrink(true)
