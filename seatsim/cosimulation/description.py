"""What a functional mock-up unit says of itself, read with suspicion, and whether a scenario's mapping fits it.

Nothing of a unit runs here, and nothing of its archive is written outside a temporary folder.
"""

from __future__ import annotations

import io
import platform
import re
import stat
import sys
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path, PurePosixPath
from types import ModuleType
from typing import TYPE_CHECKING, NamedTuple

from seatsim.schema.errors import InputError, nearest, placed
from seatsim.schema.guarded import in_mib, read_bytes, temporary_folder
from seatsim.schema.modules import LARGEST_UNIT
from seatsim.schema.units import Conversion, conversion
from seatsim.schema.validation import is_finite_number

if TYPE_CHECKING:
    from fmpy.model_description import ModelDescription, ScalarVariable

_UNPACKED = 4
"""What an archive holds may be this much larger than the largest archive."""
_LARGEST_DESCRIPTION = 16 * 2**20
_MOST_FILES = 10_000
DESCRIPTION = "modelDescription.xml"
_SYSTEMS = {
    "Linux": ("linux", "linux", ".so"),
    "Darwin": ("darwin", "darwin", ".dylib"),
    "Windows": ("win", "windows", ".dll"),
}
"""Names of an operating system in versions 2 and 3, and the ending of its libraries."""
_MACHINES = {"AMD64": "x86_64", "arm64": "aarch64"}


@contextmanager
def open_archive(path: Path) -> Iterator[zipfile.ZipFile]:
    """Open the archive of a unit whose names and sizes are as they must be.

    Raises:
        InputError: it is unreadable, is no archive or has no description, holds links, too much, or a path elsewhere.
    """
    content = read_bytes(path, LARGEST_UNIT, "a functional mock-up unit (.fmu)")
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            _check_entries(path, archive.infolist())
            yield archive
    except (zipfile.BadZipFile, NotImplementedError, EOFError, RuntimeError, ValueError, zlib.error) as error:
        raise InputError(f"{path}: is no archive of a functional mock-up unit: {error}") from error


def _check_entries(path: Path, entries: list[zipfile.ZipInfo]) -> None:
    if len(entries) > _MOST_FILES:
        raise InputError(f"{path}: holds {len(entries)} files; permitted: at most {_MOST_FILES}")
    size = sum(entry.file_size for entry in entries)
    if size > _UNPACKED * LARGEST_UNIT:
        problem = f"{path}: holds {in_mib(size)} unpacked; permitted: at most {in_mib(_UNPACKED * LARGEST_UNIT)}"
        raise InputError(problem)
    for entry in entries:
        name = entry.orig_filename
        parts = PurePosixPath(name).parts
        if ".." in parts or name.startswith("/") or any(sign in name for sign in "\\:\0"):
            raise InputError(f"{path}: holds {name!r}, which lies outside the unit's folder; nothing was unpacked")
        if stat.S_ISLNK(entry.external_attr >> 16):
            raise InputError(f"{path}: holds {name!r}, which is a link; a unit has files and folders only")
    if DESCRIPTION not in {entry.filename for entry in entries}:
        raise InputError(f"{path}: has no {DESCRIPTION}, so that it is no functional mock-up unit")


def _read_description(path: Path, archive: zipfile.ZipFile) -> bytes:
    """Return the text of `modelDescription.xml`, without what an XML parser could be made to follow.

    Raises:
        InputError: it is too large, or declares a document type.
    """
    if archive.getinfo(DESCRIPTION).file_size > _LARGEST_DESCRIPTION:
        raise InputError(f"{path}: its {DESCRIPTION} has more than {in_mib(_LARGEST_DESCRIPTION)}")
    text = archive.read(DESCRIPTION)
    if b"<!DOCTYPE" in text or b"<!ENTITY" in text:
        raise InputError(f"{path}: its {DESCRIPTION} declares a document type, which the standard does not have")
    return text


def name_library(version: int, identifier: str) -> str:
    """Return where the library for this machine stands in an archive, as a version of the standard names it."""
    older, newer, ending = _SYSTEMS.get(platform.system(), _SYSTEMS["Linux"])
    machine = _MACHINES.get(platform.machine(), platform.machine())
    here = f"{older}{64 if sys.maxsize > 2**32 else 32}" if version == 2 else f"{machine}-{newer}"
    return f"binaries/{here}/{identifier}{ending}"


def find_library(path: Path, archive: zipfile.ZipFile, version: int, identifier: str) -> str:
    """Return the name within the archive of the library for this machine.

    Raises:
        InputError: there is none; the error names the platforms that the unit is for.
    """
    name = name_library(version, identifier)
    if name in archive.namelist():
        return name
    found = sorted({entry.split("/")[1] for entry in archive.namelist() if entry.startswith("binaries/")} - {""})
    other = f"it has libraries for {', '.join(found)}" if found else "it has no library at all"
    problem = f"{path}: has no {name}, the library for this machine; {other}; ask its supplier for this platform"
    raise InputError(problem)


