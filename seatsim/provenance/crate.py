"""`ro-crate-metadata.json`: the manifest in the terms of RO-Crate 1.3 and of its profile Process Run Crate 0.5.

It says the same as the manifest to programs that know nothing of seatsim: an action (the command) by an instrument
(seatsim) made some files of others. The specification asks for a date; it is the day of writing, or that of
`SOURCE_DATE_EPOCH` where that is set, and the file is therefore left out where bytes are compared.
"""

from __future__ import annotations

import os
import shlex
import time
from collections.abc import Mapping, Sequence
from typing import Any
from urllib.parse import quote

CRATE = "ro-crate-metadata.json"
VERSION = "https://w3id.org/ro/crate/1.3"
TERMS = "https://w3id.org/ro/terms/workflow-run/context"
PROFILE = "https://w3id.org/ro/wfrun/process/0.5"
LICENSE = "#rights"
INSTRUMENT = "#seatsim"
FORMATS = {
    "json": "application/json", "csv": "text/csv", "html": "text/html", "png": "image/png", "yaml": "application/yaml",
    "parquet": "application/vnd.apache.parquet", "gz": "application/gzip",
}  # fmt: skip
Entity = dict[str, Any]


def describe_crate(manifest: Mapping[str, Any]) -> Entity:
    """Return the research object crate that says what a manifest says."""
    inputs = [_describe_input(number, each) for number, each in enumerate(manifest["inputs"])]
    outputs = [_describe_file(each) for each in manifest["outputs"]]
    day = _state_day()
    command = shlex.join(["seatsim", manifest["command"], *_drop_mark(manifest["arguments"])])
    root: Entity = {
        "@id": "./", "@type": "Dataset", "name": f"{manifest['folder']}: files of seatsim {manifest['command']}",
        "description": f"What `{command}` wrote, with the hashes of its inputs.", "datePublished": day,
        "license": {"@id": LICENSE}, "conformsTo": {"@id": PROFILE},
        "hasPart": [_refer(each) for each in [*outputs, {"@id": "manifest.json"}]], "mentions": {"@id": "#run"},
    }  # fmt: skip
    return {
        "@context": [f"{VERSION}/context", TERMS],
        "@graph": [
            {"@id": CRATE, "@type": "CreativeWork", "about": {"@id": "./"}, "conformsTo": {"@id": VERSION}},
            root,
            {"@id": PROFILE, "@type": "CreativeWork", "name": "Process Run Crate", "version": "0.5"},
            {"@id": LICENSE, "@type": "CreativeWork", "name": "Rights of the data",
             "description": "Whoever ran the command decides on the license of these files; none is stated."},
            {"@id": "manifest.json", "@type": "File", "name": "manifest.json", "encodingFormat": FORMATS["json"],
             "description": "command, arguments, inputs, versions and platform, as `seatsim reproduce` reads them"},
            *_describe_run(manifest, command, day, inputs, outputs), *inputs, *outputs,
        ],
    }  # fmt: skip


def _describe_run(
    manifest: Mapping[str, Any], command: str, day: str, inputs: Sequence[Entity], outputs: Sequence[Entity]
) -> list[Entity]:
    """Return the action with its instrument and with who carried it out: nobody is named, since nobody was asked."""
    version = manifest["versions"]["seatsim"]
    return [
        {"@id": "#run", "@type": "CreateAction", "name": command, "description": f"seatsim {manifest['command']}",
         "endTime": day, "actionStatus": {"@id": "http://schema.org/CompletedActionStatus"},
         "instrument": {"@id": INSTRUMENT}, "agent": {"@id": "#user"},
         "object": [_refer(each) for each in inputs], "result": [_refer(each) for each in outputs]},
        {"@id": "#user", "@type": "Person", "name": "whoever ran the command"},
        {"@id": INSTRUMENT, "@type": "SoftwareApplication", "name": "seatsim", "version": version,
         "softwareVersion": version, "url": "https://pypi.org/project/seatsim/",
         "softwareRequirements": [f"{name} {text}" for name, text in manifest["versions"].items()
                                  if name not in ("seatsim", "sources")]},
    ]  # fmt: skip


def _describe_file(each: Mapping[str, Any]) -> Entity:
    name = each["path"]
    form = FORMATS.get(name.rpartition(".")[2], "application/octet-stream")
    return {"@id": quote(name), "@type": "File", "name": name, "encodingFormat": form,
            "contentSize": str(each["bytes"]), "sha256": each["sha256"]}  # fmt: skip


def _describe_input(number: int, each: Mapping[str, Any]) -> Entity:
    """Return an input, which is no part of the crate: its path is a name there, since it may not be sent along."""
    return {"@id": f"#input-{number + 1}", "@type": "CreativeWork", "name": each["path"], "identifier": each["sha256"],
            "description": f"{each['bytes']} bytes; the identifier is their SHA-256"}  # fmt: skip


def _refer(each: Mapping[str, Any]) -> Entity:
    return {"@id": each["@id"]}


def _drop_mark(arguments: Sequence[str]) -> list[str]:
    return [text for text in arguments if text != "--"]


def _state_day() -> str:
    moment = os.environ.get("SOURCE_DATE_EPOCH", "")
    return time.strftime("%Y-%m-%d", time.gmtime(int(moment) if moment.isdecimal() else None))
