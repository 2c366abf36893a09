"""Names that programs give to the parts of a channel in MAT files, and variables that names alone hold together."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np

from seatsim.importing.readers.mat_values import Value
from seatsim.importing.readers.naming import UNITS, bare

VALUES = ("values", "data", "signal", "samples", "y", "ydata")
LABELS = ("label", "signalname", "channelname", "name", "title", "blockname")
TIMES = ("time", "t", "zeit", "temps", "timestamp", "timestamps", "tout")
ABSCISSAS = (*TIMES, "x", "xdata")
STARTS = ("x0", "xoffset", "xorg", "start")
"""Fields of a structure that is a channel: its values, its name, its times in s, and the time in s of its first value.
Names stand here without underscores and capitals."""
INDEX = "xindex"
"""Field that says which of several vectors of times a channel has, counted from 1 (dSPACE)."""
TIME_INFO = "timeinfo"
UNITS_OF_TIME = ("xunit", "xunits", "unitx", "timeunit", "timeunits")
"""A structure that states the unit of times, and fields that do."""
BESIDE = (TIME_INFO, "header", "info", "datainfo", "capture", "meta", "metadata", "fileheader", "attributes")
"""Structures that state something of what stands beside them."""
ENDING = re.compile(
    r"^(.+?)_(data|values|header|unit|units|time|name|label|fs|dt|dx|x0|samplerate|xdelta)$", re.IGNORECASE
)
"""A flat variable that is part of a channel: the name of the channel, and which part it is."""
TIME_WITHIN = re.compile(r"^(.*?)_?time_(.*)$", re.IGNORECASE)


def join_flat(variables: Mapping[str, Value]) -> dict[str, Value]:
    """Return variables, and a structure of each vector with what is called after it."""
    owners = {name: found for name in variables if (found := _owner(name, variables))}
    parts: dict[str, dict[str, Value]] = {owner: {} for owner, _ in owners.values()}
    for name, (owner, part) in owners.items():
        parts[owner][part] = variables[name]
    for owner, held in parts.items():
        if owner in variables:
            held["data"] = variables[owner]
    return {name: value for name, value in variables.items() if name not in owners} | parts


def _owner(name: str, variables: Mapping[str, Value]) -> tuple[str, str] | None:
    """Return the channel of which a variable is a part, and which part; None where it is one of itself."""
    ending = ENDING.match(name)
    if ending:
        beginning, part = ending[1], ending[2].lower()
        if is_vector(variables.get(beginning)):
            return None if part in VALUES else (beginning, part)
        siblings = (variables.get(f"{beginning}_{each}") for each in ("data", "Data", "DATA", "values", "Values"))
        if beginning not in variables and any(is_vector(each) for each in siblings):
            return beginning, part
    within = TIME_WITHIN.match(name)
    partner = f"{within[1]}_{within[2]}".strip("_") if within else ""
    return (partner, "time") if is_vector(variables.get(partner)) else None


def is_vector(value: Value | None) -> bool:
    """Say whether a value is more than one number."""
    return isinstance(value, np.ndarray) and value.size > 1


def statements(structure: Mapping[str, Value]) -> dict[str, Value]:
    """Return the fields of a structure, and those of the structures in it that state something of the others."""
    stated: dict[str, Value] = {}
    for name, value in structure.items():
        if bare(name) in BESIDE and isinstance(value, dict):
            is_of_time = bare(name) == TIME_INFO
            stated |= {each: held for each, held in value.items() if not (is_of_time and bare(each) in UNITS)}
    return stated | dict(structure)
