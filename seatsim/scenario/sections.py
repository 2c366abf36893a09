"""What a scenario file may hold: every key at its top, stated once.

The reading of a file, its JSON Schema (`seatsim schema`), the pages of `seatsim describe` and the keys that `--set`
completes all come from `SECTIONS`. A key of plant, driver, coil, solver, start or sensors is a field of a record, where
its unit, meaning, bounds and default stand.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple, TypeVar, cast

from seatsim.dampers.base import DAMPERS
from seatsim.effects.base import EFFECTS
from seatsim.rig.coil import Coil
from seatsim.rig.control import LAWS
from seatsim.rig.drivers import Driver
from seatsim.rig.plant import Plant
from seatsim.rig.sensors import Sensors
from seatsim.rig.temperature import TemperatureFactors, Thermal
from seatsim.scenario.checks import checks_schema, read_checks
from seatsim.scenario.scenario import Control, DamperChoice, Inverse, Solver, Start
from seatsim.schema import json_schema
from seatsim.schema.errors import InputError, gathered, raise_all, read_each
from seatsim.schema.fields import field_names, param
from seatsim.schema.json_schema import (
    ANYTHING,
    BY_KEY,
    TEXT,
    Schema,
    cases_schema,
    mapping_schema,
    name_schema,
    record_schema,
)
from seatsim.schema.registry import Record, Registry, find
from seatsim.schema.text import explain_bad_name
from seatsim.schema.validation import build, check_keys, chosen_class, is_finite_number, mapping, read_whole
from seatsim.schema.yaml_source import Source
from seatsim.schema.yaml_text import KeyPath

if TYPE_CHECKING:
    from seatsim.excitations.base import Excitation

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


_LARGEST_SEED = 2**63 - 1
"""The largest whole number that a column of a table holds."""
FILES = (("controller", "design"), ("excitation", "path"))
"""_Section and key under which a scenario names a file, from its own folder."""
# An excitation may read a recording, whose nominal is a scenario: their package builds on this one.
_EXCITATIONS: Registry[Excitation, object] = Registry("excitation")
_P = TypeVar("_P")


class _Sampling(NamedTuple):
    """When a law is asked; one without a sample time has that of `seatsim.simulation.simulate`."""

    sample_time: Annotated[float | None, param("s", "time between two samples of the law", above=0, high=1)] = None


class _Section(NamedTuple):
    """A key at the top of a scenario file: what reads its value, and what gives the JSON Schema of it.

    `record` is the class whose fields are its keys, where these are always the same; `field` is that of a `Scenario`
    which holds what was read, where it is not called as the key.
    """

    read: Callable[[object, Source], object]
    schema: Callable[[], Schema]
    record: type | None = None
    field: str = ""


def _of_record(key: str, record: type, required: tuple[str, ...] = (), field: str = "") -> _Section:
    """Return the section whose keys are the fields of a record; `required` ones must be stated despite a default."""
    return _Section(
        lambda value, source: build(record, value, source, (key,), required),
        lambda: record_schema(record, required or None),
        record,
        field,
    )


def _read_name(value: object, source: Source) -> str:
    """Return the name of a scenario, which its folder of results has."""
    if isinstance(value, dict | list) or value is None:
        raise source.error(("name",), f"{value!r} is no name; write it as text")
    if problem := explain_bad_name(str(value)):
        raise source.error(("name",), f"{str(value)!r} {problem}")
    return str(value)


def _read_temperature(value: object, source: Source) -> float | Thermal:
    if isinstance(value, Mapping):
        return build(Thermal, value, source, ("temperature",))
    return float(build(Thermal, {"start": value}, source, ("temperature",)).start)


def _temperature_schema() -> Schema:
    degrees: Schema = {"type": "number", "unit": "degC"}
    return {"anyOf": [degrees, {"type": "array", "items": degrees, "minItems": 1}, record_schema(Thermal)]}


def _read_control(values: object, source: Source) -> Control:
    keys: KeyPath = ("controller",)
    stated = mapping(values, source, keys)

    sensors, sampling = (*keys, "sensors"), {key: stated[key] for key in _Sampling._fields if key in stated}
    readers: dict[str, Callable[[], object]] = {
        "law": lambda: _read_named(LAWS, stated, ("law", *_CONTROL), "design", source, keys),
        "inverse": lambda: _read_inverse(stated["inverse"], source) if "inverse" in stated else None,
        "sensors": lambda: build(Sensors, stated["sensors"], source, sensors) if "sensors" in stated else None,
        "sample_time": lambda: build(_Sampling, sampling, source, keys).sample_time,
        "floors": lambda: _read_floors(stated.get("floors", []), source),
    }
    return Control(**read_each(readers))


def _read_floors(values: object, source: Source) -> tuple[Excitation, ...]:
    keys: KeyPath = ("controller", "floors")
    if not isinstance(values, list):
        raise source.error(keys, f"{values!r} is not a list; write '- kind: NAME' below it, once for every floor")
    return tuple(_read_excitation(value, source, (*keys, index)) for index, value in enumerate(values))


def _read_inverse(values: object, source: Source) -> Inverse:
    keys: KeyPath = ("controller", "inverse")
    damper = read_damper(values, source, keys, extra=("temperature",))
    temperature = mapping(values, source, keys).get("temperature", "measured")
    if temperature == "measured":
        return Inverse(damper, None)
    if not is_finite_number(temperature):
        raise source.error((*keys, "temperature"), f"{temperature!r} is not permitted; a number in degC or 'measured'")
    return Inverse(damper, float(temperature))


_CONTROL: Mapping[str, Callable[[], Schema]] = {
    "sample_time": lambda: cast("Schema", json_schema.properties_of(record_schema(_Sampling))["sample_time"]),
    "inverse": lambda: damper_schema({"temperature": ANYTHING}),
    "sensors": lambda: record_schema(Sensors),
    "floors": lambda: {"type": "array", "items": json_schema.named_schema("excitation", "kind", {})},
}
"""Keys of a controller that stand beside those of its law."""


def _read_excitation(values: object, source: Source, keys: KeyPath = ("excitation",)) -> Excitation:
    return _read_named(_EXCITATIONS, values, ("kind",), "path", source, keys)


def _read_named(
    registry: Registry[_P, Any], values: object, others: tuple[str, ...], file: str, source: Source, keys: KeyPath
) -> _P:
    """Return the record of a section that names a class and holds its parameters.

    The first of `others` is the key of the name, the rest are keys of the section that are no parameters; `file` is the
    key of a file that lies beside the source.
    """
    stated = mapping(values, source, keys)
    cls = chosen_class(registry, stated, others[0], source, keys)
    own = {key: value for key, value in stated.items() if key not in others}
    if isinstance(name := own.get(file), str):
        own[file] = str(source.path.parent / name)
    return build(cls, own, source, keys)


def _read_effects(values: object, source: Source) -> tuple[Record, ...]:
    if not isinstance(values, list):
        raise source.error(("effects",), f"{values!r} is not a list; write '- effect: NAME' below it")
    return tuple(read_each({k: partial(_read_effect, value, source, k) for k, value in enumerate(values)}).values())


def _read_effect(value: object, source: Source, index: int) -> Record:
    keys: KeyPath = ("effects", index)
    stated = mapping(value, source, keys)
    check_keys(stated, ("effect", "parameters"), source, keys)
    cls = chosen_class(EFFECTS, stated, "effect", source, keys)
    return build(cls, stated.get("parameters", {}), source, (*keys, "parameters"))


def _effects_schema() -> Schema:
    def own(name: str) -> Schema:
        return {"properties": {"parameters": record_schema(find("effect", name))}}

    keys = {"effect": name_schema("effect"), "parameters": BY_KEY}
    items = mapping_schema(keys, ("effect",)) | json_schema.cases_schema("effect", "effect", own)
    return {"type": "array", "items": items}


SECTIONS: Mapping[str, _Section] = {
    "name": _Section(_read_name, lambda: TEXT),
    "seed": _Section(
        lambda value, source: read_whole(value, source, ("seed",), 0, _LARGEST_SEED),
        lambda: {"type": "integer", "minimum": 0, "description": "every random draw derives from it"},
    ),
    "plant": _of_record("plant", Plant),
    "driver": _of_record("driver", Driver),
    "damper": _Section(lambda value, source: read_damper(value, source, ("damper",)), damper_schema),
    "actuator": _of_record("actuator", Coil, ("rate", "max_current"), "coil"),
    "temperature": _Section(_read_temperature, _temperature_schema, Thermal),
    "controller": _Section(
        _read_control,
        lambda: json_schema.named_schema("law", "law", {key: schema() for key, schema in _CONTROL.items()}),
        field="control",
    ),
    "excitation": _Section(_read_excitation, lambda: json_schema.named_schema("excitation", "kind", {})),
    "effects": _Section(_read_effects, _effects_schema),
    "solver": _of_record("solver", Solver),
    "start": _of_record("start", Start),
    "checks": _Section(read_checks, checks_schema),
}
"""What a scenario is made of, by the keys at the top of its file."""
OF_ALL_RUNS: Mapping[str, Schema] = {
    "variants": {"type": "object", "additionalProperties": BY_KEY},
    "sweep": {"type": "object", "additionalProperties": {"type": "array", "minItems": 1}},
}
"""Further keys, which make several runs of a file or speak of all of them."""
NEEDED, NEEDED_BY_A_SEAT = ("damper", "actuator", "temperature"), ("plant", "controller", "excitation")
"""Keys that must be stated; a file without any of the latter is a damper bench."""
RECORDS: Mapping[str, type] = {key: section.record for key, section in SECTIONS.items() if section.record} | {
    "temperature_factors": TemperatureFactors,
    "sensors": Sensors,
}
"""The records whose fields are keys, by what they are called."""


def scenario_schema() -> Schema:
    """Return the JSON Schema of a scenario, with the keys of every damper, law, excitation and effect by its name."""
    keys = {key: section.schema() for key, section in SECTIONS.items()}
    whole = mapping_schema(keys | dict(OF_ALL_RUNS), NEEDED) | schema_of_models()
    return json_schema.head_schema("seatsim scenario", whole)
