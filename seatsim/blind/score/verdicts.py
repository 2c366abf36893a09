"""What a diagnosis said of a case, and whether that is right."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import NotRequired, Required, TypedDict, cast

from seatsim.blind.labels import Label
from seatsim.schema.guarded import expect, read_json

NAMING = ("known", "ambiguous")
"""Verdicts that name effects."""
LARGEST_GROUP = 2
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
    def group(self) -> tuple[str, ...]:
        """The indistinguishable group that holds the first cause, or that cause alone."""
        if not self.causes:
            return ()
        for group in self.groups:
            if self.causes[0] in group:
                return group
        return self.causes[:1]

    @property
    def named(self) -> str:
        """The first cause, or `none`, `unknown`, `missing` where none is named."""
        if self.verdict in NAMING:
            return self.causes[0] if self.causes else "unknown"
        return self.verdict


def read_verdict(path: Path) -> Verdict:
    """Read a diagnosis; where there is none the verdict is `missing`.

    Raises:
        InputError: the file is not a JSON object with a verdict.
    """
    if not path.is_file():
        return Verdict("missing")
    with expect(path, "diagnosis as the contract has it"):
        return _parse(cast("_Diagnosis", read_json(path, "diagnosis")), path)


class _Estimate(TypedDict):
    value: float


class _Cause(TypedDict):
    effect: str
    probability: NotRequired[float | None]
    parameters: NotRequired[dict[str, _Estimate | str] | None]


class _Place(TypedDict):
    block: str


class _Shrink(TypedDict, total=False):
    shrink: float | None
    shrink_interval: list[float | None] | None


class _Diagnosis(TypedDict, total=False):
    """The keys of `diagnosis.json` (contract, section 7) that are scored; all but the verdict may be absent or null."""

    verdict: Required[str]
    causes: list[_Cause] | None
    where: list[_Place] | None
    selected: list[str] | None
    indistinguishable: list[list[str]] | None
    isolable: list[list[str]] | None
    gap: _Shrink | None
    augmented: str | None


def _parse(data: _Diagnosis, path: Path) -> Verdict:
    """Return the verdict of JSON that may come from another tool, so every value is converted, or refused."""
    ranked = sorted(data.get("causes") or [], key=lambda cause: -_probability(cause))
    gap: _Shrink = data.get("gap") or {}
    shrink, augmented = gap.get("shrink"), data.get("augmented")
    return Verdict(
        verdict=str(data["verdict"]),
        blocks=tuple(str(entry["block"]) for entry in data.get("where") or []),
        causes=tuple(str(cause["effect"]) for cause in ranked),
        probabilities={str(cause["effect"]): _probability(cause) for cause in ranked},
        selected=tuple(str(name) for name in data.get("selected") or []),
        groups=_groups(data.get("indistinguishable")),
        isolable=_groups(data.get("isolable")),
        shrink=None if shrink is None else float(shrink),
        shrink_interval=_interval(gap.get("shrink_interval")),
        augmented=path.parent / str(augmented) if augmented else None,
        parameters={str(cause["effect"]): _values(cause) for cause in ranked},
    )


def _probability(cause: _Cause) -> float:
    return float(cause.get("probability") or 0.0)


def _values(cause: _Cause) -> dict[str, float]:
    """Return the estimated numbers of a cause; what is a word, such as a channel, is left out."""
    parameters = cause.get("parameters") or {}
    return {name: float(found["value"]) for name, found in parameters.items() if not isinstance(found, str)}


def _groups(groups: list[list[str]] | None) -> tuple[tuple[str, ...], ...]:
    return tuple(tuple(str(name) for name in group) for group in groups or [])


def _interval(ends: list[float | None] | None) -> tuple[float, float] | None:
    if not ends or ends[0] is None or ends[1] is None:
        return None
    return float(ends[0]), float(ends[1])


def is_right(label: Label, verdict: Verdict) -> bool:
    """Tell whether a diagnosis is right.

    none: verdict none. One: named (known, ambiguous), and the first cause is it or a group of at most two holds it.
    Two: named, and selected is exactly both. Outside: verdict unknown. Carried: as one, and under `unknown` too, since
    a nominal misses much else of a measured rig.
    """
    effects = set(label["effects"])
    match label["kind"]:
        case "none":
            return verdict.verdict == "none"
        case "outside":
            return verdict.verdict == "unknown"
        case "two":
            return verdict.verdict in NAMING and set(verdict.selected) == effects
    naming = (*NAMING, "unknown") if label["kind"] == "carried" else NAMING
    if verdict.verdict not in naming or not verdict.causes:
        return False
    pairs = [set(group) for group in verdict.groups if len(group) <= LARGEST_GROUP]
    return verdict.causes[0] in effects or any(effects <= pair for pair in pairs)


def is_wrong_name(label: Label, verdict: Verdict) -> bool:
    """Tell whether a wrong effect is named first: one is selected, and neither it nor its group of two is right."""
    return bool(verdict.selected) and verdict.verdict in (*NAMING, "unknown") and not is_right(label, verdict)


def is_block_first(label: Label, verdict: Verdict) -> bool:
    """Tell whether the first block is one where something is wrong."""
    return bool(verdict.blocks) and verdict.blocks[0] in label["blocks"]


def is_isolable_group_first(label: Label, verdict: Verdict) -> bool:
    """Tell whether it is, with blocks that the channels cannot tell apart taken for one."""
    if is_block_first(label, verdict):
        return True
    return any(
        verdict.blocks[0] in group and set(label["blocks"]) & set(group) for group in verdict.isolable if verdict.blocks
    )
