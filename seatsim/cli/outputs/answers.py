"""JSON Schemas: of the files that seatsim reads, for editors, and of what each command prints with `--json`.

The records of commands that find nothing stand here, all others in the packages that make them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import reduce
from operator import or_
from pathlib import Path
from pkgutil import resolve_name
from typing import NamedTuple

from seatsim.recordings.header import Header, RunEntry
from seatsim.recordings.recording import ChannelEntry, VoltageGain
from seatsim.rig.coil import Coil
from seatsim.scenario.sections import damper_schema, scenario_schema, schema_of_models
from seatsim.schema.fields import read_packaged
from seatsim.schema.json_schema import BY_KEY, TEXT, Schema, head_schema, mapping_schema, properties_of, record_schema
from seatsim.sweeps.definition import sweep_schema

_WRITTEN = {"properties": {"files": {"type": "array", "items": {"type": "string"}}}, "required": ["files"]}
"""Schema of what all commands print: the files that were written."""


class NewAnswer(NamedTuple):
    """What was written."""

    kind: str


class ExploreAnswer(NamedTuple):
    """A page that is served until the command is interrupted."""

    address: str


class BlindMakeAnswer(NamedTuple):
    """A sealed set; the key is shown this once."""

    cases: int
    folder: Path
    sealed: Path
    key: str


class SlurmAnswer(NamedTuple):
    """A script for an array of tasks, which run a sweep of so many runs."""

    runs: int


class ErrorAnswer(NamedTuple):
    """What any command prints where it ends with an error."""

    error: str


class SynthesisAnswer(NamedTuple):
    """A design, as in `design.yaml`."""

    measures: list[str]
    gain: list[list[float]]
    gamma: float
    lower_bound: float


_ANSWERS = read_packaged(Path(__file__).with_suffix(".yaml"), dict[str, str])
"""Records that each command prints, by its name."""


def list_answers() -> Mapping[str, object]:
    """Return the type of what each command prints, by its name."""
    return {
        command: reduce(or_, (resolve_name(":".join(f"seatsim.{name}".rsplit(".", 1))) for name in names.split()))
        for command, names in _ANSWERS.items()
    }


def describe_answer(command: str) -> dict[str, object]:
    """Return the JSON Schema of what a command prints with `--json`: its record, and the files that were written."""
    from seatsim.schema.json_schema import answer_schema

    schema = {"title": f"seatsim {command} --json", **answer_schema(list_answers()[command])}
    # An error comes without files.
    return schema if command == "error" else {**schema, "allOf": [_WRITTEN]}


def _recording_schema() -> Schema:
    """Return the schema of `recording.yaml`."""
    keys = dict(properties_of(record_schema(Header)))
    tolerance = {"anyOf": [{"type": "number", "minimum": 0, "maximum": 1}, {"const": "fitted"}, BY_KEY]}
    keys |= {
        "parameter_tolerance": tolerance,
        "runs": {"type": "array", "minItems": 1, "items": record_schema(RunEntry)},
        "channels": {"type": "object", "additionalProperties": record_schema(ChannelEntry)},
        "actuator": record_schema(VoltageGain),
        "note": TEXT,
    }
    return head_schema("seatsim recording", mapping_schema(keys, ("rig", "sample_rate", "nominal", "runs", "channels")))


def _parameters_schema() -> Schema:
    """Return the schema of a damper with its coil, as `seatsim identify` writes it."""
    keys = {"damper": damper_schema(), "actuator": record_schema(Coil, ("rate", "max_current")), "bench": BY_KEY}
    return head_schema("seatsim damper parameters", mapping_schema(keys, ("damper",)) | schema_of_models())


FILES: Mapping[str, Callable[[], Schema]] = {
    "scenario": scenario_schema,
    "recording": _recording_schema,
    "parameters": _parameters_schema,
    "sweep": sweep_schema,
}
"""Schemas of files by kind."""
