"""The augmented scenario as a file: the nominal one with refitted parameters and the effects found."""

from __future__ import annotations

import copy
from typing import Any

from seatsim.diagnosis.fit import Point
from seatsim.diagnosis.problem import Problem

SECTIONS = {"plant": ("plant",), "damper": ("damper", "parameters"), "coil": ("actuator",)}


def content(problem: Problem, point: Point) -> dict[str, Any]:
    """Return the content of `augmented.yaml`."""
    source = problem.scenario.source
    assert source is not None
    values: dict[str, Any] = _plain(source.data)
    for parameter, share in zip(problem.parameters, point.u, strict=True):
        section = values
        for key in SECTIONS[parameter.section]:
            section = section.setdefault(key, {})
        section[parameter.name] = parameter.value + parameter.span * float(share)
    added = [
        {"effect": term.effect, "parameters": _parameters(term.record(found))}
        for term, found in zip(point.terms, point.values, strict=True)
    ]
    values["effects"] = [*values.get("effects", []), *added]
    return values


def _parameters(record: Any) -> dict[str, Any]:
    return {name: value if isinstance(value, str) else float(value) for name, value in record._asdict().items()}


def _plain(value: Any) -> Any:
    """Return plain lists and mappings of what a YAML file holds."""
    if isinstance(value, dict):
        return {str(key): _plain(part) for key, part in value.items()}
    if isinstance(value, list):
        return [_plain(part) for part in value]
    return copy.copy(value)
