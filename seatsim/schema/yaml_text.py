"""YAML texts as plain values with the line of every key, composed within stated limits.

Of a text no more is composed than is within them: its size, how deeply it nests, how many values it has once every
alias (`*name`) stands for what it refers to, and how long its whole numbers are. Scalars are those of YAML 1.2 (`yes`
and `on` are texts, as is a date), keys are texts, and a tag (`!name`) is an error, since it asks for an object.
"""

from __future__ import annotations

import math
import re
from typing import TypeAlias

import yaml

from seatsim.schema.text import cut

LARGEST = 8 * 2**20
"""Bytes of a text."""
DEEPEST = 32
"""Lists and mappings within each other."""
_MOST_VALUES = 300_000
_LONGEST_NUMBER = 40
"""Digits of a whole number: twice what any seed has."""
_TOO_DEEP = f"lists and mappings nest more than {DEEPEST} deep"
_PROBLEMS = {
    "maximum nesting depth": _TOO_DEEP,
    "found another document": "a second document begins; write one to a file",
    "undefined alias": "an alias (*name) refers to nothing that stands before it",
}
"""What the library says of a text, and what is said of it here."""
_PLAIN, _QUOTED = "plain", "quoted"
"""Tags of nodes that state none: a scalar that may be a number, and one that is a text."""

_Scalar: TypeAlias = str | int | float | bool | None
KeyPath = tuple[str | int, ...]

_WORDS: dict[str, _Scalar] = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL"), None),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
    **dict.fromkeys((".nan", ".NaN", ".NAN"), math.nan),
    **{sign + word: float(f"{sign}inf") for sign in ("", "+", "-") for word in (".inf", ".Inf", ".INF")},
}
_WHOLE = re.compile(r"[-+]?[0-9]+(_[0-9]+)*|0o[0-7]+|0x[0-9a-fA-F]+")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(_[0-9]+)*(\.[0-9]*)?)([eE][-+]?[0-9]+)?")


class YamlError(Exception):
    """What is wrong with a text, and in which line."""

    def __init__(self, problem: str, line: int) -> None:
        super().__init__(problem)
        self.line = line


def parse(text: str) -> tuple[object, dict[KeyPath, int]]:
    """Return the value of a text, and the line of every key and entry.

    Raises:
        YamlError: it is no YAML, or beyond the limits.
    """
    reader = _Reader()
    node = _compose(text)
    return None if node is None else reader.read(node, ()), reader.lines


def parse_value(text: str) -> object:
    """Return a value that stands alone, such as that of an option or of a cell; YamlError as for `parse`."""
    return parse(text)[0]


class _Composer(getattr(yaml, "CSafeLoader", yaml.SafeLoader)):  # type: ignore[misc]  # its types are not known
    """Composes the nodes of a text, by the library in C where it is installed, until they are beyond the limits.

    The library tells it where it goes down to a node and comes up again, and asks it for the tag of what states none.
    """

    count = depth = 0

    def descend_resolver(self, parent: yaml.Node | None, index: object) -> None:
        """Count a node within its parent."""
        self.count, self.depth = self.count + 1, self.depth + 1
        if self.count > 2 * _MOST_VALUES:  # keys are nodes, too
            raise YamlError(f"more than {_MOST_VALUES} values", _line(parent))
        if self.depth > DEEPEST + 1:
            raise YamlError(_TOO_DEEP, _line(parent))

    def ascend_resolver(self) -> None:
        """Come back to the parent."""
        self.depth -= 1

    def resolve(self, kind: type, value: object, implicit: tuple[bool, bool]) -> str:
        """Return whether what states no tag may be another value than a text."""
        return _QUOTED if kind is yaml.ScalarNode and not implicit[0] else _PLAIN


def _compose(text: str) -> yaml.Node | None:
    """Return the node of the only document, None where there is none."""
    if len(text) > LARGEST:
        raise YamlError(f"{len(text) / 2**20:.3g} million characters; permitted: {LARGEST / 2**20:g} million", 1)
    try:
        return _Composer(text).get_single_node()
    except yaml.MarkedYAMLError as error:
        mark, problem = error.problem_mark or error.context_mark, (error.problem or "not YAML").split("\n")[0]
        plain = f"{problem}; write each key once, as 'key: value'"
        said = next((ours for theirs, ours in _PROBLEMS.items() if theirs in problem), plain)
        raise YamlError(said, mark.line + 1 if mark else 1) from error
    except yaml.reader.ReaderError as error:
        line = text.count("\n", 0, error.position) + 1
        raise YamlError(f"character {error.character!r} is not permitted in YAML", line) from error


