"""JSON Schema of the files that seatsim reads, for editors: scenarios, recordings, sweeps, parameters of dampers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from seatsim.cosimulation.description import FORCE, QUANTITIES
from seatsim.dampers.base import DAMPERS
from seatsim.metrics.table import METRICS
from seatsim.recordings.header import Header, RunEntry
from seatsim.recordings.recording import ChannelEntry, VoltageGain
from seatsim.rig.coil import Coil
from seatsim.rig.plant import Plant
from seatsim.rig.sensors import Sensors
from seatsim.rig.temperature import TemperatureFactors, Thermal
from seatsim.scenario.scenario import Solver, Start
from seatsim.schema.fields import field_names
from seatsim.schema.json_schema import Schema, mapping_schema, record_schema
from seatsim.schema.registry import find, names
from seatsim.sweeps.definition import DESIGNS

ANYTHING: Schema = {}
TEXT: Schema = {"type": "string"}
BY_KEY: Schema = {"type": "object"}
OF_A_UNIT: Mapping[str, Schema] = {
    "inputs": mapping_schema(dict.fromkeys(QUANTITIES, TEXT)), "outputs": mapping_schema({FORCE: TEXT}, (FORCE,)),
}  # fmt: skip
"""Keys of a damper that is a functional mock-up unit: the names of its variables."""
BY_MODEL = "parameters_by_model"
"""Name of what holds for the parameters of each damper model."""


def scenario_schema() -> Schema:
    """Return the schema of a scenario, with the keys of every damper, law, excitation and effect by its name."""
    rig = {
        "name": TEXT,
        "seed": {"type": "integer", "minimum": 0, "description": "every random draw derives from it"},
        "plant": record_schema(Plant),
        "damper": _damper(OF_A_UNIT),
        "actuator": record_schema(Coil, ("rate", "max_current")),
        "temperature": _temperature(),
        "controller": _named(
            "law",
            "law",
            {
                "sample_time": _positive("s"),
                "inverse": _damper({"temperature": ANYTHING}),
                "sensors": record_schema(Sensors),
            },
        ),
        "excitation": _named("excitation", "kind", {}),
        "effects": {"type": "array", "items": _effect()},
        "solver": record_schema(Solver),
        "start": record_schema(Start),
        "variants": {"type": "object", "additionalProperties": BY_KEY},
        "sweep": {"type": "object", "additionalProperties": {"type": "array", "minItems": 1}},
        "published": BY_KEY,
    }
    whole = mapping_schema(rig, ("damper", "actuator", "temperature"))
    return _headed("seatsim scenario", whole | {"$defs": {BY_MODEL: _parameters_by_model()}})


def recording_schema() -> Schema:
    """Return the schema of `recording.yaml`."""
    keys = {name: value for name, value in _properties(record_schema(Header)).items() if name != "parameter_tolerance"}
    tolerance = {"anyOf": [{"type": "number", "minimum": 0, "maximum": 1}, {"const": "fitted"}, BY_KEY]}
    keys |= {
        "parameter_tolerance": tolerance,
        "runs": {"type": "array", "minItems": 1, "items": record_schema(RunEntry)},
        "channels": {"type": "object", "additionalProperties": record_schema(ChannelEntry)},
        "actuator": record_schema(VoltageGain),
        "note": TEXT,
    }
    return _headed("seatsim recording", mapping_schema(keys, ("rig", "sample_rate", "nominal", "runs", "channels")))


def parameters_schema() -> Schema:
    """Return the schema of a damper with its coil, as `seatsim identify` writes it."""
    keys = {"damper": _damper(), "actuator": record_schema(Coil, ("rate", "max_current")), "bench": BY_KEY}
    whole = mapping_schema(keys, ("damper",))
    return _headed("seatsim damper parameters", whole | {"$defs": {BY_MODEL: _parameters_by_model()}})


def sweep_schema() -> Schema:
    """Return the schema of a sweep."""
    number: Schema = {"type": "number"}
    pair = {"type": "array", "items": number, "minItems": 2, "maxItems": 2}
    whole: Schema = {"type": "integer", "minimum": 1}
    ends = {"low": number, "high": number}
    forms = [
        {"type": "array", "minItems": 1},
        mapping_schema(
            {"from": number, "to": number, "steps": {"type": "integer", "minimum": 2}}, ("from", "to", "steps")
        ),
        mapping_schema({"uniform": pair}, ("uniform",)),
        mapping_schema({"normal": pair, **ends}, ("normal",)),
        mapping_schema({"lognormal": pair, **ends}, ("lognormal",)),
        mapping_schema({"choice": {"type": "object", "additionalProperties": number}}, ("choice",)),
    ]
    keys = {
        "scenario": {"anyOf": [TEXT, BY_KEY]},
        "seed": {"type": "integer", "minimum": 0, "description": "every draw of the design derives from it"},
        "design": {"enum": list(DESIGNS)},
        "runs": {**whole, "description": "points of lhs and sobol; draws of cross and zip"},
        "replicates": {**whole, "description": "runs of each point with other seeds of the scenario"},
        "vary": {"type": "object", "additionalProperties": {"anyOf": forms}},
        "table": {**TEXT, "description": "CSV file whose columns are keys, for design table"},
        "limits": mapping_schema({name: {**number, "unit": metric.unit} for name, metric in METRICS.items()}),
    }
    return _headed("seatsim sweep", mapping_schema(keys, ("scenario",)))


FILES: Mapping[str, Callable[[], Schema]] = {
    "scenario": scenario_schema, "recording": recording_schema, "parameters": parameters_schema, "sweep": sweep_schema,
}  # fmt: skip
"""Schemas of files by kind."""


def _headed(title: str, schema: Schema) -> Schema:
    return {"$schema": "http://json-schema.org/draft-07/schema#", "title": title, **schema}


def _properties(schema: Schema) -> dict[str, object]:
    found = schema["properties"]
    assert isinstance(found, dict)
    return found


def _positive(unit: str) -> Schema:
    return {"type": "number", "exclusiveMinimum": 0, "unit": unit}


def _temperature() -> Schema:
    degrees: Schema = {"type": "number", "unit": "degC"}
    return {"anyOf": [degrees, {"type": "array", "items": degrees, "minItems": 1}, record_schema(Thermal)]}


def _name(kind: str) -> Schema:
    """Return the schema of a name: a registered one, or a class of the user's own."""
    return {"anyOf": [{"enum": names(kind)}, {"type": "string", "pattern": "^[^:]+:[^:]+$"}]}


