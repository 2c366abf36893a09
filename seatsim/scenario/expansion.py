"""One scenario file, several runs: variants, sweeps and settings from the command line.

    variants: {passive: {controller: {law: constant, current: 0.0}}, hot: {temperature: 80.0}}
    sweep: {plant.driver_mass: [55, 75, 98, 120]}

A variant replaces values by dotted key; a sweep runs every value of its list, all its keys in every combination. A list
under `temperature` is a sweep as well.
"""

from __future__ import annotations

import copy
import itertools
from collections.abc import Iterator, Mapping

from seatsim.schema.errors import nearest
from seatsim.schema.validation import mapping
from seatsim.schema.yaml_source import KeyPath, Source


def expand(source: Source, settings: Mapping[str, object]) -> Iterator[tuple[Source, dict[str, object]]]:
    """Yield the content of every run with the label that sets it apart."""
    base = copy.deepcopy(source)
    for key, value in settings.items():
        _replace(base, key, value, ())
    variants = mapping(base.data.pop("variants", {}), base, ("variants",))
    sweep = dict(mapping(base.data.pop("sweep", {}), base, ("sweep",)))
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
                _replace(run, key, value, ("sweep",))
            yield run, ({} if name is None else {"variant": name}) | swept


def _swept_values(values: object, source: Source, key: str) -> list[object]:
    if not isinstance(values, list) or not values:
        raise source.error(("sweep", key), "a sweep is a list of at least one value, such as [20, 50, 80]")
    return values


def _replace(source: Source, dotted: str, value: object, origin: KeyPath) -> None:
    """Put a value under a dotted key; its place in the file is then that of the variant or sweep it comes from."""
    keys = tuple(str(dotted).split("."))
    node = source.data
    for depth, key in enumerate(keys[:-1]):
        below = node.setdefault(key, {})
        if not isinstance(below, dict):
            raise source.error(keys[: depth + 1], f"'{dotted}' leads into a value that has no keys{nearest(key, node)}")
        node = below
    node[keys[-1]] = value
    line = source.lines.get((*origin, dotted), source.lines.get(origin, 1))
    for known in [known for known in source.lines if known[: len(keys)] == keys]:
        del source.lines[known]
    source.lines[keys] = line
    for known, at in list(source.lines.items()):
        if known[: len(origin) + 1] == (*origin, dotted):
            source.lines[(*keys, *known[len(origin) + 1 :])] = at
