"""A damper that is a functional mock-up unit, as a YAML file states it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any, cast

from seatsim.cosimulation.damper import PREFIX, FmuDamper
from seatsim.cosimulation.description import (
    FORCE,
    QUANTITIES,
    check_parameter,
    describe_unit,
    find_conversion_of,
    find_variable,
)
from seatsim.dampers.base import Damper
from seatsim.schema.errors import InputError
from seatsim.schema.modules import check_in_use
from seatsim.schema.validation import check_keys, choose, mapping
from seatsim.schema.yaml_source import Source
from seatsim.schema.yaml_text import KeyPath


def stated_unit(stated: Mapping[str, object], source: Source, keys: KeyPath) -> Damper:
    """Return the damper of `{model: fmu:FILE, inputs: {QUANTITY: NAME}, outputs: {force: NAME}, parameters: {...}}`.

    FILE is taken from the folder of the source. Only what the unit says of itself is read; nothing of it runs.

    Raises:
        InputError: nobody named the file, it is no unit that can be stepped here, or the mapping does not fit it.
    """
    if keys != ("damper",):
        raise source.error((*keys, "model"), "a unit has no inverse; name a damper model that the inverse assumes")
    check_keys(stated, ("model", "inputs", "outputs", "parameters"), source, keys)
    path = source.path.parent / str(stated["model"]).removeprefix(PREFIX)
    with _placed(source, (*keys, "model")):
        check_in_use(path)
        unit = describe_unit(path)
    inputs = _names(stated, "inputs", tuple(QUANTITIES), source, keys)
    outputs = _names(stated, "outputs", (FORCE,), source, keys)
    if not inputs or FORCE not in outputs:
        missing, all_of = ("inputs", ", ".join(QUANTITIES)) if not inputs else ("outputs", FORCE)
        raise source.error(keys, f"key '{missing}' is missing or empty; it names a variable of the unit for {all_of}")
    for section, names, causality in (("inputs", inputs, "input"), ("outputs", outputs, "output")):
        for quantity, name in names.items():
            with _placed(source, (*keys, section, quantity)):
                find_conversion_of(find_variable(unit, name, causality), quantity)
    values: dict[str, float] = {}
    for name, value in mapping(stated.get("parameters", {}), source, (*keys, "parameters")).items():
        with _placed(source, (*keys, "parameters", name)):
            values[name] = check_parameter(unit, name, value)
    found: Any = FmuDamper(str(path), tuple(inputs.items()), outputs[FORCE], tuple(values.items()))
    return cast(Damper, found)


def _names(
    stated: Mapping[str, object], section: str, permitted: tuple[str, ...], source: Source, keys: KeyPath
) -> dict[str, str]:
    """Return the names of variables by quantity, in the order in which these are listed."""
    named = mapping(stated.get(section, {}), source, (*keys, section))
    check_keys(named, permitted, source, (*keys, section))
    return {quantity: choose(named, quantity, source, (*keys, section)) for quantity in permitted if quantity in named}


@contextmanager
def _placed(source: Source, keys: KeyPath) -> Iterator[None]:
    """Give errors their place in the file."""
    try:
        yield
    except InputError as error:
        raise source.error(keys, str(error)) from error
