"""One scenario file, several runs: variants, sweeps and settings from the command line.

    variants: {passive: {controller: {law: constant, current: 0.0}}, hot: {temperature: 80.0}}
    sweep: {plant.driver_mass: [55, 75, 98, 120]}

A variant replaces values by dotted key; a sweep runs every value of its list, all its keys in every combination. A list
under `temperature` is a sweep as well.
"""

from __future__ import annotations

import copy
import itertools
import json
from collections.abc import Iterator, Mapping

from seatsim.schema.errors import InputError, nearest
from seatsim.schema.validation import mapping
from seatsim.schema.yaml_source import KeyPath, Source


def expand(source: Source, settings: Mapping[str, object]) -> Iterator[tuple[Source, dict[str, object]]]:
    """Yield the content of every run with the label that sets it apart."""
    base = copy.deepcopy(source)
    for key, value in settings.items():
        _set(base, key, value)
    variants = mapping(base.data.pop("variants", {}), base, ("variants",))
    stated = mapping(base.data.pop("sweep", {}), base, ("sweep",))
    sweep = dict(stated)
    if isinstance(base.data.get("temperature"), list):
        sweep["temperature"] = base.data["temperature"]
    lists = {key: _swept_values(values, base, key) for key, values in sweep.items()}
    for name, changes in variants.items() or [(None, {})]:
        for chosen in itertools.product(*lists.values()):
            run = copy.deepcopy(base)
            for key, value in mapping(changes, base, ("variants", str(name))).items():
                _replace(run, key, value, ("variants", str(name)))
            swept = dict(zip(lists, chosen, strict=True))
            for key, value in swept.items():
                # A list under `temperature` stands where it is.
                _replace(run, key, value, ("sweep",) if key in stated else ())
            yield run, ({} if name is None else {"variant": name}) | swept


def _swept_values(values: object, source: Source, key: str) -> list[object]:
    if not isinstance(values, list) or not values:
        raise source.error(("sweep", key), "a sweep is a list of at least one value, such as [20, 50, 80]")
    return values


def _set(source: Source, dotted: str, value: object) -> None:
    """Put a value that an option states under a dotted key; its place is then that option, not a line of the file."""
    shown = value if isinstance(value, str) else json.dumps(value, default=str)
    # Where a value leads into one without keys, the option is the place as well.
    source.places[("--set", dotted)] = f"--set {dotted}={shown if len(shown) <= 60 else shown[:57] + '...'}"
    _replace(source, dotted, value, ("--set",))
    del source.places[("--set", dotted)]


def _replace(source: Source, dotted: str, value: object, origin: KeyPath) -> None:
    """Put a value under a dotted key; its place is then that of the variant, sweep or option it comes from."""
    keys = tuple(str(dotted).split("."))
    place = source.nearest_place((*origin, dotted))
    node = source.data
    for key in keys[:-1]:
        below = node.setdefault(key, {})
        if not isinstance(below, dict):
            raise InputError(f"{place}: '{dotted}' leads into '{key}', which has no keys{nearest(key, node)}")
        node = below
    node[keys[-1]] = value
    for known in [known for known in source.places if known[: len(keys)] == keys]:
        del source.places[known]
    source.places[keys] = place
    for known, at in list(source.places.items()):
        if known[: len(origin) + 1] == (*origin, dotted):
            source.places[(*keys, *known[len(origin) + 1 :])] = at
