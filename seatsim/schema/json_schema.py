"""JSON Schema of records: of files that are read, for editors that complete and check them, and of what is written."""

from __future__ import annotations

import ast
import inspect
import textwrap
import types
from collections.abc import Callable, Iterable, Mapping
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Literal, Union, cast, get_args, get_origin, get_type_hints

import numpy as np
from pydantic import TypeAdapter

from seatsim.schema.content import find_record, is_record, list_written, plain
from seatsim.schema.fields import default_values, field_names
from seatsim.schema.registry import find, names

Schema = dict[str, object]
ANYTHING: Schema = {}
TEXT: Schema = {"type": "string"}
BY_KEY: Schema = {"type": "object"}
_WORDS: Mapping[object, Schema] = {
    # What is no finite number is written as null.
    float: {"type": ["number", "null"]},
    int: {"type": "integer"},
    bool: {"type": "boolean"},
    str: {"type": "string"},
    Path: {"type": "string"},
    types.NoneType: {"type": "null"},
    np.ndarray: {"type": "array"},
}
"""Types of single values, and of arrays of whatever shape."""


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
    return {"type": "object", "properties": dict(properties), "required": list(required), "additionalProperties": False}


def properties_of(schema: Schema) -> Schema:
    """Return the properties that the schema of a mapping states."""
    return cast("Schema", schema["properties"])


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
        known = dict.fromkeys((key, *common), ANYTHING) | properties_of(keys)
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


def answer_schema(hint: object) -> Schema:
    """Return the schema of what `seatsim.schema.content.plain` makes of a record, or of one of several kinds."""
    known: Schema = {}
    schema = _written_record_schema(hint, known) if is_record(hint) else _written_schema(hint, known)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema, "$defs": known}


def _written_schema(hint: object, known: Schema) -> Schema:
    """Return the schema of what is written of values of a type; those of records are added to the `known` ones."""
    origin, parts = get_origin(hint), get_args(hint)
    found: Schema = {}
    if hint in _WORDS or origin in _WORDS:
        found = _WORDS[hint if hint in _WORDS else origin]
    elif is_record(hint):
        if hint.__name__ not in known:
            known[hint.__name__] = found  # a record may hold its like
            known[hint.__name__] = _written_record_schema(hint, known)
        found = {"$ref": f"#/$defs/{hint.__name__}"}
    elif origin is Annotated:
        found = _written_schema(parts[0], known)
    elif origin is Literal:
        found = {"enum": list(parts)}
    elif origin in (Union, types.UnionType):
        found = {"anyOf": [_written_schema(part, known) for part in parts]}
    elif isinstance(origin, type) and issubclass(origin, Mapping):
        found = {"type": "object", "additionalProperties": _written_schema(parts[1], known)}
    elif origin is tuple and ... not in parts:
        items = [_written_schema(part, known) for part in parts]
        found = {"type": "array", "prefixItems": items, "minItems": len(items), "maxItems": len(items)}
    elif isinstance(origin, type) and issubclass(origin, Iterable):
        found = {"type": "array", "items": _written_schema(parts[0], known)}
    return found


def _written_record_schema(record: type, known: Schema) -> Schema:
    """Return the schema of a record: what it is by its docstring, and its fields by the texts below them."""
    properties, required = _written_properties(record, known)
    about = inspect.getdoc(record)
    return {"type": "object", "description": about, "properties": properties, "required": required}


def _written_properties(record: type, known: Schema) -> tuple[Schema, list[str]]:
    """Return the schemas of the fields of a record, and the keys that are always written."""
    texts = _field_texts(record)
    properties: Schema = {}
    required: list[str] = []
    for field in list_written(record):
        joined = find_record(field.hint) if field.form.joined else None
        if joined:
            inner, needed = _written_properties(joined, known)
            properties |= inner
            required += needed
        elif not field.form.joined:
            # What is joined and no record is given by a plug-in, and known by what it does alone.
            told = {"description": texts[field.name]} if field.name in texts else {}
            properties[field.key] = _written_schema(field.hint, known) | told
            required += [] if field.form.if_any else [field.key]
    return properties, required


def _field_texts(record: type) -> Mapping[str, str]:
    """Return what the source of a class says of its fields, below them, and of its properties."""
    texts: dict[str, str] = {}
    for kind in (each for each in reversed(record.__mro__) if is_record(each)):
        definition = ast.parse(textwrap.dedent(inspect.getsource(kind))).body[0]
        body = definition.body if isinstance(definition, ast.ClassDef) else []
        texts |= {each.name: ast.get_docstring(each) or "" for each in body if isinstance(each, ast.FunctionDef)}
        for field, below in pairwise(body):
            match field, below:
                case ast.AnnAssign(target=ast.Name(id=name)), ast.Expr(value=ast.Constant(value=str(text))):
                    texts[name] = inspect.cleandoc(text)
    return texts
