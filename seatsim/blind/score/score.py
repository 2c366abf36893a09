"""Scores the diagnoses of a blind set against its sealed labels."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from seatsim.blind.score.cases import (
    Bin,
    Failure,
    FoundSize,
    Rate,
    ScoredCase,
    brier_score,
    calibration_error,
    compare_sizes,
    confusion,
    count_named,
    count_true,
    describe_failure,
    missing_channels,
    rate_right,
    rates_by,
    reliability,
    strength_class,
)
from seatsim.blind.score.shrink import ShrinkScore, score_shrink
from seatsim.blind.score.verdicts import (
    NAMING,
    Verdict,
    is_block_first,
    is_isolable_group_first,
    is_wrong_name,
    read_verdict,
)
from seatsim.blind.sealed import EFFECTS, KINDS, Label, unseal
from seatsim.schema.errors import InputError
from seatsim.schema.processes import Progress


@dataclass(frozen=True)
class Score:
    """All figures of a set, the content of `score.json`; rates hold how many of how many."""

    right: Rate
    kinds: dict[str, Rate]
    outside_with_block: Rate
    """Outside the library: refused, and the right block first."""
    top1: Rate
    """One effect: it is the likeliest cause."""
    top3: Rate
    """One effect: it is among the three likeliest causes."""
    block: Rate
    """Something is wrong: the first block is one where it is."""
    block_coarse: Rate
    """The same, with blocks that the channels cannot tell apart taken for one."""
    wrong_names: Rate
    """One effect, simulated or carried: an effect is selected, and the first is neither right nor in a right group."""
    false_alarms: Rate
    detected: Rate
    two_recall: Rate
    """Two effects: of the true ones, those selected."""
    two_precision: Rate
    """Two effects: of those selected, the true ones."""
    calibration_error: float
    brier: float
    reliability: list[Bin]
    shrink: ShrinkScore | None
    group_size: float
    """Mean number of effects in the indistinguishable group that is named."""
    effects: dict[str, Rate]
    forms: dict[str, Rate]
    confusion: dict[str, dict[str, int]]
    by_missing: dict[str, Rate]
    by_size: dict[str, Rate]
    failures: list[Failure]
    cases: int
    untouched: dict[str, int]
    """What was named first, and how often, on measured recordings without any effect put in; not scored."""
    found_sizes: list[FoundSize]
    """Parameters of carried effects that were found, beside the true ones."""


def score(
    folder: str | Path,
    sealed: str | Path,
    key: str,
    diagnoses: str = "diagnosis",
    unseen: bool = True,
    progress: Progress | None = None,
    processes: int = 2,
) -> Score:
    """Score DIR/case-*/DIAGNOSES/diagnosis.json against the sealed labels.

    With `unseen`, the stated shrink is compared with that of `augmented.yaml` on the run that was never given;
    `progress` is called with the replays done and all.

    Raises:
        InputError: wrong key, changed file, another set's folder, or a diagnosis that is no diagnosis.
    """
    base = Path(folder)
    opened = unseal(Path(sealed), key, base)
    verdicts = {name: read_verdict(base / name / diagnoses / "diagnosis.json") for name in opened.labels}
    if all(verdict.verdict == "missing" for verdict in verdicts.values()):
        raise InputError(f"{base}: no case-*/{diagnoses}/diagnosis.json; diagnose the cases first")
    shrink = score_shrink(base, opened, verdicts, processes, progress) if unseen else None
    return score_verdicts(opened.labels, verdicts, shrink)


def score_verdicts(
    labels: Mapping[str, Label], verdicts: Mapping[str, Verdict], shrink: ShrinkScore | None = None
) -> Score:
    """Return the score of verdicts by case against labels by case."""
    every = [ScoredCase(name, label, verdicts[name]) for name, label in labels.items()]
    cases = [case for case in every if case.label["kind"] != "untouched"]
    kinds = {kind: [case for case in cases if case.label["kind"] == kind] for kind in (*KINDS, "carried")}
    known = kinds["one"] + kinds["carried"]
    faulty = [case for case in cases if case.label["kind"] != "none"]
    stated, true = _marginals(cases)
    table = reliability(stated, true)
    recall, precision = _recall_and_precision(kinds["two"])
    single = known + kinds["outside"]
    return Score(
        right=rate_right(cases),
        kinds={kind: rate_right(some) for kind, some in kinds.items() if some},
        outside_with_block=count_true([c.right and is_block_first(c.label, c.verdict) for c in kinds["outside"]]),
        top1=_rate_among_first(known, 1),
        top3=_rate_among_first(known, 3),
        block=count_true([is_block_first(c.label, c.verdict) for c in faulty]),
        block_coarse=count_true([is_isolable_group_first(c.label, c.verdict) for c in faulty]),
        wrong_names=count_true([is_wrong_name(c.label, c.verdict) for c in known]),
        false_alarms=count_true([c.verdict.verdict != "none" for c in kinds["none"]]),
        detected=count_true([c.verdict.verdict not in ("none", "missing") for c in faulty]),
        two_recall=recall,
        two_precision=precision,
        calibration_error=calibration_error(table),
        brier=brier_score(stated, true),
        reliability=table,
        shrink=shrink,
        group_size=_mean_group_size(cases),
        effects=rates_by(known, lambda label: label["effects"][:1]),
        forms=rates_by(single, lambda label: label.get("forms", [])),
        confusion=confusion(cases),
        by_missing=rates_by(cases, missing_channels),
        by_size=rates_by(single, strength_class),
        failures=[describe_failure(case) for case in cases if not case.right],
        cases=len(every),
        untouched=count_named([case for case in every if case.label["kind"] == "untouched"]),
        found_sizes=compare_sizes(kinds["carried"]),
    )


def _marginals(cases: Sequence[ScoredCase]) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return every stated probability and whether that effect is at work; cases that state none take no part."""
    stated, true = [], []
    for case in cases:
        if case.verdict.probabilities is None:
            continue
        for effect in EFFECTS:
            stated.append(case.verdict.probabilities.get(effect, 0.0))
            true.append(effect in case.label["effects"])
    return np.array(stated, dtype=float), np.array(true, dtype=bool)


def _rate_among_first(cases: Sequence[ScoredCase], count: int) -> Rate:
    """Return how often a true effect is among the first so many causes."""
    return count_true([not set(case.label["effects"]).isdisjoint(case.verdict.causes[:count]) for case in cases])


def _recall_and_precision(cases: Sequence[ScoredCase]) -> tuple[Rate, Rate]:
    """Return, over all effects, how many true ones are selected, and how many selected ones are true."""
    both = [(set(case.verdict.selected), set(case.label["effects"])) for case in cases]
    hits = sum(len(selected & true) for selected, true in both)
    return Rate(hits, sum(len(true) for _, true in both)), Rate(hits, sum(len(selected) for selected, _ in both))


def _mean_group_size(cases: Sequence[ScoredCase]) -> float:
    """Return how many effects an answer holds on average, of the verdicts that name some; NaN where none does."""
    naming = [case.verdict for case in cases if case.verdict.verdict in NAMING and case.verdict.causes]
    return float(np.mean([len(verdict.group) for verdict in naming])) if naming else math.nan
