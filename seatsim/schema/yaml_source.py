"""A YAML file with the place of every key, for errors: its line, or the option that has put it there."""

from __future__ import annotations

from pathlib import Path

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq
from ruamel.yaml.error import MarkedYAMLError, YAMLError

from seatsim.schema.errors import InputError

KeyPath = tuple[str | int, ...]


class Source:
    """The content of a YAML 1.2 file: `data` as plain mappings and lists, and the places of its keys.

    Raises:
        InputError: the file cannot be read, is not YAML, has a key twice, or is not a mapping.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            text = path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            reason = error.strerror if isinstance(error, OSError) else "not UTF-8 text"
            raise InputError(f"{path}: cannot be read: {reason}; give the path of a YAML file") from error
        try:
            tree = YAML(typ="rt").load(text)
        except MarkedYAMLError as error:
            mark = error.problem_mark or error.context_mark
            line = f", line {mark.line + 1}" if mark else ""
            problem = (error.problem or "not YAML").split("\n")[0]
            raise InputError(f"{path}{line}: {problem}; write each key once, as 'key: value'") from error
        except YAMLError as error:
            raise InputError(f"{path}: not YAML: {error}") from error
        if not isinstance(tree, CommentedMap):
            raise InputError(f"{path}: holds no mapping; a file has keys such as 'plant:' and 'damper:' at its top")
        self.places: dict[KeyPath, str] = {(): self._line(1)}
        self.data = self._plain_mapping(tree, ())

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

    def _line(self, number: int) -> str:
        return f"{self.path}, line {number}"

    def _plain_mapping(self, node: CommentedMap, keys: KeyPath) -> dict[str, object]:
        for key in node:
            # A key that came with a merge (`<<`) has no place of its own: it stands where its mapping does.
            line = node.lc.key(key)[0] if key in (node.lc.data or ()) else node.lc.line
            self.places[(*keys, key)] = self._line(line + 1)
        return {key: self._plain(value, (*keys, key)) for key, value in node.items()}

    def _plain(self, node: object, keys: KeyPath) -> object:
        if isinstance(node, CommentedMap):
            return self._plain_mapping(node, keys)
        if isinstance(node, CommentedSeq):
            for index in range(len(node)):
                self.places[(*keys, index)] = self._line(node.lc.item(index)[0] + 1)
            return [self._plain(value, (*keys, index)) for index, value in enumerate(node)]
        if isinstance(node, bool) or node is None:
            return node
        for kind in (int, float, str):
            if isinstance(node, kind):
                return kind(node)
        return node
