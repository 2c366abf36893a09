"""JSON Schema of the files that seatsim reads, for editors: scenarios, recordings, sweeps, parameters of dampers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import cast

from seatsim.recordings.header import Header, RunEntry
from seatsim.recordings.recording import ChannelEntry, VoltageGain
from seatsim.rig.coil import Coil
from seatsim.scenario.damper import damper_schema, schema_of_models
from seatsim.scenario.sections import scenario_schema
from seatsim.schema.json_schema import BY_KEY, TEXT, Schema, head_schema, mapping_schema, record_schema
from seatsim.sweeps.definition import sweep_schema


def recording_schema() -> Schema:
    """Return the schema of `recording.yaml`."""
    keys = dict(cast("Schema", record_schema(Header)["properties"]))
    tolerance = {"anyOf": [{"type": "number", "minimum": 0, "maximum": 1}, {"const": "fitted"}, BY_KEY]}
    keys |= {
        "parameter_tolerance": tolerance,
        "runs": {"type": "array", "minItems": 1, "items": record_schema(RunEntry)},
        "channels": {"type": "object", "additionalProperties": record_schema(ChannelEntry)},
        "actuator": record_schema(VoltageGain),
        "note": TEXT,
    }
    return head_schema("seatsim recording", mapping_schema(keys, ("rig", "sample_rate", "nominal", "runs", "channels")))


def parameters_schema() -> Schema:
    """Return the schema of a damper with its coil, as `seatsim identify` writes it."""
    keys = {"damper": damper_schema(), "actuator": record_schema(Coil, ("rate", "max_current")), "bench": BY_KEY}
    return head_schema("seatsim damper parameters", mapping_schema(keys, ("damper",)) | schema_of_models())


FILES: Mapping[str, Callable[[], Schema]] = {
    "scenario": scenario_schema,
    "recording": recording_schema,
    "parameters": parameters_schema,
    "sweep": sweep_schema,
}
"""Schemas of files by kind."""
