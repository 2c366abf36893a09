"""From a scenario file to scenarios: one for each variant and each value of a sweep."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from seatsim.effects.base import EFFECTS
from seatsim.rig.coil import Coil
from seatsim.rig.control import LAWS, Law
from seatsim.rig.drivers import Driver
from seatsim.rig.plant import Plant
from seatsim.rig.sensors import Sensors
from seatsim.rig.temperature import Thermal
from seatsim.scenario.checks import read_checks, require_variants
from seatsim.scenario.damper import stated_damper
from seatsim.scenario.expansion import expand
from seatsim.scenario.finding import find_file
from seatsim.scenario.published import check_published
from seatsim.scenario.scenario import Control, DamperChoice, Inverse, Scenario, Solver, Start
from seatsim.schema.errors import InputError, nearest
from seatsim.schema.registry import Record, Registry
from seatsim.schema.text import explain_bad_name
from seatsim.schema.validation import build, check_keys, chosen_class, is_finite_number, mapping, sweep_hint
from seatsim.schema.yaml_source import Source
from seatsim.schema.yaml_text import KeyPath

if TYPE_CHECKING:
    from seatsim.excitations.base import Excitation

LARGEST_SEED = 2**63 - 1
"""The largest whole number that a column of a table holds."""
BENCH_KEYS = ("name", "seed", "damper", "actuator", "temperature", "effects", "solver")
SEAT_KEYS = (
    *BENCH_KEYS,
    "plant",
    "driver",
    "controller",
    "excitation",
    "start",
    "sweep",
    "variants",
    "published",
    "checks",
)
FILES = (("controller", "design"), ("excitation", "path"))
"""Section and key under which a scenario names a file, from its own folder."""
CONTROL_KEYS = ("law", "sample_time", "inverse", "sensors")
# An excitation may read a recording, whose nominal is a scenario: their package builds on this one.
EXCITATIONS: Registry[Excitation, object] = Registry("excitation")


def load(path: str | Path, settings: Mapping[str, object] | None = None) -> list[Scenario]:
    """Return the scenarios of a file, at least one.

    `settings` replaces values by dotted key, such as `{"plant.driver_mass": 55.0}`. A path that does not exist is
    looked up among the examples that come with seatsim.

    Raises:
        InputError: anything in the file is missing, unknown or not permitted.
    """
    source = Source(find_file(Path(path)))
    if {"scenario", "vary"} <= set(source.data):
        raise source.error(("vary",), f"this file is a sweep of a scenario; simulate it with 'seatsim sweep {path}'")
    scenarios = [read_scenario(variant, label) for variant, label in expand(source, settings or {})]
    variants = {one.label["variant"]: None for one in scenarios if "variant" in one.label}
    require_variants(scenarios[0].checks, variants, source)
    return scenarios


def single(path: str | Path, settings: Mapping[str, object] | None = None) -> Scenario:
    """Load a file that holds one run."""
    scenarios = load(path, settings)
    if len(scenarios) != 1:
        raise InputError(f"{path}: holds {len(scenarios)} runs; this command takes one, without sweep or variants")
    return scenarios[0]


def read_scenario(source: Source, label: Mapping[str, object]) -> Scenario:
    """Return the scenario that a source states, without `variants` and `sweep`; `label` sets its run apart.

    Raises:
        InputError: anything in it is missing, unknown or not permitted.
    """
    data = source.data
    check_keys(data, SEAT_KEYS, source, ())
    bench = not {"plant", "controller", "excitation"} & set(data)
    if "published" in data:
        check_published(source, list(label))
    for key in ("damper", "actuator", "temperature") + (() if bench else ("plant", "controller", "excitation")):
        if key not in data:
            raise source.error((), f"key '{key}' is missing; a scenario has plant, damper, actuator, temperature,"
                                   " controller and excitation")  # fmt: skip
    sections = {section: read(data[section], source) for section, read in _READERS.items() if section in data}
    name = _name(data, source)
    return Scenario(name=name, label=label, source=source, **_by_field(sections))


def _name(data: Mapping[str, object], source: Source) -> str:
    """Return the name of a scenario, which its folder of results has."""
    name = data.get("name", source.path.stem)
    if isinstance(name, dict | list) or name is None:
        raise source.error(("name",), f"{name!r} is no name; write it as text")
    problem = explain_bad_name(str(name)) if "name" in data else ""
    if problem:
        raise source.error(("name",), f"{str(name)!r} {problem}")
    return str(name)


def reread(scenario: Scenario, sections: Iterable[str], source: Source, label: Mapping[str, object]) -> Scenario:
    """Return a scenario of which some sections, such as `plant`, are read anew from a source.

    Raises:
        InputError: a value in one of the sections is not permitted, or no section has this name.
    """
    for section in sections:
        if section not in _READERS:
            raise source.error((section,), f"unknown key{nearest(section, _READERS)}; permitted: {', '.join(_READERS)}")
    changed = {section: _READERS[section](source.data[section], source) for section in sections}
    return replace(scenario, label=label, source=source, **_by_field(changed))


def _by_field(sections: Mapping[str, object]) -> dict[str, Any]:
    """Return what was read of each section by the field of a scenario that holds it."""
    return {_FIELDS.get(section, section): value for section, value in sections.items()}


def _damper(values: object, source: Source, keys: KeyPath, extra: tuple[str, ...] = ()) -> DamperChoice:
    return DamperChoice(*stated_damper(values, source, keys, extra))


def _temperature(value: object, source: Source) -> float | Thermal:
    if isinstance(value, Mapping):
        return build(Thermal, value, source, ("temperature",))
    return float(build(Thermal, {"start": value}, source, ("temperature",)).start)


def _control(values: object, source: Source) -> Control:
    keys: KeyPath = ("controller",)
    stated = mapping(values, source, keys)
    cls = chosen_class(LAWS, stated, "law", source, keys)
    own = {key: value for key, value in stated.items() if key not in CONTROL_KEYS}
    _resolve_path(own, "design", source)
    inverse = _inverse(stated["inverse"], source) if "inverse" in stated else None
    sensors = build(Sensors, stated["sensors"], source, (*keys, "sensors")) if "sensors" in stated else None
    sample_time = stated.get("sample_time")
    # What is registered as a law has one of the methods of `Law`: its decorator is applied to nothing else.
    law = cast("Law", build(cls, own, source, keys))
    if sample_time is None:
        return Control(law, None, inverse, sensors)
    if not (is_finite_number(sample_time) and 0 < sample_time <= 1):
        raise source.error(
            (*keys, "sample_time"),
            f"{sample_time!r} is not permitted; it must be 0 to 1 s{sweep_hint(sample_time, (*keys, 'sample_time'))}",
        )
    return Control(law, sample_time, inverse, sensors)


def _inverse(values: object, source: Source) -> Inverse:
    keys: KeyPath = ("controller", "inverse")
    damper = _damper(values, source, keys, extra=("temperature",))
    temperature = mapping(values, source, keys).get("temperature", "measured")
    if temperature == "measured":
        return Inverse(damper, None)
    if not is_finite_number(temperature):
        raise source.error((*keys, "temperature"), f"{temperature!r} is not permitted; a number in degC or 'measured'")
    return Inverse(damper, float(temperature))


def _resolve_path(own: dict[str, object], key: str, source: Source) -> None:
    """Take a file that is named under a key from the folder of the scenario."""
    name = own.get(key)
    if isinstance(name, str):
        own[key] = str(source.path.parent / name)


def _excitation(values: object, source: Source) -> Excitation:
    keys: KeyPath = ("excitation",)
    stated = mapping(values, source, keys)
    cls = chosen_class(EXCITATIONS, stated, "kind", source, keys)
    own = {key: value for key, value in stated.items() if key != "kind"}
    _resolve_path(own, "path", source)
    return build(cls, own, source, keys)


def _effects(values: object, source: Source) -> tuple[Record, ...]:
    if not isinstance(values, list):
        raise source.error(("effects",), f"{values!r} is not a list; write '- effect: NAME' below it")
    effects: list[Record] = []
    for index, value in enumerate(values):
        keys: KeyPath = ("effects", index)
        stated = mapping(value, source, keys)
        check_keys(stated, ("effect", "parameters"), source, keys)
        cls = chosen_class(EFFECTS, stated, "effect", source, keys)
        effects.append(build(cls, stated.get("parameters", {}), source, (*keys, "parameters")))
    return tuple(effects)


def _seed(value: object, source: Source) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= LARGEST_SEED:
        needed = f"a whole number of at least 0 and at most {LARGEST_SEED}"
        raise source.error(("seed",), f"{value!r} is not permitted; it must be {needed}{sweep_hint(value, ('seed',))}")
    return value


_READERS: Mapping[str, Callable[[object, Source], object]] = {
    "damper": lambda value, source: _damper(value, source, ("damper",)),
    "actuator": lambda value, source: build(Coil, value, source, ("actuator",), required=("rate", "max_current")),
    "temperature": _temperature,
    "plant": lambda value, source: build(Plant, value, source, ("plant",)),
    "driver": lambda value, source: build(Driver, value, source, ("driver",)),
    "controller": _control,
    "excitation": _excitation,
    "effects": _effects,
    "solver": lambda value, source: build(Solver, value, source, ("solver",)),
    "start": lambda value, source: build(Start, value, source, ("start",)),
    "seed": _seed,
    "checks": read_checks,
}
"""What reads each section of a scenario."""
_FIELDS = {"actuator": "coil", "controller": "control"}
"""Fields of a scenario that are not called as the section they come from."""
