"""JSON Schema of records, for editors that complete and check YAML files."""

from __future__ import annotations

import types
from collections.abc import Iterable, Mapping
from typing import Annotated, Union, cast, get_args, get_origin, get_type_hints

from pydantic import TypeAdapter

from seatsim.schema.fields import default_values, field_names
from seatsim.schema.files import plain

Schema = dict[str, object]


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
        "type": "object", "properties": dict(properties), "required": list(required), "additionalProperties": False,
    }  # fmt: skip


def _hint_schema(hint: object) -> Schema:
    """Return the schema of a field's type; a record in it is a mapping, where pydantic would have a list."""
    if not _has_record(hint):
        return dict(TypeAdapter(cast("type", hint)).json_schema())
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
