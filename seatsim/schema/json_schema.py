"""JSON Schema of records, for editors that complete and check YAML files."""

from __future__ import annotations

import types
from collections.abc import Callable, Iterable, Mapping
from typing import Annotated, Union, cast, get_args, get_origin, get_type_hints

from pydantic import TypeAdapter

from seatsim.schema.fields import default_values, field_names
from seatsim.schema.files import plain
from seatsim.schema.registry import find, names

Schema = dict[str, object]
ANYTHING: Schema = {}
TEXT: Schema = {"type": "string"}
BY_KEY: Schema = {"type": "object"}


def head_schema(title: str, schema: Schema) -> Schema:
    """Return the schema of a whole file."""
    return {"$schema": "http://json-schema.org/draft-07/schema#", "title": title, **schema}


def record_schema(record: type, required: Iterable[str] | None = None) -> Schema:
    """Return the schema of a record class as a mapping of its fields, with unit, meaning, bounds and default of each.

    `required` names the keys that must be there, by default those without a default.
    """
    defaults = default_values(record)
    hints = get_type_hints(record, include_extras=True)
    properties: Schema = {}
    for name in field_names(record):
        default = {"default": plain(defaults[name])} if name in defaults else {}
        properties[name] = {**_hint_schema(hints[name]), **default}
    needed = [name for name in properties if name not in defaults] if required is None else list(required)
    return mapping_schema(properties, needed)


def mapping_schema(properties: Mapping[str, object], required: Iterable[str] = ()) -> Schema:
    """Return the schema of a mapping that has these keys and no others."""
    return {
        "type": "object",
        "properties": dict(properties),
        "required": list(required),
        "additionalProperties": False,
    }


def name_schema(kind: str) -> Schema:
    """Return the schema of a name: one that is registered as this kind, or a class of the user's own."""
    return {"anyOf": [{"enum": names(kind)}, {"type": "string", "pattern": "^[^:]+:[^:]+$"}]}


def cases_schema(kind: str, key: str, of: Callable[[str], Schema]) -> Schema:
    """Return what holds besides, by `of`, where the text under a key is one of the names of this kind."""
    return {
        "allOf": [
            {"if": {"properties": {key: {"const": name}}, "required": [key]}, "then": of(name)} for name in names(kind)
        ]
    }


def named_schema(kind: str, key: str, common: Mapping[str, Schema]) -> Schema:
    """Return the schema of a mapping in which the keys of a named class stand beside its name and the `common` ones."""

    def own(name: str) -> Schema:
        keys = record_schema(find(kind, name))
        known = dict.fromkeys((key, *common), ANYTHING) | cast("Schema", keys["properties"])
        return keys | {"properties": known}

    properties = {key: name_schema(kind), **common}
    return {"type": "object", "properties": properties, "required": [key]} | cases_schema(kind, key, own)


def _hint_schema(hint: object) -> Schema:
    """Return the schema of a field's type; a record in it is a mapping, where pydantic would have a list."""
    if not _has_record(hint):
        found = dict(TypeAdapter(cast("type", hint)).json_schema())
        # An editor shows descriptions alone.
        unit = found.get("unit", "-")
        return found if unit == "-" else found | {"description": f"{found['description']} [{unit}]"}
    if get_origin(hint) is Annotated:
        inner, *marks = get_args(hint)
        told = next((mark.description for mark in marks if getattr(mark, "description", None)), None)
        return {**_hint_schema(inner), **({"description": told} if told else {})}
    if isinstance(hint, type):
        return record_schema(hint)
    return {"anyOf": [_hint_schema(part) for part in get_args(hint)]}


def _has_record(hint: object) -> bool:
    if isinstance(hint, type) and field_names(hint):
        return True
    nested = get_origin(hint) in (Annotated, Union, types.UnionType)
    return nested and any(_has_record(part) for part in get_args(hint))
