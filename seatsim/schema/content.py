"""What a record is as JSON: the one statement from which files, `--json` and its JSON Schema are made.

A record is a `typing.NamedTuple` or a frozen dataclass. Its fields are written under their names, and its properties
that are marked by `written`. The annotation of a field says where it is written in another way:

    class Line(NamedTuple):
        passed: Annotated[bool, Form(key="pass")]
        force: Annotated[float, Form(unit="N")]   # `force_N`
        history: Unwritten[Array]
        dose: Joined[Dose]                        # its fields stand among those of the line
        note: IfAny[str]                          # not written where it is empty

        @property
        @written()
        def method(self) -> str: ...
"""

from __future__ import annotations

import dataclasses
import html
import math
from collections.abc import Callable, Mapping, Sized
from functools import cache
from pathlib import PurePath
from typing import Annotated, NamedTuple, TypeGuard, TypeVar, get_args, get_origin, get_type_hints

_T = TypeVar("_T")
F = TypeVar("F", bound=Callable[..., object])


class Form(NamedTuple):
    """How a field is written, where that is not under its own name and as it is.

    key: its name in JSON. unit: ends its name there. file: the field is the content of a file, and is written as its
    name. left_out: it is not written. joined: its fields are written beside those of its record. if_any: it is not
    written where it is None or empty.
    """

    key: str = ""
    unit: str = ""
    file: str = ""
    left_out: bool = False
    joined: bool = False
    if_any: bool = False


Unwritten = Annotated[_T, Form(left_out=True)]
Joined = Annotated[_T, Form(joined=True)]
IfAny = Annotated[_T, Form(if_any=True)]


class _WrittenField(NamedTuple):
    """A field or property as it is written: its name in Python and in JSON, its form, and its type."""

    name: str
    key: str
    form: Form
    hint: object


def written(key: str = "", *, joined: bool = False, if_any: bool = False) -> Callable[[F], F]:
    """Mark the function of a property, which is then written like a field (see `Form`)."""

    def mark(function: F) -> F:
        vars(function)["form"] = Form(key, joined=joined, if_any=if_any)
        return function

    return mark


def is_record(kind: object) -> TypeGuard[type]:
    """Whether a class is that of records."""
    return isinstance(kind, type) and (hasattr(kind, "_fields") or dataclasses.is_dataclass(kind))


@cache
def list_written(record: type) -> tuple[_WrittenField, ...]:
    """Return what is written of the records of a class: its fields in order, then its marked properties."""
    hints = get_type_hints(record, include_extras=True)
    found = []
    for name in getattr(record, "_fields", None) or [field.name for field in dataclasses.fields(record)]:
        form = next((mark for mark in get_args(hints[name]) if isinstance(mark, Form)), Form())
        if not form.left_out:
            key = form.key or (f"{name}_{form.unit}" if form.unit else name)
            found.append(_WrittenField(name, key, form, str if form.file else hints[name]))
    for name, value in ((name, value) for kind in reversed(record.__mro__) for name, value in vars(kind).items()):
        if isinstance(value, property) and value.fget and "form" in vars(value.fget):
            form = vars(value.fget)["form"]
            hint = get_type_hints(value.fget, include_extras=True)["return"]
            found.append(_WrittenField(name, form.key or name, form, hint))
    return tuple(found)


def find_record(hint: object) -> type | None:
    """Return the record class that a type is or may be, None for the types of other values."""
    if get_origin(hint) is Annotated:
        return find_record(get_args(hint)[0])
    return next((kind for kind in (hint, *get_args(hint)) if is_record(kind)), None)


def plain(value: object) -> object:
    """Return nested values as JSON has them: a record is an object; what is no finite number is null."""
    import numpy as np  # takes longer to load than the commands that check their options

    if is_record(type(value)) or isinstance(value, Mapping):
        return to_content(value)
    if isinstance(value, list | tuple | np.ndarray):
        return [plain(item) for item in value]
    if isinstance(value, float | np.floating):
        return float(value) if math.isfinite(value) else None
    if isinstance(value, PurePath):
        return str(value)
    return value.item() if isinstance(value, np.generic) else value


def to_content(record: object) -> dict[str, object]:
    """Return what a record, or a mapping, is as JSON, an object."""
    if isinstance(record, Mapping):
        return {str(key): plain(value) for key, value in record.items()}
    content: dict[str, object] = {}
    kind: type = type(record)
    for field in list_written(kind):
        value = getattr(record, field.name)
        if field.form.joined:
            joined = find_record(field.hint) if value is None else None
            content |= dict.fromkeys(each.key for each in list_written(joined)) if joined else to_content(value)
        elif not (field.form.if_any and (value is None or (isinstance(value, Sized) and not len(value)))):
            content[field.key] = field.form.file if field.form.file and value is not None else plain(value)
    return content


_SHOWN = 12
"""Rows of a list of records that are shown: the first ones are those that matter."""


def show_record(record: object, *keys: str) -> str:
    """Return in HTML what a record is as JSON, or some keys of it: its values, then each list of records as a table.

    Keys of what lies deeper have dots; of the records in a list their single values are shown. Numbers are rounded to
    four digits.
    """
    import pandas as pd

    content = to_content(record)
    # Of objects: a whole number is not to become a float beside one that is absent.
    flat = pd.json_normalize({key: content[key] for key in keys or content}).astype(object).iloc[0]
    is_table = flat.map(lambda value: isinstance(value, list) and any(isinstance(row, dict) for row in value))
    values = flat[~is_table].map(_say).to_frame()
    with pd.option_context("display.max_colwidth", None):
        shown = [values.to_html(header=False, border=0)]
        for key, rows in flat[is_table].items():
            single = [{name: cell for name, cell in row.items() if not isinstance(cell, dict)} for row in rows[:_SHOWN]]
            table = pd.DataFrame(single, dtype=object).map(_say).to_html(index=False, border=0)
            shown.append(f"<p>{html.escape(str(key))}</p>{table}")
    return "".join(shown)


def _say(value: object) -> str:
    if isinstance(value, list):
        return ", ".join(map(_say, value))
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return ""
    return f"{value:.4g}" if isinstance(value, float) else str(value)
