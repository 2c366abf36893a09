"""What can stand in a scenario: names by kind, and the keys of each with unit, default and bounds."""

from __future__ import annotations

import inspect
from collections.abc import Iterable
from typing import NamedTuple

from seatsim.dampers.base import CONFIDENCE, DamperSpecification, find_confidence
from seatsim.scenario.sections import RECORDS
from seatsim.schema import registry
from seatsim.schema.errors import InputError, nearest
from seatsim.schema.fields import FieldSpecification
from seatsim.schema.fields import describe as fields_of
from seatsim.schema.text import split_source

KINDS = ("damper", "law", "excitation", "effect")


class Page(NamedTuple):
    """What is known of one name; `own` where it is not part of seatsim, `facts` are lines on a damper."""

    name: str
    kind: str
    title: str
    text: str
    source: str
    own: bool
    facts: list[str]
    keys: list[FieldSpecification]


class Pages(NamedTuple):
    """All names, or the one that was asked for."""

    names: list[Page]


def describe(name: str = "") -> str:
    """Return the list of all names, a line for each, or the page of one.

    Raises:
        InputError: nothing has that name.
    """
    return _format_page(find_page(name)) if name else _format_list(list_pages())


def name_model(name: str) -> str:
    """Return what a damper model is called in words, without what stands behind a colon; the name of an unknown one."""
    return find_page(name).title.partition(": ")[0] if name in registry.names("damper") else name


def list_pages() -> list[Page]:
    """Return what is known of every name, by kind."""
    named = [_make_page(name, kind) for kind in KINDS for name in registry.names(kind)]
    return [*named, *(_make_page(name, "section") for name in RECORDS)]


def find_page(name: str) -> Page:
    """Return what is known of a name.

    Raises:
        InputError: nothing has that name.
    """
    kind = next((kind for kind in KINDS if name in registry.names(kind)), "section")
    if kind == "section" and name not in RECORDS:
        known = [known for kind in KINDS for known in registry.names(kind)] + list(RECORDS)
        raise InputError(f"nothing is called '{name}'{nearest(name, known)}; 'seatsim describe' lists all names")
    return _make_page(name, kind)


def _make_page(name: str, kind: str) -> Page:
    cls: type = RECORDS[name] if kind == "section" else registry.find(kind, name)
    text, specification = inspect.getdoc(cls) or "", None if kind == "section" else registry.specification_of(cls)
    facts = list(_state_facts(cls, specification)) if isinstance(specification, DamperSpecification) else []
    source = specification.source if specification else ""
    text = split_source(text)[0] if source else text
    title = " ".join(text.partition("\n\n")[0].partition(": `")[0].split()).rstrip(".")
    # What the fields of such a damper have as default is where its fit starts.
    is_stated = isinstance(specification, DamperSpecification) and specification.complete
    keys = [field._replace(required=field.required or is_stated) for field in fields_of(cls)]
    return Page(name, kind, title, text, source, registry.is_own(cls), facts, keys)


def _state_facts(cls: type, specification: DamperSpecification) -> Iterable[str]:
    low, high = specification.temperatures
    speed, current = specification.max_speed, specification.max_current
    yield f"Range of the data: |v| <= {speed:g} m/s, 0 to {current:g} A, {low:g} to {high:g} degC"
    if specification.state:
        yield f"State: {specification.state}"
    yield f"Confidence: {find_confidence(cls)}; {CONFIDENCE[find_confidence(cls)]}"
    if specification.fixed:
        yield f"Not fitted by an identification: {', '.join(specification.fixed)}"


def _format_list(pages: list[Page]) -> str:
    wide = max(len(page.name) for page in pages)
    lines = []
    for kind in (*KINDS, "section"):
        of_kind = [page for page in pages if page.kind == kind]
        named = (f"  {page.name:{wide}}  {'(own) ' * page.own}{page.title}".rstrip() for page in of_kind)
        lines += [f"{kind}s", *named, ""]
    return "\n".join([*lines, "seatsim describe NAME shows the keys of one."])


def _format_page(page: Page) -> str:
    lines = [f"{page.name} ({page.kind}{', own' * page.own})", "", page.text]
    lines += ["", f"Source: {page.source}"] if page.source else []
    return "\n".join([*lines, *page.facts, "", "Keys:", *map(_line, page.keys)])


def _line(field: FieldSpecification) -> str:
    unit = f" [{field.unit}]" if field.unit else ""
    if not field.required:
        stated = f"default {_shown(field.default)}"
    else:
        stated = "required" if field.default is None else f"required; a fit starts from {_shown(field.default)}"
    return f"  {field.name}{unit}: {field.meaning} ({stated})"


def _shown(value: object) -> str:
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, tuple) and all(isinstance(item, float) for item in value):
        return f"[{', '.join(f'{item:g}' for item in value)}]"
    return str(value)
