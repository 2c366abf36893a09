"""`manifest.json` and `ro-crate-metadata.json` beside the files of a command: what made them, and of which inputs.

The manifest holds no time and no absolute path, so that equal commands on equal inputs give equal manifests. The crate
says the same in the terms of RO-Crate 1.3 and of its profile Process Run Crate 0.5, to programs that know nothing of
seatsim: an action (the command) by an instrument (seatsim) made some files of others; who carried it out is not named,
since nobody was asked. What is the same in every crate stands in `crate.json` beside this module. The specification
asks for a date; it is the day of writing, or that of `SOURCE_DATE_EPOCH` where that is set, and the file is therefore
left out where bytes are compared.
"""

from __future__ import annotations

import json
import os
import shlex
import time
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path, PurePosixPath
from urllib.parse import quote

from seatsim.provenance.statement import (
    MANIFEST,
    Invocation,
    Manifest,
    current_invocation,
    list_platform,
    list_versions,
    relate,
    state_file,
)
from seatsim.scenario.loading import EXAMPLES
from seatsim.schema.files import write_json, write_together
from seatsim.schema.modules import used_files

CRATE = "ro-crate-metadata.json"
_TEMPLATE = Path(__file__).with_name("crate.json")
_FORMATS = {
    ".json": "application/json",
    ".csv": "text/csv",
    ".html": "text/html",
    ".png": "image/png",
    ".yaml": "application/yaml",
    ".parquet": "application/vnd.apache.parquet",
    ".gz": "application/gzip",
}


def _describe_crate(manifest: Manifest) -> Mapping[str, object]:
    """Return the research object crate that says what a manifest says."""
    crate = json.loads(_TEMPLATE.read_text(encoding="utf-8"))
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
            "encodingFormat": _FORMATS.get(PurePosixPath(each.path).suffix, "application/octet-stream"),
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


EXAMPLE = "example:"
"""Begins the path of an input that comes with seatsim."""
Measured = Mapping[str, tuple[str, ...]]
"""Columns or keys of files that hold times which were measured, and differ each time."""


def write_documented(
    folder: Path, write: Callable[[Path], Iterable[Path]], seed: int | None = None, measured: Measured | None = None
) -> list[Path]:
    """Write files as `write_together` does, with a manifest and a research object crate where a command is at work.

    Args:
        folder: where they go.
        write: fills a folder and returns its files there.
        seed: from which every random draw derives, None where there is none or the inputs state several.
        measured: see `Measured`.
    """

    def write_all(part: Path) -> list[Path]:
        paths = list(write(part))
        invocation = current_invocation()
        if invocation is None:
            return paths
        outputs = {path.relative_to(part).as_posix(): path for path in paths}
        manifest = describe(invocation, folder, outputs, list_versions(), seed, measured or {})
        return [*paths, write_json(part / MANIFEST, manifest), write_json(part / CRATE, _describe_crate(manifest))]

    return write_together(folder, write_all)


def describe(
    invocation: Invocation,
    folder: Path,
    outputs: Mapping[str, Path],
    versions: Mapping[str, str],
    seed: int | None = None,
    measured: Measured | None = None,
) -> Manifest:
    """Return the manifest that a folder gets of the command at work, which wrote `outputs`, paths by name."""
    place = Path(os.path.abspath(folder))
    return Manifest(
        command=invocation.command,
        arguments=invocation.arguments,
        directory=relate(invocation.directory, place),
        folder=place.name,
        versions=versions,
        platform=list_platform(),
        own_code=[state_file(relate(path, place), path.read_bytes()) for path in used_files()],
        inputs=[
            stated._replace(path=_name(path, place))
            for path, stated in sorted(invocation.reads.items())
            # Drafts that were read back are gone; a sweep that is gone on with reads the manifest that this one
            # replaces.
            if path.is_file() and path != place / MANIFEST
        ],
        outputs=[state_file(name, path.read_bytes()) for name, path in outputs.items()],
        measured={name: fields for name, fields in (measured or {}).items() if name in outputs},
        seed=seed,
    )


def _name(path: Path, folder: Path) -> str:
    """Return the path of an input relative to the folder of the manifest, or as an example of seatsim."""
    for examples in EXAMPLES:
        if path.is_relative_to(examples):
            return f"{EXAMPLE}{path.relative_to(examples).as_posix()}"
    return relate(path, folder)
