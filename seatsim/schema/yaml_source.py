"""A YAML file with the place of every key, for errors: its line, or the option that has put it there."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self

from seatsim.schema.errors import InputError, nearest
from seatsim.schema.guarded import read_bytes
from seatsim.schema.yaml_text import LARGEST, KeyPath, YamlError, parse


class Source:
    """The content of a YAML 1.2 file: `data` as plain mappings and lists, and the places of its keys.

    Raises:
        InputError: the file cannot be read, is not YAML, has a key twice, or is not a mapping.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        content = read_bytes(path, LARGEST, "a YAML file")
        try:
            text = content.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            raise InputError(f"{path}: cannot be read: not UTF-8 text; give the path of a YAML file") from error
        try:
            data, lines = parse(text)
        except YamlError as error:
            raise InputError(f"{path}, line {error.line}: {error}") from error
        if not isinstance(data, dict):
            raise InputError(f"{path}: holds no mapping; a YAML file has keys at its top, each as 'key: value'")
        self.places: dict[KeyPath, str] = {keys: f"{path}, line {line}" for keys, line in {(): 1, **lines}.items()}
        self.data: dict[str, object] = data

    @classmethod
    def of(cls, data: Mapping[str, object], name: str = "scenario") -> Self:
        """Return a source of the content of a mapping, such as a scenario made in Python; files lie where Python runs.

        Sequences and numbers of numpy become those of YAML; `name` stands in errors in place of a path.
        """
        source = cls.__new__(cls)
        source.path, source.places = Path(name), {(): name}
        source.data = {str(key): _as_yaml(value) for key, value in data.items()}
        return source

    def with_changes(self) -> Self:
        """Return a copy whose content may be changed by `put`; what is not changed is shared with this one."""
        changed = copy.copy(self)
        changed.data, changed.places = dict(self.data), dict(self.places)
        return changed

    def below(self, key: str) -> Self:
        """Return the mapping under a key at the top as a source of its own, whose places are those in this file."""
        inner = copy.copy(self)
        stated = self.data[key]
        if not isinstance(stated, dict):
            raise self.error((key,), f"{stated!r} is not a mapping; write its keys indented below it")
        inner.data = stated
        inner.places = {keys[1:]: place for keys, place in self.places.items() if keys[:1] == (key,)}
        return inner

    def put(self, dotted: str, value: object, place: str) -> None:
        """Put a value under a dotted key, such as `plant.driver_mass` or `effects.0.parameters.high`, at a `place`.

        Raises:
            InputError: the key leads into a value without keys, or to an entry that a list does not have.
        """
        node: Any = self.data
        keys: list[str | int] = []
        *above, last = dotted.split(".")
        for name in above:
            key = _find_key(node, name, dotted, place)
            below = node[key] if isinstance(node, list) else node.get(key, {})
            if not isinstance(below, dict | list):
                raise InputError(f"{place}: '{dotted}' leads into '{name}', which has no keys{nearest(name, node)}")
            if not below:
                self.places[(*keys, key)] = place
            # What lies on the way is copied, so that sources that share the rest stay as they are.
            copied = copy.copy(below)
            node[key] = copied
            node = copied
            keys.append(key)
        end = _find_key(node, last, dotted, place)
        whole = (*keys, end)
        replaced = node[end] if isinstance(node, list) else node.get(end)
        node[end] = value
        if isinstance(replaced, dict | list):
            for known in [known for known in self.places if known[: len(whole)] == whole]:
                del self.places[known]
        self.places[whole] = place

    def place(self, keys: KeyPath) -> str:
        """Return `file, line N, key.path` of a key, or of the nearest one above it that has a place."""
        dotted = ".".join(str(key) for key in keys)
        return self.nearest_place(keys) + (f", {dotted}" if dotted else "")

    def nearest_place(self, keys: KeyPath) -> str:
        """Return the place of a key, or of the nearest one above it that has one."""
        while keys not in self.places:
            keys = keys[:-1]
        return self.places[keys]

    def error(self, keys: KeyPath, problem: str) -> InputError:
        """Return the error for a key."""
        return InputError(f"{self.place(keys)}: {problem}")


def _as_yaml(value: object) -> object:
    if isinstance(value, Mapping):
        return {str(key): _as_yaml(each) for key, each in value.items()}
    # An array and a number of numpy both have `tolist`.
    whole = value.tolist() if hasattr(value, "tolist") else value
    return [_as_yaml(each) for each in whole] if isinstance(whole, list | tuple) else whole


def _find_key(node: object, name: str, dotted: str, place: str) -> Any:
    """Return what a part of a dotted key is in a mapping (itself) or in a list (the number of an entry)."""
    if not isinstance(node, list):
        return name
    if name.isdecimal() and int(name) < len(node):
        return int(name)
    permitted = f"0 to {len(node) - 1}" if node else "none, as it is empty"
    raise InputError(f"{place}: '{dotted}' leads to entry '{name}' of a list; permitted: {permitted}")
