"""`ro-crate-metadata.json`: the manifest in the terms of RO-Crate 1.3 and of its profile Process Run Crate 0.5.

It says the same as the manifest to programs that know nothing of seatsim: an action (the command) by an instrument
(seatsim) made some files of others; who carried it out is not named, since nobody was asked. What is the same in every
crate stands in `crate.json` beside this module. The specification asks for a date; it is the day of writing, or that of
`SOURCE_DATE_EPOCH` where that is set, and the file is therefore left out where bytes are compared.
"""

from __future__ import annotations

import json
import os
import shlex
import time
from collections.abc import Iterable, Mapping
from pathlib import Path, PurePosixPath
from urllib.parse import quote

from seatsim.provenance.statement import MANIFEST, Manifest

CRATE = "ro-crate-metadata.json"
TEMPLATE = Path(__file__).with_name("crate.json")
FORMATS = {
    ".json": "application/json",
    ".csv": "text/csv",
    ".html": "text/html",
    ".png": "image/png",
    ".yaml": "application/yaml",
    ".parquet": "application/vnd.apache.parquet",
    ".gz": "application/gzip",
}


def describe_crate(manifest: Manifest) -> Mapping[str, object]:
    """Return the research object crate that says what a manifest says."""
    crate = json.loads(TEMPLATE.read_text(encoding="utf-8"))
    entities = {each["@id"]: each for each in crate["@graph"]}
    inputs, outputs = _describe_inputs(manifest), _describe_outputs(manifest)
    day, name, version = _state_day(), f"seatsim {manifest.command}", manifest.versions["seatsim"]
    command = shlex.join(["seatsim", manifest.command, *(text for text in manifest.arguments if text != "--")])
    entities["./"] |= {
        "name": f"{manifest.folder}: files of {name}",
        "description": f"What `{command}` wrote, with the hashes of its inputs.",
        "datePublished": day,
        "hasPart": [*_refer(outputs), {"@id": MANIFEST}],
    }
    results = {"object": _refer(inputs), "result": _refer(outputs)}
    entities["#run"] |= {"name": command, "description": name, "endTime": day, **results}
    needed = [f"{each} {text}" for each, text in manifest.versions.items() if each not in ("seatsim", "sources")]
    entities["#seatsim"] |= {"version": version, "softwareVersion": version, "softwareRequirements": needed}
    return {**crate, "@graph": [*entities.values(), *inputs, *outputs]}


def _describe_inputs(manifest: Manifest) -> list[dict[str, str]]:
    """Return the inputs, which are no part of the crate: a path is a name there, since it may not be sent along."""
    return [
        {
            "@id": f"#input-{number}",
            "@type": "CreativeWork",
            "name": each.path,
            "identifier": each.sha256,
            "description": f"{each.bytes} bytes; the identifier is their SHA-256",
        }
        for number, each in enumerate(manifest.inputs, start=1)
    ]


def _describe_outputs(manifest: Manifest) -> list[dict[str, str]]:
    return [
        {
            "@id": quote(each.path),
            "@type": "File",
            "name": each.path,
            "encodingFormat": FORMATS.get(PurePosixPath(each.path).suffix, "application/octet-stream"),
            "contentSize": str(each.bytes),
            "sha256": each.sha256,
        }
        for each in manifest.outputs
    ]


def _refer(entities: Iterable[Mapping[str, str]]) -> list[dict[str, str]]:
    return [{"@id": each["@id"]} for each in entities]


def _state_day() -> str:
    moment = os.environ.get("SOURCE_DATE_EPOCH", "")
    return time.strftime("%Y-%m-%d", time.gmtime(int(moment) if moment.isdecimal() else None))
