"""From a mapping of a YAML file to a validated record, with one clear error where it does not fit."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TypeGuard, TypeVar

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from seatsim.schema.errors import InputError, find_nearest, nearest, permit, placed, raise_all
from seatsim.schema.fields import describe, field_names, guess, validated
from seatsim.schema.registry import Record, Registry
from seatsim.schema.text import cut
from seatsim.schema.yaml_source import Source
from seatsim.schema.yaml_text import KeyPath

_R = TypeVar("_R")
_P = TypeVar("_P")
_S = TypeVar("_S")


def build(
    record: type[_R], values: object, source: Source, keys: KeyPath, required: Iterable[str] = (), hint: str = ""
) -> _R:
    """Return the `record` with the given values, which stand under `keys` in the source.

    `required` names fields that must be given although the record has defaults; `hint` is added to errors of a
    missing key.

    Raises:
        InputError: a key is unknown or missing, or a value is not permitted; it names place, value, what is permitted
            and the nearest valid name, and its notes do so for what else is wrong.
    """
    stated = mapping(values, source, keys)
    known = field_names(record)
    unknown = list(_find_unknown(stated, known, source, keys))
    infinite = dict(_find_infinite(stated, source, keys))
    meant = {find_nearest(key, known) for key in stated if key not in known}
    missing = [name for name in required if name not in stated and name not in meant]
    errors = [*unknown, *infinite.values()]
    errors += [source.error(keys, f"key '{name}' is missing{hint}") for name in missing]
    try:
        found = validated(record, _tuples({key: value for key, value in stated.items() if key in known}))
    except ValidationError as error:
        # What is missing under the name that a misspelt key means, or is no finite number, is said already.
        said = {*infinite, *((*keys, name) for name in (*missing, *meant))}
        for each in error.errors(include_url=False):
            where = (*keys, *(part for part in each["loc"] if not str(part).startswith("function-")))
            added = hint if each["type"] == "missing" else _sweep_hint(each["input"], where)
            if where not in said:
                errors.append(source.error(where, _problem(record, each) + added))
    raise_all(errors)
    return found


def _sweep_hint(value: object, keys: KeyPath) -> str:
    """Return how several values of a key are stated, where a list stands for a single one."""
    if not isinstance(value, list | tuple) or not keys or isinstance(keys[-1], int):
        return ""
    dotted, values = ".".join(map(str, keys)), ", ".join(map(str, value))
    return f"; several values are a sweep, which stands in the file: 'sweep: {{{dotted}: [{values}]}}'"


def check_value(record: Record, name: str, value: object, source: Source, keys: KeyPath) -> None:
    """Raise InputError, placed at `keys` of a source, where a field of a record may not have a value."""
    raise_all([error for _, error in _find_infinite(value, source, keys)])
    try:
        validated(type(record), {**record._asdict(), name: value})
    except ValidationError as error:
        raise source.error(keys, _problem(type(record), error.errors(include_url=False)[0])) from None


def mapping(values: object, source: Source, keys: KeyPath) -> Mapping[str, object]:
    """Return the values if they are a mapping, else raise InputError."""
    if not isinstance(values, Mapping):
        raise source.error(keys, f"{_shown(values)} is not a mapping; write its keys indented below it")
    return values


def check_keys(values: Mapping[str, object], known: Iterable[str], source: Source, keys: KeyPath) -> None:
    """Raise InputError where keys are not known."""
    raise_all(list(_find_unknown(values, list(known), source, keys)))


def _find_unknown(
    values: Mapping[str, object], known: Sequence[str], source: Source, keys: KeyPath
) -> Iterator[InputError]:
    yield from (source.error((*keys, key), f"unknown key{permit(key, known)}") for key in values if key not in known)


def choose(values: Mapping[str, object], key: str, source: Source, keys: KeyPath) -> str:
    """Return the text under a key that must be there, such as a model's name."""
    if key not in values:
        raise source.error(keys, f"key '{key}' is missing{nearest(key, values)}")
    if not isinstance(values[key], str):
        raise source.error((*keys, key), f"{_shown(values[key])} is not a name; write it as text")
    return str(values[key])


