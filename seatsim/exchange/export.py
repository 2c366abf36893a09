"""A scenario, or a part of it, as a file for another program: a functional mock-up unit (FMU), C, or a MAT file.

An FMU is description, sources, and a library for this platform, in one archive; the C compiler of the system makes the
library of the sources.
"""

import math
import os
import platform
import re
import shutil
import subprocess
import sys
import uuid
import zipfile
from collections.abc import Callable, Mapping, Sequence
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

import seatsim
from seatsim.exchange.block import Block, Variable, list_variables
from seatsim.exchange.blocks.controller import controller_block
from seatsim.exchange.blocks.damper import damper_block
from seatsim.exchange.blocks.rig_motion import rig_block
from seatsim.exchange.c_source import fill, print_c, print_model, print_variables
from seatsim.rig.plant import Plant, control_system, state_space
from seatsim.scenario.scenario import Scenario
from seatsim.schema.errors import InputError, RunError, nearest
from seatsim.schema.files import write_text, write_whole
from seatsim.schema.guarded import temporary_folder
from seatsim.schema.registry import Record

_LONGEST_NAME = 31
"""Letters that a name in a MAT file may have."""
BLOCKS: dict[str, Callable[[Scenario], Block]] = {
    "rig": rig_block,
    "damper": damper_block,
    "controller": controller_block,
}
"""What can be exported."""


def export(scenario: Scenario, form: str, what: str, path: Path) -> Block:
    """Write a scenario's rig, damper or controller to a file and return what was written.

    Args:
        scenario: one run.
        form: "fmu2" or "fmu3" (co-simulation, with sources), "c" (one C99 file) or "mat" (version 5).
        what: "rig", "damper" or "controller".
        path: the file; its folder is made where it is missing.

    Raises:
        InputError: a name is unknown, a model or law has no counterpart in C, there is no C compiler, or the file
            cannot be written.
        RunError: the compiler failed. OutputError: the disk is full.
    """
    for name, known, kind in ((form, FORMATS, "--to"), (what, BLOCKS, "--what")):
        if name not in known:
            raise InputError(f"{kind} {name}: no such export{nearest(name, known)}; permitted: {', '.join(known)}")
    if path.is_dir():
        raise InputError(f"--out {path}: this is a folder; name the file to be written")
    block = BLOCKS[what](scenario)
    FORMATS[form](block, scenario, path)
    return block


def write_mat(block: Block, scenario: Scenario, path: Path) -> None:
    """Write the parameters of a block and, of a seat, its linear plant.

    `plant` holds A, B, C, D with the names of states, inputs and outputs, and A, B1, B2, C1, C2 as the H-infinity
    synthesis takes them; `parameters` holds the numbers of the block, among them those of the law's design.

    Raises:
        InputError: the file cannot be written. OutputError: the disk is full.
    """
    # Takes its time to load, and only this file format needs it.
    from scipy.io import savemat

    content: dict[str, Any] = {"name": block.name, "step": block.step, "parameters": _as_struct(block.parameters)}
    content["notes"] = np.array(block.notes, dtype=object)
    if scenario.plant is not None:
        content["plant"] = _linear_plant(scenario.plant)
    write_whole(path, lambda part: savemat(str(part), content, appendmat=False, oned_as="row"))


def _linear_plant(plant: Plant) -> Mapping[str, object]:
    system, exact = control_system(plant), state_space(plant)
    names = {"states": ["x [m]", "v [m/s]", "xc [m]", "vc [m/s]"]}
    names |= {"inputs": system.input_labels, "outputs": system.output_labels}
    return (
        {name: getattr(system, name) for name in ("A", "B", "C", "D")}
        | {kind: np.array(each, dtype=object) for kind, each in names.items()}
        | {name: getattr(exact, name) for name in ("B1", "B2", "C1", "C2")}
    )


