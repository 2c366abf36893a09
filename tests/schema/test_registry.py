"""Registries: classes by name, the specification of each, and clear errors for what is not there."""

from typing import NamedTuple

import pytest

from seatsim.schema import registry
from seatsim.schema.errors import InputError
from seatsim.schema.modules import load_plugins
from seatsim.schema.registry import Registry, find, initial_state, name_of, names, register, specification_of


class Facts(NamedTuple):
    initial: tuple[float, ...]


@pytest.fixture
def parts(monkeypatch):
    # Before the tables are replaced: plug-ins register their classes once in a process.
    load_plugins()
    monkeypatch.setattr(registry, "_classes", {})
    monkeypatch.setattr(registry, "_specifications", {})
    return Registry("part")


def part(name, **changes):
    return type(name, (), {"__module__": __name__, "__qualname__": name} | changes)


def test_what_is_registered_is_found_by_either_door(parts):
    Valve = parts.register("valve", Facts((1.0, 2.0)))(part("Valve"))
    Bush = register("part", "bush", None)(part("Bush"))
    assert parts.find("valve") is find("part", "valve") is Valve
    assert parts.names() == names("part") == ["bush", "valve"]
    assert parts.name_of(Bush) == name_of("part", Bush) == "bush"
    assert parts.specification_of(Valve) == specification_of(Valve) == Facts((1.0, 2.0))
    assert (initial_state(Valve), initial_state(Bush)) == ((1.0, 2.0), ())


def test_a_name_that_is_not_there(parts):
    parts.register("valve", None)(part("Valve"))
    with pytest.raises(InputError, match=r"no part is called 'vlave' \(did you mean 'valve'\?\); permitted: valve, or"):
        parts.find("vlave")
    with pytest.raises(InputError, match="module 'json' has no class 'JSONDecode'"):
        parts.find("json:JSONDecode")
    with pytest.raises(InputError, match="'json:JSONDecoder' is not a part: decorate"):
        parts.find("json:JSONDecoder")


def test_a_class_of_another_module_does_not_take_a_name(parts):
    first = parts.register("valve", None)(part("Valve"))
    with pytest.raises(InputError, match="part 'valve' is there already"):
        parts.register("valve", None)(part("Valve", __module__="elsewhere"))
    assert parts.find("valve") is first


def test_a_class_that_is_loaded_again_replaces_itself(parts):
    parts.register("valve", None)(part("Valve"))
    again = parts.register("valve", None)(part("Valve"))
    assert parts.find("valve") is again
