"""What a diagnosis said of a case and whether that is right; rates of what is right, figures of probabilities."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ValidationError

from seatsim.blind.sealed import Label
from seatsim.schema.content import written
from seatsim.schema.errors import InputError
from seatsim.schema.guarded import read_json

NAMING = ("known", "ambiguous")
"""Verdicts that name effects."""
_LARGEST_GROUP = 2
"""Effects that a group may hold and still count as an answer: a workshop can check two."""


@dataclass(frozen=True)
class Verdict:
    """A `diagnosis.json`, as far as it is scored; what it lacks is empty. Not diagnosed: verdict `missing`."""

    verdict: str
    blocks: tuple[str, ...] = ()
    causes: tuple[str, ...] = ()
    probabilities: Mapping[str, float] | None = None
    selected: tuple[str, ...] = ()
    groups: tuple[tuple[str, ...], ...] = ()
    isolable: tuple[tuple[str, ...], ...] = ()
    shrink: float | None = None
    shrink_interval: tuple[float, float] | None = None
    augmented: Path | None = None
    parameters: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    """Estimated parameters by effect and name."""

    @property
    def named(self) -> str:
        """The first cause, or `none`, `unknown`, `missing` where none is named."""
        return next(iter(self.causes), "unknown") if self.verdict in NAMING else self.verdict


class _Estimate(BaseModel):
    value: float


class _Cause(BaseModel):
    effect: str
    probability: float | None = None
    parameters: dict[str, _Estimate | str] | None = None

    def values(self) -> dict[str, float]:
        """Return the estimated numbers; what is a word, such as a channel, is left out."""
        found = self.parameters or {}
        return {name: estimate.value for name, estimate in found.items() if isinstance(estimate, _Estimate)}


class _Place(BaseModel):
    block: str


class _Gap(BaseModel):
    shrink: float | None = None
    shrink_interval: tuple[float | None, float | None] | None = None


class _Diagnosis(BaseModel):
    """The keys of `diagnosis.json` (contract, section 7) that are scored; all but the verdict may be absent or null."""

    verdict: str
    causes: list[_Cause] | None = None
    where: list[_Place] | None = None
    selected: list[str] | None = None
    indistinguishable: list[tuple[str, ...]] | None = None
    isolable: list[tuple[str, ...]] | None = None
    gap: _Gap | None = None
    augmented: str | None = None


def read_verdict(path: Path) -> Verdict:
    """Read a diagnosis, which may come from another tool; where there is none the verdict is `missing`.

    Raises:
        InputError: the file is not a JSON object with a verdict.
    """
    if not path.is_file():
        return Verdict("missing")
    try:
        data = _Diagnosis.model_validate(read_json(path, "diagnosis"))
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"])) or "the file"
        raise InputError(f"{path}: is no diagnosis as the contract has it: {place}: {first['msg']}") from error
    probabilities = {cause.effect: cause.probability or 0.0 for cause in data.causes or []}
    ranked = sorted(data.causes or [], key=lambda cause: -(cause.probability or 0.0))
    gap = data.gap or _Gap()
    low, high = gap.shrink_interval or (None, None)
    return Verdict(
        verdict=data.verdict,
        blocks=tuple(place.block for place in data.where or []),
        causes=tuple(cause.effect for cause in ranked),
        probabilities=probabilities,
        selected=tuple(data.selected or []),
        groups=tuple(data.indistinguishable or []),
        isolable=tuple(data.isolable or []),
        shrink=gap.shrink,
        shrink_interval=None if low is None or high is None else (low, high),
        augmented=path.parent / data.augmented if data.augmented else None,
        parameters={cause.effect: cause.values() for cause in ranked},
    )


def is_right(label: Label, verdict: Verdict) -> bool:
    """Tell whether a diagnosis is right.

    none: verdict none. One: named (known, ambiguous), and the first cause is it or a group of at most two holds it.
    Two: named, and selected is exactly both. Outside: verdict unknown. Carried: as one, and under `unknown` too, since
    a nominal misses much else of a measured rig.
    """
    kind, effects = label["kind"], set(label["effects"])
    if kind in ("none", "outside"):
        return verdict.verdict == ("none" if kind == "none" else "unknown")
    if kind == "two":
        return verdict.verdict in NAMING and set(verdict.selected) == effects
    naming = (*NAMING, "unknown") if kind == "carried" else NAMING
    if verdict.verdict not in naming or not verdict.causes:
        return False
    pairs = [set(group) for group in verdict.groups if len(group) <= _LARGEST_GROUP]
    return verdict.causes[0] in effects or any(effects <= pair for pair in pairs)


def is_wrong_name(label: Label, verdict: Verdict) -> bool:
    """Tell whether a wrong effect is named first: one is selected, and neither it nor its group of two is right."""
    return bool(verdict.selected) and verdict.verdict in (*NAMING, "unknown") and not is_right(label, verdict)


_BINS = 10
"""Of the reliability table: each holds a tenth of all probabilities, 24 for each case."""
_Z_95 = 1.96
"""Standard normal quantile of a two-sided 95 % interval."""


class Rate(NamedTuple):
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


def reliability(stated: NDArray[np.float64], true: NDArray[np.bool_]) -> list[Bin]:
    """Return bins of equal mass of probabilities and of what came true, shape (n,) each.

    Sorted by what was stated; ties stay in their order. Equal mass, since most probabilities lie near zero and bins of
    equal width would hold next to nothing.
    """
    parts = [part for part in np.array_split(np.argsort(stated, kind="stable"), _BINS) if part.size]
    means = [(float(np.mean(stated[part])), float(np.mean(true[part]))) for part in parts]
    ends = [(float(np.min(stated[part])), float(np.max(stated[part]))) for part in parts]
    return [Bin(*mean, part.size, *end) for part, mean, end in zip(parts, means, ends, strict=True)]


def calibration_error(table: Sequence[Bin]) -> float:
    """Return the expected calibration error: mean over all of |stated - true| by bin (Naeini et al. 2015)."""
    total = sum(b.count for b in table)
    return sum(b.count * abs(b.stated - b.true) for b in table) / total if total else math.nan


def brier_score(stated: NDArray[np.float64], true: NDArray[np.bool_]) -> float:
    """Return the mean squared difference of probability and truth (Brier 1950)."""
    return float(np.mean((stated - true) ** 2)) if stated.size else math.nan
