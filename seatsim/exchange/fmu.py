"""A block as a functional mock-up unit: description, sources, and a library for this platform, in one archive."""

from __future__ import annotations

import math
import platform
import re
import uuid
import zipfile
from collections.abc import Mapping, Sequence
from hashlib import sha256
from pathlib import Path
from typing import NamedTuple
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import seatsim
from seatsim.cosimulation.description import name_library
from seatsim.exchange.block import Block, Variable, list_variables
from seatsim.exchange.c_source import print_model, print_variables, resource
from seatsim.exchange.compiler import compile_library
from seatsim.schema.files import write_whole
from seatsim.schema.guarded import temporary_folder

_FIRST_DAY = (1980, 1, 1, 0, 0, 0)
"""The date of the files in the archive, so that the same model gives the same archive."""
_LONGEST_NAME = 60
"""Letters of a block's name that its files are called by, from its end."""
_TYPES = {float: ("Real", "Float64"), int: ("Integer", "Int32"), bool: ("Boolean", "Boolean")}
"""Names of types in versions 2.0 and 3.0."""


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
        files[name_library(version, identifier(block))] = library.read_bytes()
    write_whole(path, lambda part: _pack(files, part))


def _pack(files: Mapping[str, bytes], path: Path) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name, _FIRST_DAY), content, zipfile.ZIP_DEFLATED)


def make_files(block: Block, version: int) -> dict[str, bytes]:
    """Return the description and the sources of an FMU by their names in the archive."""
    variables = list_variables(block)
    model = print_model(block) + "\n" + print_variables(variables)
    token = f"{{{uuid.UUID(sha256(model.encode()).hexdigest()[:32])}}}"
    model += f'\n#define TOKEN "{token}"\n'
    unit = _Unit(block, variables, identifier(block), token)
    sources = {"model.h": model, "instance.h": resource("instance.h"), f"fmi{version}.c": resource(f"fmi{version}.c")}
    files = {"modelDescription.xml": _describe(unit, version)}
    files |= {f"sources/{name}": text.encode() for name, text in sources.items()}
    return files | ({"sources/buildDescription.xml": _describe_build(unit)} if version == 3 else {})


def identifier(block: Block) -> str:
    """Return the name of a block as C permits it, and as a part of a file's name."""
    name = re.sub(r"\W+", "_", block.name, flags=re.ASCII).strip("_")[-_LONGEST_NAME:]
    return f"m_{name}" if name[:1].isdigit() else name


class _Unit(NamedTuple):
    """What is described: a block with its variables, its identifier in C and its token."""

    block: Block
    variables: Sequence[Variable]
    identifier: str
    token: str


def _describe(unit: _Unit, version: int) -> bytes:
    """Return `modelDescription.xml` in version 2.0 or 3.0; of the latter the time is a variable, after the last."""
    block, is_second = unit.block, version == 2
    sentences = [block.summary + ".", *(f"{note[0].upper()}{note[1:]}." for note in block.notes)]
    stated = {"fmiVersion": f"{version}.0", "modelName": block.name, "description": " ".join(sentences)}
    stated |= {"generationTool": f"seatsim {seatsim.__version__}"}
    stated |= {"guid" if is_second else "instantiationToken": unit.token, "variableNamingConvention": "structured"}
    root = Element("fmiModelDescription", stated | ({"numberOfEventIndicators": "0"} if is_second else {}))
    model = SubElement(root, "CoSimulation", {"modelIdentifier": unit.identifier} | _abilities(block, is_second))
    if is_second:
        SubElement(SubElement(model, "SourceFiles"), "File", {"name": "fmi2.c"})
    units = SubElement(root, "UnitDefinitions")
    for name in dict.fromkeys([*filter(None, map(_unit_name, unit.variables)), "s"]):
        SubElement(units, "Unit", {"name": name})
    categories = SubElement(root, "LogCategories")
    SubElement(categories, "Category", {"name": "logStatusError", "description": "what was refused, and why"})
    SubElement(root, "DefaultExperiment", {"startTime": "0", "stopTime": "10", "stepSize": repr(block.step)})
    _add_variables(root, unit.variables, is_second)
    return _text(root)


def _abilities(block: Block, is_second: bool) -> dict[str, str]:
    """Return what a unit can do, as the version of the standard names it."""
    own = "InterpolateInputs GetAndSetFMUstate SerializeFMUstate NotUseMemoryManagementFunctions"
    names = own if is_second else "GetAndSetFMUState SerializeFMUState"
    step = {"fixedInternalStepSize": repr(block.step)} if block.fixed_step and not is_second else {}
    return {f"can{name}": "true" for name in ("HandleVariableCommunicationStepSize", *names.split())} | step


def _add_variables(root: Element, variables: Sequence[Variable], is_second: bool) -> None:
    """Add all variables, and which of them are outputs."""
    listed = SubElement(root, "ModelVariables")
    structure = SubElement(root, "ModelStructure")
    for number, v in enumerate(variables):
        place, meaning = {"name": v.name, "valueReference": str(number)}, {"description": v.meaning}
        if is_second:
            scalar = SubElement(listed, "ScalarVariable", place | _kind(v) | meaning)
            SubElement(scalar, _TYPES[type(v.value)][0], _numbers(v))
        else:
            SubElement(listed, _TYPES[type(v.value)][1], place | meaning | _kind(v) | _numbers(v))
    outputs = [k for k, v in enumerate(variables) if v.causality == "output"]
    if is_second:
        for name in ("Outputs", "InitialUnknowns"):
            group = SubElement(structure, name)
            for k in outputs:
                SubElement(group, "Unknown", {"index": str(k + 1)})
        return
    time = {"name": "time", "valueReference": str(len(variables)), "causality": "independent"}
    SubElement(listed, "Float64", time | {"variability": "continuous", "unit": "s", "description": "time"})
    for name in ("Output", "InitialUnknown"):
        for k in outputs:
            SubElement(structure, name, {"valueReference": str(k)})


def _describe_build(unit: _Unit) -> bytes:
    """Return `buildDescription.xml`, by which a program builds the sources of version 3.0."""
    root = Element("fmiBuildDescription", {"fmiVersion": "3.0"})
    build = SubElement(root, "BuildConfiguration", {"modelIdentifier": unit.identifier})
    files = SubElement(build, "SourceFileSet", {"language": "C99", "compilerOptions": "-ffp-contract=off"})
    SubElement(files, "SourceFile", {"name": "fmi3.c"})
    if platform.system() != "Windows":
        SubElement(build, "Library", {"name": "m"})
    return _text(root)


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


def _text(root: Element) -> bytes:
    indent(root)
    return bytes(tostring(root, encoding="utf-8", xml_declaration=True))
