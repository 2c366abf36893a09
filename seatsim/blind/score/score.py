"""Scores the diagnoses of a blind set against its sealed labels.

The true shrink of the gap is that of the augmented scenario, replayed on a run that the diagnosis was never given.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.blind.score.verdicts import (
    NAMING,
    Bin,
    Rate,
    Verdict,
    brier_score,
    calibration_error,
    count_true,
    is_right,
    is_wrong_name,
    read_verdict,
    reliability,
)
from seatsim.blind.sealed import EFFECTS, KINDS, Label, Sealed, unseal
from seatsim.schema.errors import InputError, SeatsimError
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
    mean, bias = (float(np.mean(np.abs(off))), float(np.mean(off))) if off.size else (math.nan, math.nan)
    return ShrinkScore(mean, bias, coverage, list(cases))


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


_NAMED = 3
"""Causes of a wrong verdict that are listed."""


class _ScoredCase(NamedTuple):
    """A case with its label and what a diagnosis said of it."""

    name: str
    label: Label
    verdict: Verdict

    @property
    def right(self) -> bool:
        """Whether the verdict is right."""
        return is_right(self.label, self.verdict)

    @property
    def is_block_first(self) -> bool:
        """Whether the first block is one where something is wrong."""
        return bool(self.verdict.blocks) and self.verdict.blocks[0] in self.label["blocks"]

    @property
    def is_isolable_group_first(self) -> bool:
        """Whether it is, with blocks that the channels cannot tell apart taken for one."""
        first = set(self.verdict.blocks[:1])
        alike = [group for group in self.verdict.isolable if first & set(group)]
        return self.is_block_first or any(set(self.label["blocks"]) & set(group) for group in alike)


class Failure(NamedTuple):
    """A case whose verdict is wrong, as it stands in `score.json`."""

    case: str
    kind: str
    effects: list[str]
    forms: list[str]
    materialities: list[float]
    missing: list[str]
    verdict: str
    named: list[str]
    selected: list[str]
    groups: list[list[str]]
    where: list[str]


class FoundSize(NamedTuple):
    """A parameter of an effect that was found: its true and its estimated value."""

    case: str
    effect: str
    parameter: str
    true: float
    found: float


class Score(NamedTuple):
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
    effects: dict[str, Rate]
    confusion: dict[str, dict[str, int]]
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
    progress: Progress | None = None,
    processes: int = 2,
) -> Score:
    """Score DIR/case-*/DIAGNOSES/diagnosis.json against the sealed labels.

    The stated shrink is compared with that of `augmented.yaml` on the run that was never given; `progress` is called
    with the replays done and all.

    Raises:
        InputError: wrong key, changed file, another set's folder, or a diagnosis that is no diagnosis.
    """
    base = Path(folder)
    opened = unseal(Path(sealed), key, base)
    verdicts = {name: read_verdict(base / name / diagnoses / "diagnosis.json") for name in opened.labels}
    if all(verdict.verdict == "missing" for verdict in verdicts.values()):
        raise InputError(f"{base}: no case-*/{diagnoses}/diagnosis.json; diagnose the cases first")
    shrink = score_shrink(base, opened, verdicts, processes, progress)
    return score_verdicts(opened.labels, verdicts, shrink)


def score_verdicts(
    labels: Mapping[str, Label], verdicts: Mapping[str, Verdict], shrink: ShrinkScore | None = None
) -> Score:
    """Return the score of verdicts by case against labels by case."""
    every = [_ScoredCase(name, label, verdicts[name]) for name, label in labels.items()]
    cases = [case for case in every if case.label["kind"] != "untouched"]
    kinds = {kind: [case for case in cases if case.label["kind"] == kind] for kind in (*KINDS, "carried")}
    known = kinds["one"] + kinds["carried"]
    faulty = [case for case in cases if case.label["kind"] != "none"]
    names = sorted({case.label["effects"][0] for case in known})
    stated, true = _marginals(cases)
    table = reliability(stated, true)
    recall, precision = _recall_and_precision(kinds["two"])
    return Score(
        right=count_true([c.right for c in cases]),
        kinds={kind: count_true([c.right for c in some]) for kind, some in kinds.items() if some},
        outside_with_block=count_true([c.right and c.is_block_first for c in kinds["outside"]]),
        top1=_rate_among_first(known, 1),
        top3=_rate_among_first(known, 3),
        block=count_true([c.is_block_first for c in faulty]),
        block_coarse=count_true([c.is_isolable_group_first for c in faulty]),
        wrong_names=count_true([is_wrong_name(c.label, c.verdict) for c in known]),
        false_alarms=count_true([c.verdict.verdict != "none" for c in kinds["none"]]),
        detected=count_true([c.verdict.verdict not in ("none", "missing") for c in faulty]),
        two_recall=recall,
        two_precision=precision,
        calibration_error=calibration_error(table),
        brier=brier_score(stated, true),
        reliability=table,
        shrink=shrink,
        effects={name: count_true([c.right for c in known if c.label["effects"][0] == name]) for name in names},
        confusion=_confusion(cases),
        failures=[_describe_failure(case) for case in cases if not case.right],
        cases=len(every),
        untouched=_count_named([case for case in every if case.label["kind"] == "untouched"]),
        found_sizes=_compare_sizes(kinds["carried"]),
    )


def _marginals(cases: Sequence[_ScoredCase]) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return every stated probability and whether that effect is at work; cases that state none take no part."""
    stating = [(case.verdict.probabilities, case.label["effects"]) for case in cases]
    told = [(stated, true) for stated, true in stating if stated is not None]
    stated = np.array([stated.get(effect, 0.0) for stated, _ in told for effect in EFFECTS], dtype=float)
    return stated, np.array([effect in true for _, true in told for effect in EFFECTS], dtype=bool)


