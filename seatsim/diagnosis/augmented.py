"""The augmented scenario as a file: the nominal one with refitted parameters and the effects found."""

from __future__ import annotations

from collections.abc import Mapping

from seatsim.diagnosis.nuisance import SECTIONS
from seatsim.diagnosis.parameters import Parameters
from seatsim.diagnosis.problem import DiagnosisProblem
from seatsim.effects.base import same_place
from seatsim.scenario.sections import FILES


def write_augmented(problem: DiagnosisProblem, parameters: Parameters) -> dict[str, object]:
    """Return the content of `augmented.yaml`."""
    source = problem.scenario.source
    assert source is not None
    content = {str(key): _copy_plain(part) for key, part in source.data.items()}
    for parameter, deviation in zip(problem.parameters, parameters.deviations, strict=True):
        section = content
        for key in SECTIONS[parameter.section].split("."):
            inner = section.setdefault(key, {})
            assert isinstance(inner, dict)
            section = inner
        section[parameter.name] = parameter.at(deviation)
    for name, key in FILES:
        stated = content.get(name)
        if isinstance(stated, dict) and isinstance(stated.get(key), str):
            # A file is named from the folder of the nominal scenario, while this content goes to another one.
            stated[key] = str((source.path.parent / stated[key]).resolve())
    present = content.get("effects", [])
    assert isinstance(present, list)
    # An effect found replaces the one that the nominal scenario has at its place, as in the rig that was fitted.
    kept = [
        entry
        for entry, effect in zip(present, problem.scenario.effects, strict=True)
        if not any(same_place(effect, found) for found in parameters.effects)
    ]
    added = [
        {"effect": term.effect, "parameters": _as_plain(term.record(values)._asdict())}
        for term, values in zip(parameters.terms, parameters.values, strict=True)
    ]
    content["effects"] = [*kept, *added]
    return content


def _as_plain(values: Mapping[str, object]) -> dict[str, object]:
    """Return the numbers of an effect's record as Python floats, which a YAML file can hold; strings stay strings."""
    return {name: float(value) if isinstance(value, int | float) else value for name, value in values.items()}


def _copy_plain(value: object) -> object:
    """Return the content of a YAML file as plain lists and mappings, without the line numbers that its reader keeps."""
    if isinstance(value, dict):
        return {str(key): _copy_plain(part) for key, part in value.items()}
    if isinstance(value, list):
        return [_copy_plain(part) for part in value]
    return value
