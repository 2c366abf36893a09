"""What a diagnosis said of a case, and whether that is right (rules of issue 3's table of bars)."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from seatsim.schema.errors import InputError

NAMING = ("known", "ambiguous")
LARGEST_GROUP = 2


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
    """Read a diagnosis.

    Raises:
        InputError: the file is not a JSON object with a verdict.
    """
    if not path.is_file():
        return Verdict("missing")
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        return _parsed(data, path)
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(f"{path}: is not a diagnosis as the contract has it: {error!r}") from error


def _parsed(data: dict[str, Any], path: Path) -> Verdict:
    ranked = sorted(data.get("causes") or [], key=lambda cause: -float(cause.get("probability") or 0.0))
    gap = data.get("gap") or {}
    interval = gap.get("shrink_interval")
    shrink = gap.get("shrink")
    augmented = data.get("augmented")
    return Verdict(
        verdict=str(data["verdict"]),
        blocks=tuple(str(entry["block"]) for entry in data.get("where") or []),
        causes=tuple(str(cause["effect"]) for cause in ranked),
        probabilities={str(cause["effect"]): float(cause.get("probability") or 0.0) for cause in ranked},
        selected=tuple(str(name) for name in data.get("selected") or []),
        groups=tuple(tuple(str(name) for name in group) for group in data.get("indistinguishable") or []),
        isolable=tuple(tuple(str(name) for name in group) for group in data.get("isolable") or []),
        shrink=None if shrink is None else float(shrink),
        shrink_interval=(float(interval[0]), float(interval[1])) if interval and None not in interval else None,
        augmented=path.parent / str(augmented) if augmented else None,
    )


def is_right(label: Mapping[str, Any], said: Verdict) -> bool:
    """Tell whether a diagnosis is right.

    none: verdict none. One: named (known, ambiguous), and the first cause is it or a group of at most two holds it.
    Two: named, and selected is exactly both. Outside: verdict unknown.
    """
    effects = set(label["effects"])
    match label["kind"]:
        case "none":
            return said.verdict == "none"
        case "outside":
            return said.verdict == "unknown"
        case "two":
            return said.verdict in NAMING and set(said.selected) == effects
    if said.verdict not in NAMING or not said.causes:
        return False
    if said.causes[0] in effects:
        return True
    return any(len(group) <= LARGEST_GROUP and effects <= set(group) for group in said.groups)


def block_first(label: Mapping[str, Any], said: Verdict) -> bool:
    """Tell whether the first block is one where something is wrong."""
    return bool(said.blocks) and said.blocks[0] in label["blocks"]


def block_first_coarse(label: Mapping[str, Any], said: Verdict) -> bool:
    """Tell the same, with blocks that the channels cannot tell apart taken for one."""
    if block_first(label, said):
        return True
    return any(said.blocks[0] in group and set(label["blocks"]) & set(group) for group in said.isolable if said.blocks)
