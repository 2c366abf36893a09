"""A damper as a YAML file states it: a model with its parameters, or a functional mock-up unit."""

from __future__ import annotations

from collections.abc import Mapping
from typing import cast

from seatsim.cosimulation import description
from seatsim.cosimulation.damper import PREFIX, FmuDamper
from seatsim.cosimulation.description import FORCE, QUANTITIES
from seatsim.dampers.base import DAMPERS, Damper
from seatsim.rig.temperature import TemperatureFactors
from seatsim.scenario.scenario import DamperChoice
from seatsim.schema.errors import InputError, gathered, placed, raise_all
from seatsim.schema.fields import field_names
from seatsim.schema.json_schema import BY_KEY, TEXT, Schema, cases_schema, mapping_schema, name_schema, record_schema
from seatsim.schema.modules import check_in_use
from seatsim.schema.validation import build, check_keys, choose, chosen_class, mapping
from seatsim.schema.yaml_source import Source
from seatsim.schema.yaml_text import KeyPath


def _stated_unit(stated: Mapping[str, object], source: Source, keys: KeyPath) -> Damper:
    """Return the damper of `{model: fmu:FILE, inputs: {QUANTITY: NAME}, outputs: {force: NAME}, parameters: {...}}`.

    FILE is taken from the folder of the source. Only what the unit says of itself is read; nothing of it runs.

    Raises:
        InputError: nobody named the file, it is no unit that can be stepped here, or the mapping does not fit it.
    """
    if keys != ("damper",):
        raise source.error((*keys, "model"), "a unit has no inverse; name a damper model that the inverse assumes")
    check_keys(stated, ("model", "inputs", "outputs", "parameters"), source, keys)
    path = source.path.parent / str(stated["model"]).removeprefix(PREFIX)
    with placed(source.place((*keys, "model"))):
        check_in_use(path)
        unit = description.describe_unit(path)
    inputs = _names(stated, "inputs", tuple(QUANTITIES), source, keys)
    outputs = _names(stated, "outputs", (FORCE,), source, keys)
    if not inputs or FORCE not in outputs:
        missing, all_of = ("inputs", ", ".join(QUANTITIES)) if not inputs else ("outputs", FORCE)
        raise source.error(keys, f"key '{missing}' is missing or empty; it names a variable of the unit for {all_of}")
    for section, names, causality in (("inputs", inputs, "input"), ("outputs", outputs, "output")):
        for quantity, name in names.items():
            with placed(source.place((*keys, section, quantity))):
                description.find_conversion_of(description.find_variable(unit, name, causality), quantity)
    values: dict[str, float] = {}
    for name, value in mapping(stated.get("parameters", {}), source, (*keys, "parameters")).items():
        with placed(source.place((*keys, "parameters", name))):
            values[name] = description.check_parameter(unit, name, value)
    return cast("Damper", FmuDamper(str(path), tuple(inputs.items()), outputs[FORCE], tuple(values.items())))


def _names(
    stated: Mapping[str, object], section: str, permitted: tuple[str, ...], source: Source, keys: KeyPath
) -> dict[str, str]:
    """Return the names of variables by quantity, in the order in which these are listed."""
    named = mapping(stated.get(section, {}), source, (*keys, section))
    check_keys(named, permitted, source, (*keys, section))
    return {quantity: choose(named, quantity, source, (*keys, section)) for quantity in permitted if quantity in named}


_MODELS = "parameters_by_model"
"""Name of what a JSON Schema states of the parameters of each damper model."""


def read_damper(values: object, source: Source, keys: KeyPath, extra: tuple[str, ...] = ()) -> DamperChoice:
    """Return the damper of `{model: NAME, parameters: {...}, temperature_factors: {...}}`.

    The values stand under `keys` in the source and may have `extra` keys besides; factors default to the model's own.

    Raises:
        InputError: a key or the model is unknown, or a value is missing or not permitted.
    """
    stated, errors = mapping(values, source, keys), list[InputError]()
    if str(stated.get("model")).startswith(PREFIX):
        return DamperChoice(_stated_unit(stated, source, keys), TemperatureFactors())
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


def damper_schema(extra: Mapping[str, Schema] | None = None, of_a_unit: bool = False) -> Schema:
    """Return the JSON Schema of a damper with `extra` keys besides, and those of a functional mock-up unit.

    It refers to `schema_of_models`, which the whole schema holds.
    """
    keys = {
        "model": name_schema("damper"),
        "parameters": BY_KEY,
        "temperature_factors": record_schema(TemperatureFactors),
    }
    if of_a_unit:
        keys["inputs"] = mapping_schema(dict.fromkeys(QUANTITIES, TEXT))
        keys["outputs"] = mapping_schema({FORCE: TEXT}, (FORCE,))
    return mapping_schema(keys | dict(extra or {}), ("model",)) | {"allOf": [{"$ref": f"#/$defs/{_MODELS}"}]}


def schema_of_models() -> Schema:
    """Return the definition of the parameters of every damper model."""

    def own(name: str) -> Schema:
        record = DAMPERS.find(name)
        required = field_names(record) if DAMPERS.specification_of(record).complete else None
        return {"properties": {"parameters": record_schema(record, required)}}

    return {"$defs": {_MODELS: cases_schema("damper", "model", own)}}
