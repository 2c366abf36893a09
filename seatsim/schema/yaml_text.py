"""YAML texts as plain values with the line of every key, read event by event within stated limits.

Nothing of a text is constructed before it is within them: its size, how deeply it nests, how many values it has once
every alias (`*name`) stands for what it refers to, and how long its whole numbers are. Scalars are those of YAML 1.2
(`yes` and `on` are texts, as is a date), keys are texts, and a tag (`!name`) is an error, since it asks for an object.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator
from typing import NamedTuple, TypeAlias, cast

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


class _Content(NamedTuple):
    """The value of a text, and the line of every key and entry."""

    value: object
    lines: dict[KeyPath, int]


class _Node(NamedTuple):
    """A value with its line; mappings hold (line of the key, value), and `merged` the mappings of their `<<`.

    `size` counts the values in it once every alias and every `<<` stands for what it refers to.
    """

    line: int
    value: _Scalar | list[_Node] | dict[str, tuple[int, _Node]]
    merged: tuple[_Node, ...] = ()
    size: int = 1


def parse(text: str) -> _Content:
    """Return the value of a text.

    Raises:
        YamlError: it is no YAML, or beyond the limits.
    """
    lines: dict[KeyPath, int] = {}
    return _Content(_plain(_Composer(text).compose(), (), lines), lines)


def parse_value(text: str) -> object:
    """Return a value that stands alone, such as that of an option or of a cell; YamlError as for `parse`."""
    return parse(text).value


def _plain(node: _Node, keys: KeyPath, lines: dict[KeyPath, int]) -> object:
    """Return the plain value of a node, a new one for every alias, and note the lines of what is in it."""
    if isinstance(node.value, list):
        for index, entry in enumerate(node.value):
            lines[(*keys, index)] = entry.line
        return [_plain(entry, (*keys, index), lines) for index, entry in enumerate(node.value)]
    if not isinstance(node.value, dict):
        return node.value
    entries = {key: (node.line, entry) for merged in reversed(node.merged) for key, (_, entry) in _all(merged).items()}
    # The mapping's own keys first, and in their order.
    entries = node.value | {key: entry for key, entry in entries.items() if key not in node.value}
    for key, (line, _) in entries.items():
        lines[(*keys, key)] = line
    return {key: _plain(entry, (*keys, key), lines) for key, (_, entry) in entries.items()}


def _all(node: _Node) -> dict[str, tuple[int, _Node]]:
    """Return the keys of a mapping with those merged into it."""
    own = cast("dict[str, tuple[int, _Node]]", node.value)  # `_Composer` merges mappings alone
    merged = {key: entry for each in reversed(node.merged) for key, entry in _all(each).items()}
    return merged | own


class _Composer:
    """Makes nodes of the events of a text."""

    def __init__(self, text: str) -> None:
        if len(text) > LARGEST:
            raise YamlError(f"{len(text) / 2**20:.3g} million characters; permitted: {LARGEST / 2**20:g} million", 1)
        self.events = _events(text)
        self.anchors: dict[str, _Node] = {}
        self.count = 0

    def compose(self) -> _Node:
        """Return the node of the only document."""
        node = _Node(1, None)
        documents = 0
        for event in self.events:
            if isinstance(event, yaml.DocumentStartEvent):
                documents += 1
                if documents > 1:
                    raise YamlError("a second document begins; write one to a file", _line(event))
                node = self._node(next(self.events), 0)
        return node

    def _node(self, event: yaml.Event, depth: int) -> _Node:
        line = _line(event)
        self.count += 1
        if self.count > _MOST_VALUES:
            raise YamlError(f"more than {_MOST_VALUES} values", line)
        if isinstance(event, yaml.AliasEvent):
            if event.anchor not in self.anchors:
                raise YamlError(f"*{event.anchor} refers to nothing that ends before it", line)
            return self.anchors[event.anchor]._replace(line=line)
        if event.tag is not None:
            raise YamlError(f"the tag '{event.tag}' is not permitted; write the plain value", line)
        if isinstance(event, yaml.ScalarEvent):
            _check_signs(event.value, line)
            node = _Node(line, _read_scalar(event.value, line) if event.implicit[0] else event.value)
        elif depth >= DEEPEST:
            raise YamlError(_TOO_DEEP, line)
        elif isinstance(event, yaml.SequenceStartEvent):
            entries = list(self._entries(depth))
            node = _Node(line, entries, size=_sum_sizes(line, entries))
        else:
            node = self._mapping(line, depth)
        if event.anchor is not None:
            self.anchors[event.anchor] = node
        return node

    def _entries(self, depth: int) -> Iterator[_Node]:
        while not isinstance(event := next(self.events), yaml.SequenceEndEvent):
            yield self._node(event, depth + 1)

    def _mapping(self, line: int, depth: int) -> _Node:
        entries: dict[str, tuple[int, _Node]] = {}
        merged: list[_Node] = []
        while not isinstance(event := next(self.events), yaml.MappingEndEvent):
            at = _line(event)
            if not isinstance(event, yaml.ScalarEvent) or event.tag is not None:
                raise YamlError("a key is no text; write each key as 'key: value'", at)
            _check_signs(event.value, at)
            key, value = event.value, self._node(next(self.events), depth + 1)
            if key == "<<" and event.implicit[0]:
                merged += _mappings(value)
            elif key in entries:
                raise YamlError(f"found duplicate key '{cut(key)}'; write each key once, as 'key: value'", at)
            else:
                entries[key] = (at, value)
        return _Node(line, entries, tuple(merged), _sum_sizes(line, [*merged, *(each for _, each in entries.values())]))


def _sum_sizes(line: int, nodes: Iterable[_Node]) -> int:
    """Return the size of a node that holds others."""
    size = 1 + sum(node.size for node in nodes)
    if size > _MOST_VALUES:
        raise YamlError(f"more than {_MOST_VALUES} values once its aliases are put in", line)
    return size


def _mappings(node: _Node) -> list[_Node]:
    """Return the mappings that a `<<` puts in: one, or a list of them."""
    nodes = node.value if isinstance(node.value, list) else [node]
    if not all(isinstance(each.value, dict) for each in nodes):
        raise YamlError("'<<' takes a mapping; write '<<: *name' of one that has an anchor", node.line)
    return nodes


def _events(text: str) -> Iterator[yaml.Event]:
    """Yield the events of a text, read by the library in C where it is installed."""
    try:
        yield from yaml.parse(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = mark.line + 1 if mark else 1
        problem = (error.problem or "not YAML").split("\n")[0]
        # The library reads ahead, so at brackets by the thousand its own limit stands before the one stated here.
        if "maximum nesting depth" in problem:
            raise YamlError(_TOO_DEEP, line) from error
        raise YamlError(f"{problem}; write each key once, as 'key: value'", line) from error
    except yaml.reader.ReaderError as error:
        line = text.count("\n", 0, error.position) + 1
        raise YamlError(f"character {error.character!r} is not permitted in YAML", line) from error


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


def _line(event: yaml.Event) -> int:
    return int(event.start_mark.line) + 1


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
