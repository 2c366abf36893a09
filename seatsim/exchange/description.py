"""`modelDescription.xml` of a functional mock-up unit, in version 2.0 and 3.0 of the standard."""

from __future__ import annotations

import math
import platform
from collections.abc import Sequence
from typing import NamedTuple
from xml.etree import ElementTree

import seatsim
from seatsim.exchange.blocks.base import Block
from seatsim.exchange.variables import Variable

TIME = "time"
TYPES_2 = {float: "Real", int: "Integer", bool: "Boolean"}
TYPES_3 = {float: "Float64", int: "Int32", bool: "Boolean"}
UNIT_NAMES = {"-": "1", "": "1"}


class Unit(NamedTuple):
    """What is described: a block with its variables, its identifier in C and its token."""

    block: Block
    variables: Sequence[Variable]
    identifier: str
    token: str


def describe_fmi2(unit: Unit) -> bytes:
    """Return the description in version 2.0."""
    root = ElementTree.Element("fmiModelDescription", _header(unit, "2.0") | {"guid": unit.token})
    root.set("variableNamingConvention", "structured")
    root.set("numberOfEventIndicators", "0")
    model = ElementTree.SubElement(root, "CoSimulation", {
        "modelIdentifier": unit.identifier, "canHandleVariableCommunicationStepSize": "true",
        "canInterpolateInputs": "true", "canGetAndSetFMUstate": "true", "canSerializeFMUstate": "true",
        "canNotUseMemoryManagementFunctions": "true",
    })  # fmt: skip
    ElementTree.SubElement(ElementTree.SubElement(model, "SourceFiles"), "File", {"name": "fmi2.c"})
    _add_units(root, unit)
    _add_categories(root)
    _add_experiment(root, unit)
    listed = ElementTree.SubElement(root, "ModelVariables")
    for number, v in enumerate(unit.variables):
        scalar = ElementTree.SubElement(listed, "ScalarVariable", {"name": v.name, "valueReference": str(number)})
        scalar.attrib |= _kind(v) | {"description": v.meaning}
        ElementTree.SubElement(scalar, TYPES_2[type(v.value)], _numbers(v))
    structure = ElementTree.SubElement(root, "ModelStructure")
    outputs = [str(k + 1) for k, v in enumerate(unit.variables) if v.causality == "output"]
    for name in ("Outputs", "InitialUnknowns"):
        group = ElementTree.SubElement(structure, name)
        for index in outputs:
            ElementTree.SubElement(group, "Unknown", {"index": index})
    return _text(root)


def describe_fmi3(unit: Unit) -> bytes:
    """Return the description in version 3.0; the time is a variable there, with the number after the last."""
    root = ElementTree.Element("fmiModelDescription", _header(unit, "3.0") | {"instantiationToken": unit.token})
    root.set("variableNamingConvention", "structured")
    ElementTree.SubElement(root, "CoSimulation", {
        "modelIdentifier": unit.identifier, "canHandleVariableCommunicationStepSize": "true",
        "canGetAndSetFMUState": "true", "canSerializeFMUState": "true",
    } | ({"fixedInternalStepSize": repr(unit.block.step)} if unit.block.fixed_step else {}))  # fmt: skip
    _add_units(root, unit)
    _add_categories(root)
    _add_experiment(root, unit)
    listed = ElementTree.SubElement(root, "ModelVariables")
    for number, v in enumerate(unit.variables):
        place = {"name": v.name, "valueReference": str(number), "description": v.meaning}
        ElementTree.SubElement(listed, TYPES_3[type(v.value)], place | _kind(v) | _numbers(v))
    ElementTree.SubElement(listed, "Float64", {
        "name": TIME, "valueReference": str(len(unit.variables)), "causality": "independent",
        "variability": "continuous", "unit": "s", "description": "time",
    })  # fmt: skip
    structure = ElementTree.SubElement(root, "ModelStructure")
    for name in ("Output", "InitialUnknown"):
        for k, v in enumerate(unit.variables):
            if v.causality == "output":
                ElementTree.SubElement(structure, name, {"valueReference": str(k)})
    return _text(root)


def describe_build(unit: Unit) -> bytes:
    """Return `buildDescription.xml`, by which a program builds the sources of version 3.0."""
    root = ElementTree.Element("fmiBuildDescription", {"fmiVersion": "3.0"})
    build = ElementTree.SubElement(root, "BuildConfiguration", {"modelIdentifier": unit.identifier})
    files = ElementTree.SubElement(build, "SourceFileSet", {"language": "C99", "compilerOptions": "-ffp-contract=off"})
    ElementTree.SubElement(files, "SourceFile", {"name": "fmi3.c"})
    ElementTree.SubElement(build, "Library", {"name": "m"}) if platform.system() != "Windows" else None
    return _text(root)


def _header(unit: Unit, version: str) -> dict[str, str]:
    return {
        "fmiVersion": version,
        "modelName": unit.block.name,
        "description": " ".join(
            [unit.block.summary + ".", *(f"{note[0].upper()}{note[1:]}." for note in unit.block.notes)]
        ),
        "generationTool": f"seatsim {seatsim.__version__}",
    }


def _add_units(root: ElementTree.Element, unit: Unit) -> None:
    names = dict.fromkeys(_unit_name(v) for v in unit.variables if _unit_name(v))
    listed = ElementTree.SubElement(root, "UnitDefinitions")
    for name in dict.fromkeys([*names, "s"]):
        ElementTree.SubElement(listed, "Unit", {"name": name})


def _add_categories(root: ElementTree.Element) -> None:
    listed = ElementTree.SubElement(root, "LogCategories")
    ElementTree.SubElement(listed, "Category", {"name": "logStatusError", "description": "what was refused, and why"})


def _add_experiment(root: ElementTree.Element, unit: Unit) -> None:
    ElementTree.SubElement(
        root, "DefaultExperiment", {"startTime": "0", "stopTime": "10", "stepSize": repr(unit.block.step)}
    )


def _unit_name(v: Variable) -> str:
    return UNIT_NAMES.get(v.unit, v.unit) if isinstance(v.value, float) else ""


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


def _text(root: ElementTree.Element) -> bytes:
    ElementTree.indent(root)
    return bytes(ElementTree.tostring(root, encoding="utf-8", xml_declaration=True))
