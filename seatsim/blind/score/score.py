"""Scores the diagnoses of a blind set against its sealed labels."""

from __future__ import annotations

import dataclasses
import math
import tempfile
from collections import Counter
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

from seatsim.blind.score.measures import Bin, Rate, brier, calibration_error, rate, reliability
from seatsim.blind.score.verdicts import NAMING, Verdict, block_first, block_first_coarse, is_right, read_verdict
from seatsim.blind.sealed import Sealed, unseal
from seatsim.blind.truth.truth import EFFECTS
from seatsim.schema.errors import InputError, SeatsimError
from seatsim.schema.modules import use_all, used_files

Progress = Callable[[int, int], None]
KINDS = ("none", "one", "two", "outside")


@dataclass(frozen=True)
class Shrink:
    """Claimed against true shrink on the unseen runs; `cases`: name, claimed, true, whether the interval held."""

    mean_difference: float
    bias: float
    coverage: Rate
    cases: list[tuple[str, float, float, bool | None]]


@dataclass(frozen=True)
class Score:
    """All figures of a set; rates hold how many of how many."""

    right: Rate
    kinds: dict[str, Rate]
    outside_with_block: Rate
    top1: Rate
    top3: Rate
    block: Rate
    block_coarse: Rate
    false_alarms: Rate
    detected: Rate
    two_recall: Rate
    two_precision: Rate
    calibration_error: float
    brier: float
    reliability: list[Bin]
    shrink: Shrink | None
    group_size: float
    effects: dict[str, Rate]
    forms: dict[str, Rate]
    confusion: dict[str, dict[str, int]]
    by_missing: dict[str, Rate]
    by_size: dict[str, Rate]
    failures: list[dict[str, Any]]
    cases: int

    def as_dict(self) -> dict[str, Any]:
        """Return the score as it stands in `score.json`."""
        return {field.name: _plain(getattr(self, field.name)) for field in dataclasses.fields(self)}


def _plain(value: Any) -> Any:
    if isinstance(value, Rate):
        return value.as_dict()
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {field.name: _plain(getattr(value, field.name)) for field in dataclasses.fields(value)}
    if isinstance(value, dict):
        return {name: _plain(item) for name, item in value.items()}
    return [_plain(item) for item in value] if isinstance(value, list | tuple) else value


def score(
    folder: str | Path, sealed: str | Path, key: str, diagnoses: str = "diagnosis", unseen: bool = True,
    progress: Progress | None = None, processes: int = 2,
) -> Score:  # fmt: skip
    """Score DIR/case-*/DIAGNOSES/diagnosis.json against the sealed labels.

    With `unseen`, the claimed shrink is compared with what `augmented.yaml` reaches on the run that was never given.

    Raises:
        InputError: wrong key, changed file, another set's folder, or a diagnosis that is no diagnosis.
    """
    base = Path(folder)
    opened = unseal(Path(sealed), key, base)
    said = {name: read_verdict(base / name / diagnoses / "diagnosis.json") for name in opened.labels}
    if all(verdict.verdict == "missing" for verdict in said.values()):
        raise InputError(f"{base}: no case-*/{diagnoses}/diagnosis.json; diagnose the cases first")
    shrink = _shrinks(base, opened, said, progress, processes) if unseen else None
    return score_of(opened.labels, said, shrink)


def score_of(labels: dict[str, dict[str, Any]], said: dict[str, Verdict], shrink: Shrink | None = None) -> Score:
    """Return the score of verdicts by case against labels by case."""
    names = list(labels)
    right = {name: is_right(labels[name], said[name]) for name in names}
    kinds = {kind: [n for n in names if labels[n]["kind"] == kind] for kind in KINDS}
    faulty = [n for n in names if labels[n]["kind"] != "none"]
    stated, true = _marginals(labels, said)
    table = reliability(stated, true)
    sizes = [len(said[n].group) for n in names if said[n].verdict in NAMING and said[n].causes]
    both = [(set(said[n].selected), set(labels[n]["effects"])) for n in kinds["two"]]
    hits = sum(len(a & b) for a, b in both)
    return Score(
        right=rate(list(right.values())),
        kinds={kind: rate([right[n] for n in some]) for kind, some in kinds.items() if some},
        outside_with_block=rate([right[n] and block_first(labels[n], said[n]) for n in kinds["outside"]]),
        top1=rate([bool(set(said[n].causes[:1]) & set(labels[n]["effects"])) for n in kinds["one"]]),
        top3=rate([bool(set(said[n].causes[:3]) & set(labels[n]["effects"])) for n in kinds["one"]]),
        block=rate([block_first(labels[n], said[n]) for n in faulty]),
        block_coarse=rate([block_first_coarse(labels[n], said[n]) for n in faulty]),
        false_alarms=rate([said[n].verdict != "none" for n in kinds["none"]]),
        detected=rate([said[n].verdict not in ("none", "missing") for n in faulty]),
        two_recall=Rate(hits, sum(len(b) for _, b in both)),
        two_precision=Rate(hits, sum(len(a) for a, _ in both)),
        calibration_error=calibration_error(table),
        brier=brier(stated, true),
        reliability=table,
        shrink=shrink,
        group_size=float(np.mean(sizes)) if sizes else math.nan,
        effects=_split(kinds["one"], right, lambda n: [labels[n]["effects"][0]]),
        forms=_split(kinds["one"] + kinds["outside"], right, lambda n: labels[n].get("forms", [])),
        confusion=_confusion(labels, said),
        by_missing=_split(names, right, lambda n: [" ".join(labels[n].get("missing", [])) or "all channels"]),
        by_size=_split(kinds["one"] + kinds["outside"], right, lambda n: [_size(labels[n])]),
        failures=[_failure(n, labels[n], said[n]) for n in names if not right[n]],
        cases=len(names),
    )


