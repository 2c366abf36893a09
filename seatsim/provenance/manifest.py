"""`manifest.json` beside the files of a command: what made them, and of which inputs.

The manifest holds no time and no absolute path, so that equal commands on equal inputs give equal manifests.
"""

import os
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

from seatsim.provenance import statement
from seatsim.scenario.loading import EXAMPLES
from seatsim.schema.files import write_json, write_together
from seatsim.schema.modules import used_files

EXAMPLE = "example:"
"""Begins the path of an input that comes with seatsim."""
Measured = Mapping[str, tuple[str, ...]]
"""Columns or keys of files that hold times which were measured, and differ each time."""


def write_documented(
    folder: Path, write: Callable[[Path], Iterable[Path]], seed: int | None = None, measured: Measured | None = None
) -> list[Path]:
    """Write files as `write_together` does, with a manifest where a command is at work.

    Args:
        folder: where they go.
        write: fills a folder and returns its files there.
        seed: from which every random draw derives, None where there is none or the inputs state several.
        measured: see `Measured`.
    """

    def write_all(part: Path) -> list[Path]:
        paths = list(write(part))
        invocation = statement.current_invocation()
        if invocation is None:
            return paths
        outputs = {path.relative_to(part).as_posix(): path for path in paths}
        manifest = describe(invocation, folder, outputs, statement.list_versions(), seed, measured or {})
        return [*paths, write_json(part / statement.MANIFEST, manifest)]

    return write_together(folder, write_all)


def describe(
    invocation: statement.Invocation,
    folder: Path,
    outputs: Mapping[str, Path],
    versions: Mapping[str, str],
    seed: int | None = None,
    measured: Measured | None = None,
) -> statement.Manifest:
    """Return the manifest that a folder gets of the command at work, which wrote `outputs`, paths by name."""
    place = Path(os.path.abspath(folder))
    return statement.Manifest(
        command=invocation.command,
        arguments=invocation.arguments,
        directory=statement.relate(invocation.directory, place),
        folder=place.name,
        versions=versions,
        platform=statement.list_platform(),
        own_code=[statement.state_file(statement.relate(path, place), path.read_bytes()) for path in used_files()],
        inputs=[
            stated._replace(path=_name(path, place))
            for path, stated in sorted(invocation.reads.items())
            # Drafts that were read back are gone; a sweep that is gone on with reads the manifest that this one
            # replaces.
            if path.is_file() and path != place / statement.MANIFEST
        ],
        outputs=[statement.state_file(name, path.read_bytes()) for name, path in outputs.items()],
        measured={name: fields for name, fields in (measured or {}).items() if name in outputs},
        seed=seed,
    )


def _name(path: Path, folder: Path) -> str:
    """Return the path of an input relative to the folder of the manifest, or as an example of seatsim."""
    for examples in EXAMPLES:
        if path.is_relative_to(examples):
            return f"{EXAMPLE}{path.relative_to(examples).as_posix()}"
    return statement.relate(path, folder)
