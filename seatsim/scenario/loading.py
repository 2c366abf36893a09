"""From a scenario file to scenarios: one for each variant and each value of a sweep.

    variants: {passive: {controller: {law: constant, current: 0.0}}, hot: {temperature: 80.0}}
    sweep: {plant.driver_mass: [55, 75, 98, 120]}

A variant replaces values by dotted key; a sweep runs every value of its list, all its keys in every combination. A list
under `temperature` is a sweep as well. A file is at its path, or among the examples that ship with seatsim.
"""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from seatsim.scenario.checks import require_variants
from seatsim.scenario.scenario import Scenario
from seatsim.scenario.sections import NEEDED, NEEDED_BY_A_SEAT, OF_ALL_RUNS, SECTIONS
from seatsim.schema.errors import InputError, gathered, nearest, permit, raise_all
from seatsim.schema.guarded import is_there
from seatsim.schema.text import cut, join_names
from seatsim.schema.validation import check_keys, mapping
from seatsim.schema.yaml_source import Source
from seatsim.schema.yaml_text import KeyPath

_MOST_RUNS = 10_000
"""Runs of one scenario file, whose histories are all held at once."""


def expand(source: Source, settings: Mapping[str, object]) -> Iterator[tuple[Source, dict[str, object]]]:
    """Yield the content of every run with the label that sets it apart."""
    base = source.with_changes()
    for key, value in settings.items():
        stated_as = value if isinstance(value, str) else json.dumps(value, default=str)
        # That option, not a line of the file.
        base.put(key, value, f"--set {key}={cut(stated_as)}")
    variants = mapping(base.data.pop("variants", {}), base, ("variants",))
    stated = mapping(base.data.pop("sweep", {}), base, ("sweep",))
    sweep = dict(stated)
    if isinstance(base.data.get("temperature"), list):
        sweep["temperature"] = base.data["temperature"]
    lists = {key: _swept_values(values, base, key) for key, values in sweep.items()}
    runs = math.prod(map(len, lists.values())) * max(len(variants), 1)
    if runs > _MOST_RUNS:
        problem = f"makes {runs} runs; a scenario has at most {_MOST_RUNS}, and 'seatsim sweep' takes more"
        raise base.error(("sweep",), problem)
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


def _replace(source: Source, dotted: str, value: object, origin: KeyPath) -> None:
    """Put a value under a dotted key; its place is then that of the variant, by name, or sweep it comes from."""
    stated = (*origin, dotted)
    name = f", variant '{origin[1]}'" if origin[:1] == ("variants",) else ""
    inner = [(known[len(stated) :], at + name) for known, at in source.places.items() if known[: len(stated)] == stated]
    source.put(str(dotted), value, source.nearest_place(stated) + name)
    keys = tuple(str(dotted).split("."))
    source.places.update({(*keys, *rest): at for rest, at in inner})


EXAMPLES = (Path(__file__).parents[1] / "examples", Path(__file__).parents[2] / "scenarios")
"""The examples: within an installed package, or beside the package in a clone."""


def find_file(path: Path) -> Path:
    """Return the path of a scenario file, or of the example that has this name.

    Raises:
        InputError: there is neither.
    """
    if is_there(path):
        return path
    if not path.is_absolute():
        inside = Path(*path.parts[1:]) if path.parts[:1] == ("scenarios",) else path
        names = (inside, inside.with_name(f"{inside.name}.yaml"))
        for file in filter(is_there, (folder / name for folder in EXAMPLES for name in names)):
            return file
    known = list_examples()
    near = nearest(path, [*known, *(str(file) for file in path.parent.glob("*.yaml"))])
    raise InputError(f"{path}: no such file{near}; give the path of a scenario, or an example: {', '.join(known)}")


def list_examples() -> list[str]:
    """Return the names of the examples, sorted."""
    found = {path.relative_to(folder) for folder in EXAMPLES if folder.is_dir() for path in folder.rglob("*.yaml")}
    return sorted(str(path.with_suffix("")) for path in found if "data" not in path.parts)


_MOST_ERRORS = 20
"""Runs of a file of which it is said what is wrong with them."""
_WHOLE = ("plant", *NEEDED, "controller", "excitation")


def load(scenario: str | Path | Mapping[str, object], settings: Mapping[str, object] | None = None) -> list[Scenario]:
    """Return the scenarios of a file, or of a mapping with the keys of one, at least one.

    `settings` replaces values by dotted key, such as `{"plant.driver_mass": 55.0}`. A path that does not exist is
    looked up among the examples that come with seatsim.

    Raises:
        InputError: anything in the file is missing, unknown or not permitted; its notes say what else is.
    """
    source = Source.of(scenario) if isinstance(scenario, Mapping) else Source(find_file(Path(scenario)))
    if {"scenario", "vary"} <= set(source.data):
        problem = f"this file is a sweep of a scenario; simulate it with 'seatsim sweep {source.path}'"
        raise source.error(("vary",), problem)
    scenarios, errors = list[Scenario](), list[InputError]()
    for content, label in expand(source, settings or {}):
        with gathered(errors):
            scenarios.append(read_scenario(content, label))
        if len(errors) == _MOST_ERRORS:
            break
    raise_all(errors)
    # A setting may leave the variants of the file out.
    variants = {**mapping(source.data.get("variants", {}), source, ("variants",))}
    variants |= {one.label["variant"]: None for one in scenarios if "variant" in one.label}
    require_variants(scenarios[0].checks, variants, source)
    return scenarios


def single(scenario: str | Path | Mapping[str, object], settings: Mapping[str, object] | None = None) -> Scenario:
    """Load a file that holds one run."""
    scenarios = load(scenario, settings)
    if len(scenarios) != 1:
        raise InputError(f"{scenario}: holds {len(scenarios)} runs; this command takes one, without sweep or variants")
    return scenarios[0]


def read_scenario(source: Source, label: Mapping[str, object]) -> Scenario:
    """Return the scenario that a source states, without `variants` and `sweep`; `label` sets its run apart.

    Raises:
        InputError: anything in it is missing, unknown or not permitted.
    """
    data, errors = source.data, list[InputError]()
    with gathered(errors):
        check_keys(data, (*SECTIONS, *OF_ALL_RUNS), source, ())
    for key in NEEDED + (NEEDED_BY_A_SEAT if set(NEEDED_BY_A_SEAT) & set(data) else ()):
        if key not in data:
            errors.append(source.error((), f"key '{key}' is missing; a scenario has {join_names(_WHOLE)}"))
    found = _read(source, [key for key in SECTIONS if key in data], errors)
    raise_all(errors)
    return Scenario(**{"name": source.path.stem} | found, label=label, source=source)


def reread(scenario: Scenario, sections: Iterable[str], source: Source, label: Mapping[str, object]) -> Scenario:
    """Return a scenario of which some sections, such as `plant`, are read anew from a source.

    Raises:
        InputError: a value in one of the sections is not permitted, or no section has this name.
    """
    errors = [source.error((key,), f"unknown key{permit(key, SECTIONS)}") for key in sections if key not in SECTIONS]
    found = _read(source, [key for key in sections if key in SECTIONS], errors)
    raise_all(errors)
    return replace(scenario, label=label, source=source, **found)


def _read(source: Source, sections: Iterable[str], errors: list[InputError]) -> dict[str, Any]:
    """Return what was read of each section by the field of a scenario that holds it; what is wrong joins the errors."""
    found: dict[str, Any] = {}
    for key in sections:
        with gathered(errors):
            found[SECTIONS[key].field or key] = SECTIONS[key].read(source.data[key], source)
    return found
