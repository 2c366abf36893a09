"""A damper as a YAML file states it."""

from __future__ import annotations

from typing import Any

from seatsim.rig.temperature import TemperatureFactors
from seatsim.schema.registry import specification_of
from seatsim.schema.validation import build, check_keys, chosen_class, mapping
from seatsim.schema.yaml_source import KeyPath, Source


def stated_damper(
    values: Any, source: Source, keys: KeyPath, extra: tuple[str, ...] = ()
) -> tuple[Any, TemperatureFactors]:
    """Return the record and the temperature factors of `{model: NAME, parameters: {...}, temperature_factors: {...}}`.

    The values stand under `keys` in the source and may have `extra` keys besides; factors default to the model's card.

    Raises:
        InputError: a key or the model is unknown, or a value is missing or not permitted.
    """
    mapping(values, source, keys)
    check_keys(values, ("model", "parameters", "temperature_factors", *extra), source, keys)
    cls = chosen_class("damper", values, "model", source, keys)
    specification = specification_of(cls)
    required: tuple[str, ...] = getattr(cls, "_fields", ()) if specification.complete else ()
    hint = "; this model has no set of its own, state every parameter" if specification.complete else ""
    record = build(cls, values.get("parameters", {}), source, (*keys, "parameters"), required, hint)
    if "temperature_factors" not in values:
        return record, specification.factors
    where = (*keys, "temperature_factors")
    return record, build(TemperatureFactors, values["temperature_factors"], source, where)
