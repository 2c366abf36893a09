"""What a scenario file says of its own runs: the checks that they have to meet.

    checks:
      stable: true
      delay_margin: {min: 0.005}
      seat_factor: {max: 0.9, per: [h-infinity]}

`seatsim.simulation.checks` measures the checks: bounds of metrics and of the stability of the control loop.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import NamedTuple

from seatsim.metrics.table import METRICS
from seatsim.schema.errors import nearest
from seatsim.schema.json_schema import TEXT, Schema, mapping_schema
from seatsim.schema.validation import check_keys, mapping, read_number
from seatsim.schema.yaml_source import Source
from seatsim.schema.yaml_text import KeyPath

STABLE = "stable"
LOOP_FIGURES: Mapping[str, str] = {"delay_margin": "s", "disk_margin": "-"}
"""Figures of the sampled control loop by name, with their unit."""


class Check(NamedTuple):
    """A demand on a run: `name` of a metric or of a figure of its loop, its bounds, the variants that it is made of.

    Without variants it is made of every run. A check of stability has no bounds.
    """

    name: str
    low: float = -math.inf
    high: float = math.inf
    variants: tuple[str, ...] = ()

    def is_made_of(self, label: Mapping[str, object]) -> bool:
        """Return whether the run with a label has to meet this check."""
        return not self.variants or label.get("variant") in self.variants


def read_checks(stated: object, source: Source) -> tuple[Check, ...]:
    """Return the checks that a scenario states.

    Raises:
        InputError: no metric and no figure of a loop has a name that is checked, or its bounds cannot be met.
    """
    checks = mapping(stated, source, ("checks",))
    check_keys(checks, (STABLE, *LOOP_FIGURES, *METRICS), source, ("checks",))
    return tuple(_read_check(str(name), value, source) for name, value in checks.items())


def checks_schema() -> Schema:
    """Return the JSON Schema of the checks of a scenario."""
    per = {"per": {"anyOf": [TEXT, {"type": "array", "items": TEXT}]}}
    stable: Schema = {"anyOf": [{"const": True}, mapping_schema(per)]}
    units = {**LOOP_FIGURES, **{name: metric.unit for name, metric in METRICS.items()}}
    bounds = {
        name: mapping_schema({"min": {"type": "number", "unit": unit}, "max": {"type": "number", "unit": unit}, **per})
        for name, unit in units.items()
    }
    return mapping_schema({STABLE: stable, **bounds})


def _read_check(name: str, value: object, source: Source) -> Check:
    keys: KeyPath = ("checks", name)
    is_stability = name == STABLE
    stated = {} if is_stability and value is True else mapping(value, source, keys)
    check_keys(stated, ("per",) if is_stability else ("min", "max", "per"), source, keys)
    bounds = {key: read_number(stated[key], source, (*keys, key)) for key in ("min", "max") if key in stated}
    low, high = bounds.get("min", -math.inf), bounds.get("max", math.inf)
    if not is_stability and (not bounds or low > high):
        raise source.error(keys, "states no range; write {min: x}, {max: x}, or both with min below max")
    return Check(name, low, high, _variants(stated, source, keys))


def _variants(stated: Mapping[str, object], source: Source, keys: KeyPath) -> tuple[str, ...]:
    named = stated.get("per", [])
    named = [named] if isinstance(named, str) else named
    if not isinstance(named, list) or not all(isinstance(name, str) for name in named):
        raise source.error((*keys, "per"), f"{named!r} is not permitted; it must be a list of names of variants")
    return tuple(named)


def require_variants(checks: Iterable[Check], variants: Iterable[object], source: Source) -> None:
    """Raise InputError where a check names a variant that its scenario does not have."""
    known = [str(name) for name in variants]
    for check in checks:
        for name in check.variants:
            if name not in known:
                permitted = f"permitted: {', '.join(known)}" if known else "the scenario has no variants"
                problem = f"no variant '{name}'{nearest(name, known)}; {permitted}"
                raise source.error(("checks", check.name, "per"), problem)