def _as_struct(value: object) -> object:
    """Return a record as a struct, a tuple of numbers as a row or matrix, other tuples as a struct by position."""
    if hasattr(value, "_fields"):
        record: Record = value  # type: ignore[assignment]  # has the fields of one
        items = {name: _as_struct(item) for name, item in record._asdict().items()}
        there = {name: item for name, item in items.items() if not isinstance(item, dict | np.ndarray) or len(item)}
        return {name[:_LONGEST_NAME]: item for name, item in there.items()}
    if isinstance(value, tuple):
        if all(isinstance(item, int | float) for item in value) or all(_is_row(item) for item in value):
            return np.array(value, dtype=float)
        return {type(item).__name__[:_LONGEST_NAME]: _as_struct(item) for item in value}
    return value


def _is_row(item: object) -> bool:
    return isinstance(item, tuple) and not hasattr(item, "_fields") and all(isinstance(v, int | float) for v in item)


_FIRST_DAY = (1980, 1, 1, 0, 0, 0)
"""The date of the files in the archive, so that the same model gives the same archive."""
_LONGEST_IDENTIFIER = 60
"""Letters of a block's name that its files are called by, from its end."""
_TYPES = {float: ("Real", "Float64"), int: ("Integer", "Int32"), bool: ("Boolean", "Boolean")}
"""Names of types in versions 2.0 and 3.0."""
_SYSTEMS = {
    "Linux": ("linux", "linux", ".so"),
    "Darwin": ("darwin", "darwin", ".dylib"),
    "Windows": ("win", "windows", ".dll"),
}
"""Names of an operating system in versions 2 and 3, and the ending of its libraries."""
_MACHINES = {"AMD64": "x86_64", "arm64": "aarch64"}
FLAGS = ("-std=c99", "-O2", "-fPIC", "-shared", "-fvisibility=hidden", "-ffp-contract=off")
"""Without `-ffp-contract=off` a compiler may fuse products and sums, and results would differ between machines."""
_QUICK = ("-fno-math-errno", "-fno-trapping-math", "-fschedule-insns", "-fsched-pressure")
"""Nothing reads `errno` or the flags of floating-point exceptions, instructions may be moved: results stay the same."""


def write_fmu(block: Block, version: int, path: Path) -> None:
    """Write a block as an FMU of version 2 or 3.

    Raises:
        InputError: this machine has no C compiler, a function has no counterpart in C, or the file cannot be written.
        RunError: the compiler failed. OutputError: the disk is full.
    """
    files = make_files(block, version)
    with temporary_folder() as folder:
        for name, content in files.items():
            (folder / Path(name).name).write_bytes(content)
        library = folder / "library"
        _compile_library(folder / f"fmi{version}.c", library)
        files[_name_library(version, identifier(block))] = library.read_bytes()

    def pack(part: Path) -> None:
        with zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, content in files.items():
                archive.writestr(zipfile.ZipInfo(name, _FIRST_DAY), content, zipfile.ZIP_DEFLATED)

    write_whole(path, pack)


def make_files(block: Block, version: int) -> dict[str, bytes]:
    """Return the description and the sources of an FMU by their names in the archive."""
    variables = list_variables(block)
    model = print_model(block) + "\n" + print_variables(variables)
    token = f"{{{uuid.UUID(sha256(model.encode()).hexdigest()[:32])}}}"
    model += f'\n#define TOKEN "{token}"\n'
    sources = {"model.h": model} | {name: fill(f"c/{name}") for name in ("instance.h", f"fmi{version}.c")}
    files = {"modelDescription.xml": _describe(block, variables, version, token)}
    files |= {f"sources/{name}": text.encode() for name, text in sources.items()}
    if version == 3:
        described = fill("fmi/buildDescription.xml", identifier=identifier(block), system=platform.system())
        files["sources/buildDescription.xml"] = described.encode()
    return files


def _name_library(version: int, identifier: str) -> str:
    """Return where the library for this machine stands in an archive, as a version of the standard names it."""
    older, newer, ending = _SYSTEMS.get(platform.system(), _SYSTEMS["Linux"])
    machine = _MACHINES.get(platform.machine(), platform.machine())
    here = f"{older}{64 if sys.maxsize > 2**32 else 32}" if version == 2 else f"{machine}-{newer}"
    return f"binaries/{here}/{identifier}{ending}"


