"""Scored cases: label and verdict side by side, rates of what is right, and figures of stated probabilities."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.blind.score.verdicts import Verdict, is_right
from seatsim.blind.sealed import Label
from seatsim.schema.content import written

_BINS = 10
"""Of the reliability table: each holds a tenth of all probabilities, 24 for each case."""
_Z_95 = 1.96
"""Standard normal quantile of a two-sided 95 % interval."""
_SIZES = (1.5, 2.5, 4.0)
"""Upper edges, in material limits, of the classes by strength: just material, common, strong."""
_NAMED = 3
"""Causes of a wrong verdict that are listed."""


@dataclass(frozen=True)
class Rate:
    """How many of how many, with a 95 % Wilson interval."""

    right: int
    total: int

    @property
    @written("share")
    def value(self) -> float:
        """Share that is right; NaN of none."""
        return self.right / self.total if self.total else math.nan

    @property
    @written()
    def interval(self) -> tuple[float, float]:
        """Wilson (1927): `(p + z^2/2n -+ z sqrt(p(1-p)/n + z^2/4n^2)) / (1 + z^2/n)`; it holds for few cases too."""
        if not self.total:
            return (math.nan, math.nan)
        z, n, p = _Z_95, self.total, self.right / self.total
        centre = p + z * z / (2 * n)
        half = z * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
        return (max((centre - half) / (1 + z * z / n), 0.0), min((centre + half) / (1 + z * z / n), 1.0))


def count_true(flags: Sequence[bool]) -> Rate:
    """Return how many flags are set."""
    return Rate(sum(bool(flag) for flag in flags), len(flags))


@dataclass(frozen=True)
class Bin:
    """A bin of the reliability table: stated mean, share that came true, how many, from and to."""

    stated: float
    true: float
    count: int
    low: float
    high: float


def reliability(stated: NDArray[np.float64], true: NDArray[np.bool_], bins: int = _BINS) -> list[Bin]:
    """Return bins of equal mass of probabilities and of what came true, shape (n,) each.

    Sorted by what was stated; ties stay in their order. Equal mass, since most probabilities lie near zero and bins of
    equal width would hold next to nothing.
    """
    order = np.argsort(stated, kind="stable")
    return [_bin(stated[part], true[part]) for part in np.array_split(order, bins) if part.size]


def _bin(stated: NDArray[np.float64], true: NDArray[np.bool_]) -> Bin:
    return Bin(float(np.mean(stated)), float(np.mean(true)), stated.size, float(np.min(stated)), float(np.max(stated)))


def calibration_error(table: Sequence[Bin]) -> float:
    """Return the expected calibration error: mean over all of |stated - true| by bin (Naeini et al. 2015)."""
    total = sum(b.count for b in table)
    return sum(b.count * abs(b.stated - b.true) for b in table) / total if total else math.nan


def brier_score(stated: NDArray[np.float64], true: NDArray[np.bool_]) -> float:
    """Return the mean squared difference of probability and truth (Brier 1950)."""
    return float(np.mean((stated - true) ** 2)) if stated.size else math.nan


@dataclass(frozen=True)
class ScoredCase:
    """A case with its label and what a diagnosis said of it."""

    name: str
    label: Label
    verdict: Verdict

    @property
    def right(self) -> bool:
        """Whether the verdict is right."""
        return is_right(self.label, self.verdict)


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


def rate_right(cases: Iterable[ScoredCase]) -> Rate:
    """Return how many verdicts are right."""
    return count_true([case.right for case in cases])


def rates_by(cases: Iterable[ScoredCase], classes_of: Callable[[Label], Sequence[str]]) -> dict[str, Rate]:
    """Return how many verdicts are right by class, in the order of the alphabet; a case may belong to several."""
    flags: dict[str, list[bool]] = {}
    for case in cases:
        for name in classes_of(case.label):
            flags.setdefault(name, []).append(case.right)
    return {name: count_true(flags[name]) for name in sorted(flags)}


def strength_class(label: Label) -> list[str]:
    """Return the class of a case by the materiality of its weakest fault."""
    weakest = min(label.get("materialities") or [math.nan])
    for edge in _SIZES:
        if weakest < edge:
            return [f"{edge:.1f} x limit or less"]
    return ["stronger"]


def missing_channels(label: Label) -> list[str]:
    """Return the class of a case by the channels that it lacks."""
    return [" ".join(label.get("missing", [])) or "all channels"]


def confusion(cases: Iterable[ScoredCase]) -> dict[str, dict[str, int]]:
    """Return how often each name was given, most often first, by what is true."""
    counts: dict[str, Counter[str]] = {}
    for case in cases:
        counts.setdefault(_true_name(case.label), Counter())[case.verdict.named] += 1
    return {row: dict(counts[row].most_common()) for row in sorted(counts)}


def count_named(cases: Iterable[ScoredCase]) -> dict[str, int]:
    """Return how often each effect stands first among those selected, most often first, else the verdict."""
    counts = Counter(_first_selected(case.verdict) for case in cases)
    return dict(counts.most_common())


def _first_selected(verdict: Verdict) -> str:
    return next((name for name in verdict.causes if name in verdict.selected), verdict.verdict)


class FoundSize(NamedTuple):
    """A parameter of an effect that was found: its true and its estimated value."""

    case: str
    effect: str
    parameter: str
    true: float
    found: float


def compare_sizes(cases: Iterable[ScoredCase]) -> list[FoundSize]:
    """Return true and estimated parameters of the same name, of the cases in which the effect is selected."""
    found = []
    for case in cases:
        for effect, true in zip(case.label["effects"], case.label.get("shapes", []), strict=False):
            estimated = case.verdict.parameters.get(effect, {}) if effect in case.verdict.selected else {}
            found += [FoundSize(case.name, effect, p, v, estimated[p]) for p, v in true.items() if p in estimated]
    return found


def _true_name(label: Label) -> str:
    match label["kind"]:
        case "one" | "carried":
            return label["effects"][0]
        case "outside":
            return f"outside ({label['blocks'][0]})"
        case kind:
            return kind


def describe_failure(case: ScoredCase) -> Failure:
    """Return what is true of a case whose verdict is wrong, and what was said."""
    label, verdict = case.label, case.verdict
    known = label.get("forms", []), label.get("materialities", []), label.get("missing", [])
    said = list(verdict.causes[:_NAMED]), list(verdict.selected), [list(group) for group in verdict.groups]
    return Failure(case.name, label["kind"], label["effects"], *known, verdict.verdict, *said, list(verdict.blocks[:2]))
