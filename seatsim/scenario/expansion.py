"""One scenario file, several runs: variants, sweeps and settings from the command line.

    variants: {passive: {controller: {law: constant, current: 0.0}}, hot: {temperature: 80.0}}
    sweep: {plant.driver_mass: [55, 75, 98, 120]}

A variant replaces values by dotted key; a sweep runs every value of its list, all its keys in every combination. A list
under `temperature` is a sweep as well.
"""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterator, Mapping

from seatsim.schema.validation import mapping
from seatsim.schema.yaml_source import Source
from seatsim.schema.yaml_text import KeyPath

MOST_RUNS = 10_000
"""Runs of one scenario file, whose histories are all held at once."""


def expand(source: Source, settings: Mapping[str, object]) -> Iterator[tuple[Source, dict[str, object]]]:
    """Yield the content of every run with the label that sets it apart."""
    base = source.with_changes()
    for key, value in settings.items():
        base.put(key, value, _place_of_setting(key, value))
    variants = mapping(base.data.pop("variants", {}), base, ("variants",))
    stated = mapping(base.data.pop("sweep", {}), base, ("sweep",))
    sweep = dict(stated)
    if isinstance(base.data.get("temperature"), list):
        sweep["temperature"] = base.data["temperature"]
    lists = {key: _swept_values(values, base, key) for key, values in sweep.items()}
    runs = math.prod(map(len, lists.values())) * max(len(variants), 1)
    if runs > MOST_RUNS:
        raise base.error(
            ("sweep",), f"makes {runs} runs; a scenario has at most {MOST_RUNS}, and 'seatsim sweep' takes more"
        )
    for name, changes in variants.items() or [(None, {})]:
        for chosen in itertools.product(*lists.values()):
            run = base.with_changes()
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


def _place_of_setting(dotted: str, value: object) -> str:
    """Return the place of a value that an option states: that option, not a line of the file."""
    shown = value if isinstance(value, str) else json.dumps(value, default=str)
    return f"--set {dotted}={shown if len(shown) <= 60 else shown[:57] + '...'}"


def _replace(source: Source, dotted: str, value: object, origin: KeyPath) -> None:
    """Put a value under a dotted key; its place is then that of the variant, by name, or sweep it comes from."""
    stated = (*origin, dotted)
    name = f", variant '{origin[1]}'" if origin[:1] == ("variants",) else ""
    inner = [(known[len(stated) :], at + name) for known, at in source.places.items() if known[: len(stated)] == stated]
    source.put(str(dotted), value, source.nearest_place(stated) + name)
    keys = tuple(str(dotted).split("."))
    source.places.update({(*keys, *rest): at for rest, at in inner})
