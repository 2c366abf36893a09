"""A damper as a YAML file states it."""

from __future__ import annotations

from seatsim.cosimulation.damper import PREFIX
from seatsim.dampers.base import DAMPERS, Damper
from seatsim.rig.temperature import TemperatureFactors
from seatsim.scenario.unit_damper import stated_unit
from seatsim.schema.fields import field_names
from seatsim.schema.validation import build, check_keys, chosen_class, mapping
from seatsim.schema.yaml_source import Source
from seatsim.schema.yaml_text import KeyPath


def stated_damper(
    values: object, source: Source, keys: KeyPath, extra: tuple[str, ...] = ()
) -> tuple[Damper, TemperatureFactors]:
    """Return the record and the temperature factors of `{model: NAME, parameters: {...}, temperature_factors: {...}}`.

    The values stand under `keys` in the source and may have `extra` keys besides; factors default to the model's own.

    Raises:
        InputError: a key or the model is unknown, or a value is missing or not permitted.
    """
    stated = mapping(values, source, keys)
    if str(stated.get("model")).startswith(PREFIX):
        return stated_unit(stated, source, keys), TemperatureFactors()
    check_keys(stated, ("model", "parameters", "temperature_factors", *extra), source, keys)
    cls = chosen_class(DAMPERS, stated, "model", source, keys)
    specification = DAMPERS.specification_of(cls)
    required = field_names(cls) if specification.complete else ()
    name = stated["model"]
    hint = (
        f"; the model '{name}' has no default values: state every parameter (seatsim describe {name} lists them)"
        if specification.complete
        else ""
    )
    record = build(cls, stated.get("parameters", {}), source, (*keys, "parameters"), required, hint)
    if "temperature_factors" not in stated:
        return record, specification.factors
    where = (*keys, "temperature_factors")
    return record, build(TemperatureFactors, stated["temperature_factors"], source, where)
