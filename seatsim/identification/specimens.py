"""Several specimens of one damper: how much their fitted values differ."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from seatsim.identification.identify import Identification
from seatsim.schema.content import Unwritten
from seatsim.schema.errors import InputError
from seatsim.schema.yaml_source import Source


class Specimens(NamedTuple):
    """The content of `specimens.yaml`: the values of each specimen by keys of a scenario, which a sweep takes together.

    Keys are those in which the specimens differ, such as `damper.parameters.c_a`; `standard_deviation` is that of a
    sample. damper: the damper with the mean values and its coil, as a scenario has them.
    """

    model: str
    specimens: dict[str, dict[str, float]]
    mean: dict[str, float]
    standard_deviation: dict[str, float]
    damper: Unwritten[dict[str, object]]


def gather_specimens(found: Mapping[str, Identification]) -> Specimens:
    """Return what the identifications of two specimens or more, by their names, have in common and how they differ.

    Raises:
        InputError: the influence of temperature was fitted to some of them only, or all are the same.
    """
    contents = {name: {**each.to_scenario()} for name, each in found.items()}
    for content in contents.values():
        del content["bench"]
    values = {name: dict(_list_numbers(content)) for name, content in contents.items()}
    first, *others = values
    for name in others:
        if set(values[name]) != set(values[first]):
            problem = "the temperature matters in the records of only one of them: add --ignore-temperature"
            raise InputError(f"{first} and {name} have other parameters; {problem}")
    keys = [key for key in values[first] if len({each[key] for each in values.values()}) > 1]
    if not keys:
        raise InputError(f"{first} and {', '.join(others)} do not differ; name folders of different specimens")
    table = np.array([[each[key] for key in keys] for each in values.values()])
    mean, deviation = (dict(zip(keys, map(float, y), strict=True)) for y in (table.mean(0), table.std(0, ddof=1)))
    middle = Source.of(contents[first])
    for key, value in mean.items():
        middle.put(key, value, first)
    each = {name: {key: own[key] for key in keys} for name, own in values.items()}
    return Specimens(found[first].model, each, mean, deviation, middle.data)


def _list_numbers(content: object, key: str = "") -> Iterator[tuple[str, float]]:
    """Yield the numbers of nested mappings and lists by their dotted keys."""
    if isinstance(content, Mapping | list):
        for name, value in content.items() if isinstance(content, Mapping) else enumerate(content):
            yield from _list_numbers(value, f"{key}.{name}" if key else str(name))
    elif isinstance(content, int | float):
        yield key, float(content)