class _Reader:
    """Makes plain values of nodes, new ones for every alias, and notes the line of every key and entry."""

    def __init__(self) -> None:
        self.lines: dict[KeyPath, int] = {}
        self.count = 0

    def read(self, node: yaml.Node, keys: KeyPath) -> object:
        """Return the value of a node, which stands under these keys."""
        self._enter(node, len(keys))
        if isinstance(node, yaml.ScalarNode):
            _check_signs(node.value, _line(node))
            return _read_scalar(node.value, _line(node)) if node.tag == _PLAIN else node.value
        if isinstance(node, yaml.SequenceNode):
            self.lines |= {(*keys, index): _line(entry) for index, entry in enumerate(node.value)}
            return [self.read(entry, (*keys, index)) for index, entry in enumerate(node.value)]
        entries = self._entries(node, len(keys))
        self.lines |= {(*keys, key): line for key, (line, _) in entries.items()}
        return {key: self.read(entry, (*keys, key)) for key, (_, entry) in entries.items()}

    def _enter(self, node: yaml.Node, depth: int) -> None:
        """Check a node that is about to be read; an alias may hold itself."""
        self.count += 1
        if self.count > _MOST_VALUES:
            raise YamlError(f"more than {_MOST_VALUES} values once its aliases are put in", _line(node))
        if node.tag not in (_PLAIN, _QUOTED):
            raise YamlError(f"the tag '{node.tag}' is not permitted; write the plain value", _line(node))
        if depth > DEEPEST:
            raise YamlError(_TOO_DEEP, _line(node))

    def _entries(self, node: yaml.MappingNode, depth: int) -> dict[str, tuple[int, yaml.Node]]:
        """Return line and value by key: the mapping's own ones, then those of the mappings that `<<` puts in."""
        own: dict[str, tuple[int, yaml.Node]] = {}
        merged: dict[str, tuple[int, yaml.Node]] = {}
        for key, value in node.value:
            line = _line(key)
            if not isinstance(key, yaml.ScalarNode) or key.tag not in (_PLAIN, _QUOTED):
                raise YamlError("a key is no text; write each key as 'key: value'", line)
            _check_signs(key.value, line)
            if key.value == "<<" and key.tag == _PLAIN:
                for each in _mappings(value, line):
                    self._enter(each, depth + 1)
                    found = self._entries(each, depth + 1)
                    merged |= {name: (line, entry) for name, (_, entry) in found.items() if name not in merged}
            elif key.value in own:
                raise YamlError(f"found duplicate key '{cut(key.value)}'; write each key once, as 'key: value'", line)
            else:
                own[key.value] = (line, value)
        return own | {key: entry for key, entry in merged.items() if key not in own}


def _mappings(node: yaml.Node, line: int) -> list[yaml.MappingNode]:
    """Return the mappings that a `<<` puts in: one, or a list of them."""
    nodes = node.value if isinstance(node, yaml.SequenceNode) else [node]
    if not all(isinstance(each, yaml.MappingNode) for each in nodes):
        raise YamlError("'<<' takes a mapping; write '<<: *name' of one that has an anchor", line)
    return nodes


def _read_scalar(text: str, line: int) -> _Scalar:
    """Return a scalar without quotes as YAML 1.2 means it."""
    if text in _WORDS:
        return _WORDS[text]
    if _WHOLE.fullmatch(text):
        if len(text) > _LONGEST_NUMBER:
            raise YamlError(f"a whole number of {len(text)} digits; permitted: at most {_LONGEST_NUMBER}", line)
        return int(text, 0) if text[:2] in ("0x", "0o") else int(text)
    return float(text) if _FLOAT.fullmatch(text) else text


def _check_signs(text: str, line: int) -> None:
    """Raise YamlError at a zero byte, which an escape puts into a text: no path, name or unit may have one."""
    if "\0" in text:
        raise YamlError(f"{cut(text)!r} holds a zero byte; leave it out", line)


def _line(node: yaml.Node | None) -> int:
    return int(node.start_mark.line) + 1 if node else 1


def dump(content: object, line_each: bool = False) -> str:
    """Return the YAML of mappings, lists and plain values in their order.

    The innermost ones stand in one line each, or with `line_each` every key and entry in a line of its own.
    """
    form = {"default_flow_style": False if line_each else None, "sort_keys": False, "allow_unicode": True}
    return str(yaml.dump(content, None, _Dumper, width=9999, **form))


def _represent_text(dumper: yaml.SafeDumper, text: str) -> yaml.ScalarNode:
    """Return a text such that `parse` reads it as one: `0o7` stands in quotation marks."""
    is_other = text and (text in _WORDS or _WHOLE.fullmatch(text) or _FLOAT.fullmatch(text))
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style="'" if is_other else None)


def _represent_number(dumper: yaml.SafeDumper, number: float) -> yaml.ScalarNode:
    """Return a number as Python writes it: `1e-05`, where YAML 1.1 has `1.0e-05`."""
    if not math.isfinite(number):
        return dumper.represent_float(number)
    return dumper.represent_scalar("tag:yaml.org,2002:float", repr(number))


class _Dumper(yaml.SafeDumper):  # type: ignore[misc]  # its types are not known
    """Writes every value where it stands: no `*name` in place of one that stands elsewhere too."""

    def ignore_aliases(self, data: object) -> bool:
        return True


_Dumper.add_implicit_resolver("tag:yaml.org,2002:float", _FLOAT, list("-+.0123456789"))
_Dumper.add_representer(str, _represent_text)
_Dumper.add_representer(float, _represent_number)
