"""From a mapping of a YAML file to a validated record, with one clear error where it does not fit."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import TypeGuard, TypeVar, cast

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from seatsim.schema.errors import InputError, nearest
from seatsim.schema.fields import describe, field_names, validated
from seatsim.schema.plausible import guess
from seatsim.schema.registry import Record, Registry
from seatsim.schema.yaml_source import Source
from seatsim.schema.yaml_text import KeyPath

R = TypeVar("R")
P = TypeVar("P")
S = TypeVar("S")


def build(
    record: type[R], values: object, source: Source, keys: KeyPath, required: Iterable[str] = (), hint: str = ""
) -> R:
    """Return the `record` with the given values, which stand under `keys` in the source.

    `required` names fields that must be given although the record has defaults; `hint` is added to errors of a
    missing key. Raises InputError with place, value, what is permitted and the nearest valid name.
    """
    stated = mapping(values, source, keys)
    check_keys(stated, field_names(record), source, keys)
    _check_finite(stated, source, keys)
    for name in required:
        if name not in stated:
            raise source.error(keys, f"key '{name}' is missing{hint}")
    try:
        return validated(record, _tuples(stated))
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = (*keys, *(part for part in first["loc"] if not str(part).startswith("function-")))
        added = hint if first["type"] == "missing" else sweep_hint(first["input"], where)
        raise source.error(where, _problem(record, first) + added) from None


def sweep_hint(value: object, keys: KeyPath) -> str:
    """Return how several values of a key are stated, where a list stands for a single one."""
    if not isinstance(value, list | tuple) or not keys or isinstance(keys[-1], int):
        return ""
    dotted, values = ".".join(map(str, keys)), ", ".join(map(str, value))
    return f"; several values are a sweep, which stands in the file: 'sweep: {{{dotted}: [{values}]}}'"


def check_value(record: Record, name: str, value: object, source: Source, keys: KeyPath) -> None:
    """Raise InputError, placed at `keys` of a source, where a field of a record may not have a value."""
    _check_finite(value, source, keys)
    try:
        validated(type(record), {**record._asdict(), name: value})
    except ValidationError as error:
        raise source.error(keys, _problem(type(record), error.errors(include_url=False)[0])) from None


def mapping(values: object, source: Source, keys: KeyPath) -> Mapping[str, object]:
    """Return the values if they are a mapping, else raise InputError."""
    if not isinstance(values, Mapping):
        raise source.error(keys, f"{_shown(values)} is not a mapping; write its keys indented below it")
    return cast("Mapping[str, object]", values)


def check_keys(values: Mapping[str, object], known: Iterable[str], source: Source, keys: KeyPath) -> None:
    """Raise InputError at the first key that is not known."""
    permitted = list(known)
    for key in values:
        if key not in permitted:
            raise source.error((*keys, key), f"unknown key{nearest(key, permitted)}; permitted: {', '.join(permitted)}")


def choose(values: Mapping[str, object], key: str, source: Source, keys: KeyPath) -> str:
    """Return the text under a key that must be there, such as a model's name."""
    if key not in values:
        raise source.error(keys, f"key '{key}' is missing{nearest(key, values)}")
    if not isinstance(values[key], str):
        raise source.error((*keys, key), f"{_shown(values[key])} is not a name; write it as text")
    return str(values[key])


def chosen_class(
    registry: Registry[P, S], values: Mapping[str, object], key: str, source: Source, keys: KeyPath
) -> type[P]:
    """Return the registered class that is named under a key, or raise InputError at that place."""
    name = choose(values, key, source, keys)
    try:
        return registry.find(name, source.path.parent)
    except InputError as error:
        raise source.error((*keys, key), str(error)) from error


def is_finite_number(value: object) -> TypeGuard[float]:
    """Return whether a value is a finite number; a truth value is none."""
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _check_finite(value: object, source: Source, keys: KeyPath) -> None:
    """Raise InputError at the first number that is infinite or not a number."""
    if isinstance(value, float):
        if not math.isfinite(value):
            raise source.error(keys, f"{value} is not permitted; it must be a finite number")
    elif isinstance(value, Mapping | list):
        items = value.items() if isinstance(value, Mapping) else enumerate(value)
        for key, item in items:
            _check_finite(item, source, (*keys, key))


def _problem(record: type, error: ErrorDetails) -> str:
    """Translate pydantic's finding into what is wrong, what is permitted, and in which unit."""
    context, value = error.get("ctx") or {}, _shown(error["input"])
    name = error["loc"][0] if error["loc"] else ""
    field = next((specification for specification in describe(record) if specification.name == name), None)
    unit = field.unit if field else ""
    suffix = f" {unit}" if unit and unit != "-" else ""
    meant = guess(error["input"], field) if field else ""
    bounds = {"greater_than_equal": ("at least", "ge"), "less_than_equal": ("at most", "le")}
    bounds |= {"greater_than": ("greater than", "gt"), "less_than": ("less than", "lt")}
    if error["type"] in bounds:
        word, bound = bounds[error["type"]]
        return f"{value} is not permitted; it must be {word} {context[bound]:g}{suffix}{meant}"
    if error["type"] == "missing":
        return "this key is missing"
    if error["type"] == "literal_error":
        options = [part.strip("' ") for part in str(context["expected"]).replace(" or ", ", ").split(",")]
        return f"{value} is not permitted{nearest(error['input'], options)}; permitted: {', '.join(options)}"
    if error["type"] == "tuple_type":
        return f"{value} is not permitted; it must be a list, such as [{error['input']}]"
    if error["type"].startswith(("float", "int", "finite")):
        return f"{value} is not permitted; it must be a finite number{f' in {unit}' if suffix else ''}"
    return f"{value} is not permitted: {error['msg'][0].lower()}{error['msg'][1:]}"


def _shown(value: object) -> str:
    text = f"'{value}'" if isinstance(value, str) else str(list(value) if isinstance(value, tuple) else value)
    return text if len(text) <= 60 else text[:57] + "..."


def _tuples(value: object) -> object:
    """Return the value with lists as tuples, which strict validation of records asks for."""
    if isinstance(value, list | tuple):
        return tuple(_tuples(item) for item in value)
    if isinstance(value, float) or not isinstance(value, Mapping):
        return value
    return {key: _tuples(item) for key, item in value.items()}
