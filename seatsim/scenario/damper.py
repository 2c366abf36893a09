"""A damper as a YAML file states it: a model with its parameters."""

from __future__ import annotations

from collections.abc import Mapping

from seatsim.dampers.base import DAMPERS
from seatsim.rig.temperature import TemperatureFactors
from seatsim.scenario.scenario import DamperChoice
from seatsim.schema.errors import InputError, gathered, raise_all
from seatsim.schema.fields import field_names
from seatsim.schema.json_schema import BY_KEY, Schema, cases_schema, mapping_schema, name_schema, record_schema
from seatsim.schema.validation import build, check_keys, chosen_class, mapping
from seatsim.schema.yaml_source import Source
from seatsim.schema.yaml_text import KeyPath

_MODELS = "parameters_by_model"
"""Name of what a JSON Schema states of the parameters of each damper model."""


def read_damper(values: object, source: Source, keys: KeyPath, extra: tuple[str, ...] = ()) -> DamperChoice:
    """Return the damper of `{model: NAME, parameters: {...}, temperature_factors: {...}}`.

    The values stand under `keys` in the source and may have `extra` keys besides; factors default to the model's own.

    Raises:
        InputError: a key or the model is unknown, or a value is missing or not permitted.
    """
    stated, errors = mapping(values, source, keys), list[InputError]()
    with gathered(errors):
        check_keys(stated, ("model", "parameters", "temperature_factors", *extra), source, keys)
    with gathered(errors):
        cls = chosen_class(DAMPERS, stated, "model", source, keys)
        specification = DAMPERS.specification_of(cls)
        hint, required = "", tuple[str, ...]()
        if specification.complete:
            name, required = stated["model"], field_names(cls)
            lists = f"seatsim describe {name} lists them"
            hint = f"; the model '{name}' has no default values: state every parameter ({lists})"
        record = build(cls, stated.get("parameters", {}), source, (*keys, "parameters"), required, hint)
    factors = None
    if "temperature_factors" in stated:
        with gathered(errors):
            where = (*keys, "temperature_factors")
            factors = build(TemperatureFactors, stated["temperature_factors"], source, where)
    raise_all(errors)
    return DamperChoice(record, factors or specification.factors)


def damper_schema(extra: Mapping[str, Schema] | None = None) -> Schema:
    """Return the JSON Schema of a damper with `extra` keys besides.

    It refers to `schema_of_models`, which the whole schema holds.
    """
    keys = {
        "model": name_schema("damper"),
        "parameters": BY_KEY,
        "temperature_factors": record_schema(TemperatureFactors),
    }
    return mapping_schema(keys | dict(extra or {}), ("model",)) | {"allOf": [{"$ref": f"#/$defs/{_MODELS}"}]}


def schema_of_models() -> Schema:
    """Return the definition of the parameters of every damper model."""

    def own(name: str) -> Schema:
        record = DAMPERS.find(name)
        required = field_names(record) if DAMPERS.specification_of(record).complete else None
        return {"properties": {"parameters": record_schema(record, required)}}

    return {"$defs": {_MODELS: cases_schema("damper", "model", own)}}
