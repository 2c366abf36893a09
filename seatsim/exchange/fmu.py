"""A block as a functional mock-up unit: description, sources, and a library for this platform, in one archive."""

from __future__ import annotations

import platform
import re
import sys
import uuid
import zipfile
from collections.abc import Mapping
from hashlib import sha256
from pathlib import Path

from seatsim.exchange.blocks.base import Block
from seatsim.exchange.compiler import compile_library
from seatsim.exchange.description import Unit, describe_build, describe_fmi2, describe_fmi3
from seatsim.exchange.model_source import print_model, print_variables, resource
from seatsim.exchange.variables import list_variables
from seatsim.schema.files import write_whole
from seatsim.schema.leftovers import temporary_folder

FIRST_DAY = (1980, 1, 1, 0, 0, 0)
"""The date of the files in the archive, so that the same model gives the same archive."""
LONGEST_NAME = 60
"""Letters of a block's name that its files are called by, from its end."""
FOLDERS = {"Linux": "linux", "Darwin": "darwin", "Windows": "win"}
ENDINGS = {"Linux": ".so", "Darwin": ".dylib", "Windows": ".dll"}


def write_fmu(block: Block, version: int, path: Path) -> None:
    """Write a block as an FMU of version 2 or 3.

    Raises:
        InputError: this machine has no C compiler, a function has no counterpart in C, or the file cannot be written.
        RunError: the compiler failed. OutputError: the disk is full.
    """
    files = make_files(block, version)
    with temporary_folder() as folder:
        for name, content in files.items():
            (Path(folder) / Path(name).name).write_bytes(content)
        library = Path(folder) / "library"
        compile_library(Path(folder) / f"fmi{version}.c", library)
        binary = f"binaries/{_platform_folder(version)}/{identifier(block)}{ENDINGS.get(platform.system(), '.so')}"
        files[binary] = library.read_bytes()
    write_whole(path, lambda part: _pack(files, part))


def _pack(files: Mapping[str, bytes], path: Path) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name, FIRST_DAY), content, zipfile.ZIP_DEFLATED)


def make_files(block: Block, version: int) -> dict[str, bytes]:
    """Return the description and the sources of an FMU by their names in the archive."""
    variables = list_variables(block)
    model = print_model(block) + "\n" + print_variables(variables)
    token = f"{{{uuid.UUID(sha256(model.encode()).hexdigest()[:32])}}}"
    model += f'\n#define TOKEN "{token}"\n'
    unit = Unit(block, variables, identifier(block), token)
    described = describe_fmi2(unit) if version == 2 else describe_fmi3(unit)
    sources = {"model.h": model, "instance.h": resource("instance.h"), f"fmi{version}.c": resource(f"fmi{version}.c")}
    files = {"modelDescription.xml": described}
    files |= {f"sources/{name}": text.encode() for name, text in sources.items()}
    return files | ({"sources/buildDescription.xml": describe_build(unit)} if version == 3 else {})


def identifier(block: Block) -> str:
    """Return the name of a block as C permits it, and as a part of a file's name."""
    name = re.sub(r"\W+", "_", block.name, flags=re.ASCII).strip("_")[-LONGEST_NAME:]
    return f"m_{name}" if name[:1].isdigit() else name


def _platform_folder(version: int) -> str:
    """Return the folder of this platform's library as the version of the standard names it."""
    if version == 2:
        return FOLDERS.get(platform.system(), "linux") + ("64" if sys.maxsize > 2**32 else "32")
    machine = {"AMD64": "x86_64", "arm64": "aarch64"}.get(platform.machine(), platform.machine())
    return f"{machine}-{ {'Linux': 'linux', 'Darwin': 'darwin', 'Windows': 'windows'}.get(platform.system(), 'linux') }"