@contextmanager
def unpack(path: Path, version: int, identifier: str) -> Iterator[tuple[Path, Path]]:
    """Unpack libraries of this machine and resources to a temporary folder; give it and the library.

    The folder is removed afterwards, also where a run is interrupted.
    """
    with temporary_folder("seatsim-fmu-") as folder:
        with open_archive(path) as archive:
            library = find_library(path, archive, version, identifier)
            wanted = (f"{library.rpartition('/')[0]}/", "resources/")
            archive.extractall(folder, [entry for entry in archive.namelist() if entry.startswith(wanted)])
        (folder / "resources").mkdir(exist_ok=True)
        yield folder, folder / library


QUANTITIES = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s^2", "current": "A", "temperature": "degC"}
"""What an input of a damper may take, in its unit: motion positive in extension, current of the coil."""
FORCE = "force"
REAL = ("Real", "Float64")
_SETTABLE = {"Real": float, "Float64": float, "Integer": int, "Int32": int, "Boolean": bool}
"""Types of parameters that a scenario may state."""


class UnitDescription(NamedTuple):
    """Version of the standard, identifier in C, variables by name, whether a state can be saved and restored."""

    version: int
    identifier: str
    described: ModelDescription
    variables: Mapping[str, ScalarVariable]
    saves: bool


def need_fmpy() -> ModuleType:
    """Return FMPy.

    Raises:
        InputError: it is not installed.
    """
    try:
        return import_module("fmpy")
    except ImportError as error:
        raise InputError('a damper that is an FMU runs by fmpy; install it with: pip install "seatsim[fmu]"') from error


def describe_unit(path: Path) -> UnitDescription:
    """Return what a unit for co-simulation says of itself.

    Raises:
        InputError: the archive is not one of a unit, its description cannot be read, it is of a version or kind that
            does not step itself, or it has no library for this machine.
    """
    need_fmpy()
    from fmpy.model_description import read_model_description

    with open_archive(path) as archive:
        text = _read_description(path, archive)
        stated = re.search(rb"""fmiVersion\s*=\s*["']([^"']*)""", text)
        version = {b"2": 2, b"3": 3}.get(stated[1].partition(b".")[0]) if stated else None
        if version is None:
            said = stated[1].decode(errors="replace") if stated else "no version"
            raise InputError(f"{path}: is of FMI {said}; permitted: 2.0 and 3.0")
        try:
            # An archive that holds the description alone is what FMPy reads.
            with zipfile.ZipFile(alone := io.BytesIO(), "w") as described_only:
                described_only.writestr("modelDescription.xml", text)
            described = read_model_description(alone, validate=False)
        except Exception as error:  # lxml's and FMPy's own errors have no common class
            said = str(error).strip().split("\n")[0]
            raise InputError(f"{path}: its description cannot be read: {said}") from error
        model = described.coSimulation
        if model is None:
            raise InputError(f"{path}: is not for co-simulation, as a damper must be")
        identifier = str(model.modelIdentifier)
        find_library(path, archive, version, identifier)
    saves = getattr(model, "canGetAndSetFMUstate", False) or getattr(model, "canGetAndSetFMUState", False)
    variables = {v.name: v for v in described.modelVariables}
    return UnitDescription(version, identifier, described, variables, bool(saves))


def find_variable(unit: UnitDescription, name: str, causality: str) -> ScalarVariable:
    """Return a variable of a unit that must have a causality and, as input or output, be a real number.

    Raises:
        InputError: there is none of this name, or it is another kind of variable.
    """
    fitting = [n for n, v in unit.variables.items() if v.causality == causality]
    if name not in unit.variables:
        listed = ", ".join(fitting[:20]) or "none"
        raise InputError(f"the unit has no variable '{name}'{nearest(name, fitting)}; its {causality}s: {listed}")
    found = unit.variables[name]
    if found.causality != causality:
        raise InputError(f"'{name}' is declared as {found.causality}, not as {causality}{nearest(name, fitting)}")
    types = tuple(_SETTABLE) if causality == "parameter" else REAL
    if found.type not in types or getattr(found, "dimensions", None):
        kind = f"an array of {found.type}" if getattr(found, "dimensions", None) else str(found.type)
        raise InputError(f"'{name}' is declared as {kind}; permitted: {', '.join(types)}")
    return found


def check_parameter(unit: UnitDescription, name: str, value: object) -> float:
    """Return the value of a parameter, which must be of its type and within its bounds.

    Raises:
        InputError: it is not.
    """
    found = find_variable(unit, name, "parameter")
    kind = _SETTABLE[found.type]
    is_right = isinstance(value, bool) if kind is bool else is_finite_number(value) and kind(value) == value
    if not (is_right and isinstance(value, int | float)):
        word = {float: "a number", int: "a whole number", bool: "true or false"}[kind]
        raise InputError(f"{value!r} is not permitted; '{name}' is {word}")
    for limit, low in ((found.min, True), (found.max, False)):
        if limit is not None and (value < float(limit) if low else value > float(limit)):
            raise InputError(f"{value!r} is not permitted; the unit states at {'least' if low else 'most'} {limit}")
    return value


def find_conversion_of(variable: ScalarVariable, quantity: str) -> Conversion:
    """Return how a variable's values become those of a quantity in its unit; a variable without unit has that one.

    Raises:
        InputError: its unit is of another quantity.
    """
    wanted = QUANTITIES.get(quantity, "N")
    with placed(f"'{variable.name}' cannot be the {quantity}"):
        return conversion(str(variable.unit), wanted) if variable.unit else Conversion(1.0)
