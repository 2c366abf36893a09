"""A record is written as its fields say, and its JSON Schema says the same."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal, NamedTuple

import jsonschema
import numpy as np
import pytest

from seatsim.schema.arrays import Array
from seatsim.schema.content import Form, IfAny, Joined, Unwritten, to_content, written
from seatsim.schema.json_schema import answer_schema


class Dose(NamedTuple):
    """A dose."""

    rms: float
    """In m/s^2."""


@dataclass(frozen=True)
class Line:
    """A line of a table."""

    kind: Literal["a", "b"]
    passed: Annotated[bool, Form(key="pass")]
    force: Annotated[float, Form(unit="N")]
    history: Unwritten[Array]
    dose: Joined[Dose | None]
    scenario: Annotated[Mapping[str, object] | None, Form(key="file", file="x.yaml", if_any=True)]
    curve: Array
    place: Path = Path("a/b")
    pair: tuple[str, float] = ("x", 1.0)
    note: IfAny[str] = ""
    inner: "Line | None" = None

    @property
    @written("count")
    def number(self) -> int:
        """How many."""
        return len(self.curve)

    @property
    def other(self) -> int:
        """Not written."""
        return 1


FULL = Line("a", True, math.nan, np.zeros(9), Dose(0.5), {"plant": {}}, np.array([[1.0, np.inf]]), note="n")
BARE = Line("b", False, 2.0, np.zeros(9), None, None, np.array([]), inner=FULL)
WRITTEN = {
    "kind": "a", "pass": True, "force_N": None, "rms": 0.5, "file": "x.yaml", "curve": [[1.0, None]], "place": "a/b",
    "pair": ["x", 1.0], "note": "n", "inner": None, "count": 1,
}  # fmt: skip


def test_a_record_is_written_as_its_fields_say():
    assert to_content(FULL) == WRITTEN
    other = {"kind": "b", "pass": False, "force_N": 2.0, "rms": None, "curve": [], "count": 0, "inner": WRITTEN}
    assert to_content(BARE) == {key: WRITTEN[key] for key in ("place", "pair")} | other


def test_the_schema_is_of_what_is_written_and_says_what_the_source_says():
    schema = answer_schema(Line)
    for record in (FULL, BARE):
        jsonschema.validate(to_content(record), schema)
    assert list(schema["properties"]) == [*WRITTEN]
    assert set(schema["properties"]) - set(schema["required"]) == {"file", "note"}
    assert schema["description"] == "A line of a table." and schema["properties"]["count"]["description"] == "How many."
    assert schema["properties"]["rms"] == {"type": ["number", "null"], "description": "In m/s^2."}


def test_the_schema_refuses_what_is_never_written():
    never = {"kind": "c", "pass": 1, "rms": "x", "curve": 1.0, "inner": {"kind": "a"}, "count": 0.5, "pair": ["x"]}
    for key, wrong in never.items():
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(WRITTEN | {key: wrong}, answer_schema(Line))