def chosen_class(
    registry: Registry[_P, _S], values: Mapping[str, object], key: str, source: Source, keys: KeyPath
) -> type[_P]:
    """Return the registered class that is named under a key, or raise InputError at that place."""
    name = choose(values, key, source, keys)
    with placed(source.place((*keys, key))):
        return registry.find(name, source.path.parent)


def read_number(value: object, source: Source, keys: KeyPath, unit: str = "") -> float:
    """Return a value as a number if it is a finite one, else raise InputError."""
    if not is_finite_number(value):
        in_unit = f" in {unit}" if unit else ""
        raise source.error(keys, f"{value!r} is not permitted; it must be a finite number{in_unit}")
    return float(value)


def read_whole(value: object, source: Source, keys: KeyPath, low: int, high: int) -> int:
    """Return a value if it is a whole number between two others, else raise InputError."""
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        problem = f"{value!r} is not permitted; it must be a whole number of at least {low} and at most {high}"
        raise source.error(keys, f"{problem}{_sweep_hint(value, keys)}")
    return value


def is_finite_number(value: object) -> TypeGuard[float]:
    """Return whether a value is a finite number; a truth value is none."""
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _find_infinite(value: object, source: Source, keys: KeyPath) -> Iterator[tuple[KeyPath, InputError]]:
    """Yield the place of each number that is infinite or not a number, and its error."""
    if isinstance(value, float):
        if not math.isfinite(value):
            yield keys, source.error(keys, f"{value} is not permitted; it must be a finite number")
    elif isinstance(value, Mapping | list):
        for key, item in value.items() if isinstance(value, Mapping) else enumerate(value):
            yield from _find_infinite(item, source, (*keys, key))


_BOUNDS = {"greater_than_equal": ("at least", "ge"), "less_than_equal": ("at most", "le")}
_BOUNDS |= {"greater_than": ("greater than", "gt"), "less_than": ("less than", "lt")}
"""What pydantic calls a bound that is not met: its words, and where the bound stands."""


def _problem(record: type, error: ErrorDetails) -> str:
    """Translate pydantic's finding into what is wrong, what is permitted, and in which unit."""
    context, value = error.get("ctx") or {}, _shown(error["input"])
    name = error["loc"][0] if error["loc"] else ""
    field = next((specification for specification in describe(record) if specification.name == name), None)
    unit = field.unit if field else ""
    suffix = f" {unit}" if unit and unit != "-" else ""
    meant = guess(error["input"], field) if field else ""
    if error["type"] in _BOUNDS:
        word, bound = _BOUNDS[error["type"]]
        return f"{value} is not permitted; it must be {word} {context[bound]:g}{suffix}{meant}"
    if error["type"] == "missing":
        return "this key is missing"
    if error["type"] == "literal_error":
        options = [part.strip("' ") for part in str(context["expected"]).replace(" or ", ", ").split(",")]
        return f"{value} is not permitted{permit(error['input'], options)}"
    if error["type"] == "tuple_type":
        return f"{value} is not permitted; it must be a list, such as [{error['input']}]"
    if error["type"].startswith(("float", "int", "finite")):
        return f"{value} is not permitted; it must be a finite number{f' in {unit}' if suffix else ''}"
    return f"{value} is not permitted: {error['msg'][0].lower()}{error['msg'][1:]}"


def _shown(value: object) -> str:
    return cut(f"'{value}'" if isinstance(value, str) else str(list(value) if isinstance(value, tuple) else value))


def _tuples(value: object) -> object:
    """Return the value with lists as tuples, which strict validation of records asks for."""
    if isinstance(value, list | tuple):
        return tuple(_tuples(item) for item in value)
    if isinstance(value, float) or not isinstance(value, Mapping):
        return value
    return {key: _tuples(item) for key, item in value.items()}