def _when(key: str, cases: Iterable[tuple[str, Schema]]) -> list[Schema]:
    """Return what holds besides where `key` is one of several names."""
    return [{"if": {"properties": {key: {"const": name}}, "required": [key]}, "then": then} for name, then in cases]


def _named(kind: str, key: str, common: Mapping[str, Schema]) -> Schema:
    """Return the schema of a mapping in which the keys of a named class stand beside its name."""

    def own(name: str) -> Schema:
        keys = record_schema(find(kind, name))
        properties = {key: ANYTHING, **dict.fromkeys(common, ANYTHING), **_properties(keys)}
        return keys | {"properties": properties}

    cases = _when(key, ((name, own(name)) for name in names(kind)))
    return {"type": "object", "properties": {key: _name(kind), **common}, "required": [key], "allOf": cases}


def _damper(extra: Mapping[str, Schema] | None = None) -> Schema:
    keys = {"model": _name("damper"), "parameters": BY_KEY, "temperature_factors": record_schema(TemperatureFactors)}
    return mapping_schema({**keys, **(extra or {})}, ("model",)) | {"allOf": [{"$ref": f"#/$defs/{BY_MODEL}"}]}


def _parameters_by_model() -> Schema:
    def own(name: str) -> Schema:
        record = DAMPERS.find(name)
        required = field_names(record) if DAMPERS.specification_of(record).complete else None
        return {"properties": {"parameters": record_schema(record, required)}}

    return {"allOf": _when("model", ((name, own(name)) for name in names("damper")))}


def _effect() -> Schema:
    def own(name: str) -> Schema:
        return {"properties": {"parameters": record_schema(find("effect", name))}}

    cases = _when("effect", ((name, own(name)) for name in names("effect")))
    return mapping_schema({"effect": _name("effect"), "parameters": BY_KEY}, ("effect",)) | {"allOf": cases}