def _rate_among_first(cases: Sequence[_ScoredCase], count: int) -> Rate:
    """Return how often a true effect is among the first so many causes."""
    return count_true([not set(case.label["effects"]).isdisjoint(case.verdict.causes[:count]) for case in cases])


def _recall_and_precision(cases: Sequence[_ScoredCase]) -> tuple[Rate, Rate]:
    """Return, over all effects, how many true ones are selected, and how many selected ones are true."""
    both = [(set(case.verdict.selected), set(case.label["effects"])) for case in cases]
    hits = sum(len(selected & true) for selected, true in both)
    return Rate(hits, sum(len(true) for _, true in both)), Rate(hits, sum(len(selected) for selected, _ in both))


def _confusion(cases: Iterable[_ScoredCase]) -> dict[str, dict[str, int]]:
    """Return how often each name was given, most often first, by what is true."""
    counts: dict[str, Counter[str]] = {}
    for case in cases:
        counts.setdefault(_true_name(case.label), Counter())[case.verdict.named] += 1
    return {row: dict(counts[row].most_common()) for row in sorted(counts)}


def _count_named(cases: Iterable[_ScoredCase]) -> dict[str, int]:
    """Return how often each effect stands first among those selected, most often first, else the verdict."""
    said = [case.verdict for case in cases]
    first = (next((name for name in each.causes if name in each.selected), each.verdict) for each in said)
    return dict(Counter(first).most_common())


def _compare_sizes(cases: Iterable[_ScoredCase]) -> list[FoundSize]:
    """Return true and estimated parameters of the same name, of the cases in which the effect is selected."""
    found = []
    for case in cases:
        for effect, true in zip(case.label["effects"], case.label.get("shapes", []), strict=False):
            estimated = case.verdict.parameters.get(effect, {}) if effect in case.verdict.selected else {}
            found += [FoundSize(case.name, effect, p, v, estimated[p]) for p, v in true.items() if p in estimated]
    return found


def _true_name(label: Label) -> str:
    kind = label["kind"]
    if kind in ("one", "carried"):
        return label["effects"][0]
    return f"outside ({label['blocks'][0]})" if kind == "outside" else kind


def _describe_failure(case: _ScoredCase) -> Failure:
    """Return what is true of a case whose verdict is wrong, and what was said."""
    label, verdict = case.label, case.verdict
    known = label.get("forms", []), label.get("materialities", []), label.get("missing", [])
    said = list(verdict.causes[:_NAMED]), list(verdict.selected), [list(group) for group in verdict.groups]
    return Failure(case.name, label["kind"], label["effects"], *known, verdict.verdict, *said, list(verdict.blocks[:2]))
