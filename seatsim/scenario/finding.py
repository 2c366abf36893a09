"""Where scenario files are: at their path, or among the examples that ship with seatsim."""

from __future__ import annotations

from pathlib import Path

from seatsim.schema.errors import InputError, nearest
from seatsim.schema.guarded import is_there

EXAMPLES = (Path(__file__).parents[1] / "examples", Path(__file__).parents[2] / "scenarios")
"""The examples: within an installed package, or beside the package in a clone."""


def find_file(path: Path) -> Path:
    """Return the path of a scenario file, or of the example that has this name.

    Raises:
        InputError: there is neither.
    """
    if is_there(path):
        return path
    if not path.is_absolute():
        inside = Path(*path.parts[1:]) if path.parts[:1] == ("scenarios",) else path
        for folder in EXAMPLES:
            for name in (inside, inside.with_name(f"{inside.name}.yaml")):
                if is_there(folder / name):
                    return folder / name
    found = {path.relative_to(folder) for folder in EXAMPLES if folder.is_dir() for path in folder.rglob("*.yaml")}
    known = sorted(str(path.with_suffix("")) for path in found if "data" not in path.parts)
    near = nearest(path, [*known, *(str(file) for file in path.parent.glob("*.yaml"))])
    raise InputError(f"{path}: no such file{near}; give the path of a scenario, or an example: {', '.join(known)}")