def identifier(block: Block) -> str:
    """Return the name of a block as C permits it, and as a part of a file's name."""
    name = re.sub(r"\W+", "_", block.name, flags=re.ASCII).strip("_")[-_LONGEST_IDENTIFIER:]
    return f"m_{name}" if name[:1].isdigit() else name


def _describe(block: Block, variables: Sequence[Variable], version: int, token: str) -> bytes:
    """Return `modelDescription.xml` in version 2.0 or 3.0; of the latter the time is a variable, after the last."""
    sentences = [block.summary + ".", *(f"{note[0].upper()}{note[1:]}." for note in block.notes)]
    words: dict[str, object] = {"block": block, "version": version, "token": token, "identifier": identifier(block)}
    words |= {"description": " ".join(sentences), "tool": f"seatsim {seatsim.__version__}"}
    words["units"] = dict.fromkeys([*filter(None, map(_unit_name, variables)), "s"])
    words["variables"] = [
        {"type": _TYPES[type(v.value)][version - 2], "kind": _kind(v), "numbers": _numbers(v)} | v._asdict()
        for v in variables
    ]
    words["outputs"] = [k for k, v in enumerate(variables) if v.causality == "output"]
    return fill("fmi/modelDescription.xml", **words).encode()


def _unit_name(v: Variable) -> str:
    return {"-": "1", "": "1"}.get(v.unit, v.unit) if isinstance(v.value, float) else ""


def _kind(v: Variable) -> dict[str, str]:
    """Return causality and variability of a variable, and where its first value comes from."""
    if v.causality == "parameter":
        return {"causality": "parameter", "variability": "tunable", "initial": "exact"}
    variability = "continuous" if isinstance(v.value, float) else "discrete"
    found = {"causality": v.causality, "variability": variability}
    return found | ({"initial": "calculated"} if v.causality == "output" else {})


def _numbers(v: Variable) -> dict[str, str]:
    """Return unit, bounds and first value of a variable; an output is computed."""
    found = {"unit": _unit_name(v)} if _unit_name(v) else {}
    for name, limit in (("min", v.low), ("max", v.high)):
        if math.isfinite(limit) and not isinstance(v.value, bool):
            found[name] = repr(limit) if isinstance(v.value, float) else str(int(limit))
    if v.causality != "output":
        found["start"] = str(v.value).lower() if isinstance(v.value, bool) else repr(v.value)
    return found


def find_compiler() -> str:
    """Return the path of the C compiler: that of the variable CC, or cc, gcc or clang.

    Raises:
        InputError: there is none, or not the one that CC names.
    """
    chosen = _read_choice()[:1]
    found = next(filter(None, map(shutil.which, chosen or ("cc", "gcc", "clang"))), None)
    if found:
        return found
    if chosen:
        raise InputError(f"the variable CC names '{chosen[0]}', and there is no such program; name one that is there")
    raise InputError(
        "an FMU is compiled, and this machine has no C compiler: install gcc or clang (Debian: apt install gcc),"
        " or name one by CC; '--to c' needs none"
    )


def _read_choice() -> list[str]:
    """Return the words of the variable CC: a compiler, and flags that every use of it has."""
    return os.environ.get("CC", "").split()


def _compile_library(source: Path, library: Path) -> None:
    """Compile a C file into a shared library.

    Raises:
        InputError: there is no compiler.
        RunError: it refused the source.
    """
    command = [find_compiler(), *_read_choice()[1:], *FLAGS, *_QUICK, "-o", str(library), str(source), "-lm", "-s"]
    # Its own temporary files stand beside the library, whose folder is removed also where the export is interrupted.
    own = os.environ | dict.fromkeys(("TMPDIR", "TMP", "TEMP"), str(library.parent))
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=own)
    if done.returncode:
        raise RunError(f"{command[0]} could not compile {source.name}: {done.stderr.strip()[:500]}")


FORMATS: dict[str, Callable[[Block, Scenario, Path], object]] = {
    "fmu2": lambda block, scenario, path: write_fmu(block, 2, path),
    "fmu3": lambda block, scenario, path: write_fmu(block, 3, path),
    "c": lambda block, scenario, path: write_text(path, print_c(block)),
    "mat": write_mat,
}
"""What a file can be."""