def _marginals(labels: dict[str, dict[str, Any]], said: dict[str, Verdict]) -> tuple[Any, Any]:
    stated, true = [], []
    for name, verdict in said.items():
        if verdict.probabilities is None:
            continue
        for effect in EFFECTS:
            stated.append(verdict.probabilities.get(effect, 0.0))
            true.append(effect in labels[name]["effects"])
    return np.array(stated, dtype=float), np.array(true, dtype=bool)


def _split(names: Sequence[str], right: dict[str, bool], of: Callable[[str], Sequence[str]]) -> dict[str, Rate]:
    flags: dict[str, list[bool]] = {}
    for name in names:
        for part in of(name):
            flags.setdefault(part, []).append(right[name])
    return {part: rate(flags[part]) for part in sorted(flags)}


def _size(label: dict[str, Any]) -> str:
    size = min(label.get("materialities") or [math.nan])
    for edge in (1.5, 2.5, 4.0):
        if size < edge:
            return f"{edge:.1f} x limit or less"
    return "stronger"


def _confusion(labels: dict[str, dict[str, Any]], said: dict[str, Verdict]) -> dict[str, dict[str, int]]:
    counts: dict[str, Counter[str]] = {}
    for name, label in labels.items():
        match label["kind"]:
            case "one":
                row = label["effects"][0]
            case "outside":
                row = f"outside ({label['blocks'][0]})"
            case kind:
                row = kind
        counts.setdefault(row, Counter())[said[name].named] += 1
    return {row: dict(counts[row].most_common()) for row in sorted(counts)}


def _failure(name: str, label: dict[str, Any], said: Verdict) -> dict[str, Any]:
    return {
        "case": name, "kind": label["kind"], "effects": label["effects"], "forms": label.get("forms", []),
        "materialities": label.get("materialities", []), "missing": label.get("missing", []), "verdict": said.verdict,
        "named": list(said.causes[:3]), "selected": list(said.selected), "groups": [list(g) for g in said.groups],
        "where": list(said.blocks[:2]),
    }  # fmt: skip


def _shrinks(
    base: Path, opened: Sealed, said: dict[str, Verdict], progress: Progress | None, processes: int
) -> Shrink | None:
    """Return claimed against true shrink of all that claim one and name or refuse something."""
    claims = [n for n in opened.labels if said[n].verdict in (*NAMING, "unknown") and said[n].shrink is not None]
    claims = [n for n in claims if said[n].augmented is not None]
    if not claims:
        return None
    with tempfile.TemporaryDirectory() as temporary:
        jobs = [(base / n / "nominal.yaml", said[n].augmented, opened.extract(n, Path(temporary))) for n in claims]
        found = _map(jobs, progress, processes)
    rows: list[tuple[str, float, float, bool | None]] = []
    for name, true in zip(claims, found, strict=True):
        interval = said[name].shrink_interval
        held = None if interval is None or true is None else interval[0] <= true <= interval[1]
        rows.append((name, float(said[name].shrink or 0.0), math.nan if true is None else true, held))
    known = [(claimed, true) for _, claimed, true, _ in rows if math.isfinite(true)]
    off = np.array([claimed - true for claimed, true in known])
    coverage = rate([held for *_, held in rows if held is not None])
    if not off.size:
        return Shrink(math.nan, math.nan, coverage, rows)
    return Shrink(float(np.mean(np.abs(off))), float(np.mean(off)), coverage, rows)


def _map(jobs: list[tuple[Path, Path | None, Path]], progress: Progress | None, processes: int) -> list[float | None]:
    out: list[float | None] = []
    if processes <= 1 or len(jobs) < 8:
        for job in jobs:
            out.append(true_shrink(*job))
            if progress:
                progress(len(out), len(jobs))
        return out
    with ProcessPoolExecutor(processes, get_context("spawn"), initializer=use_all, initargs=(used_files(),)) as pool:
        for value in pool.map(true_shrink, *zip(*jobs, strict=True)):
            out.append(value)
            if progress:
                progress(len(out), len(jobs))
    return out


def true_shrink(nominal: Path, augmented: Path | None, unseen: Path) -> float | None:
    """Return `1 - after / before` of the overall gap on the unseen recording; None where it cannot be replayed."""
    from seatsim.recordings.gap import gap

    try:
        before = gap(nominal, unseen).overall
        after = gap(augmented or nominal, unseen).overall
    except SeatsimError:
        return None
    return 1.0 - after / before
