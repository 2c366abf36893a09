"""Universal files (UFF58), read by pyuff: every data set that is a response over time is a channel."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import cast

import numpy as np

from seatsim.importing.readers.naming import note_left_out
from seatsim.importing.readers.reading import TextLayout, need
from seatsim.importing.signals import Channels, DataFile, Signal
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.schema.units import DIMENSIONS, conversion

FUNCTION = 58
"""Type of a data set that is a function."""
FUNCTIONS = """a general function, a time response, an auto spectrum, a cross spectrum, a frequency response,
a transmissibility, a coherence, an auto correlation, a cross correlation, a power spectral density,
an energy spectral density, a probability density, a spectrum""".replace("\n", " ").split(", ")
"""What functions are by the number of their type; those over time are the first two."""
OVER_TIME, TIME_AXIS = (0, 1), (0, 17)
"""Types of functions, and of the quantity along the abscissa (0 is not stated)."""
OF_LINE = 6
"""Values of a line, up to which the last one is filled with zeros."""
NAMES = ("rsp_ent_name", "id1", "id5", "ordinate_axis_lab", "id2")
NONE = ("", "none", "notset", "not set", "general", "unknown")


def read(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the time responses, those of equal length, step and start, or of the same times, as one group."""
    pyuff = need("pyuff", "UFF58")
    if not content.rstrip().endswith(b"-1"):
        raise InputError(f"{path}: its last data set has no end (-1); the file is truncated: export it again")
    gathered = Channels()
    others = []
    with tempfile.NamedTemporaryFile(suffix=".uff") as file:  # pyuff reads names of files alone
        file.write(content)
        file.flush()
        sets = pyuff.UFF(file.name)
        kinds = [int(kind) for kind in sets.get_set_types()]
        for index, kind in enumerate(kinds):
            held = cast("Mapping[str, object]", sets.read_sets(index)) if kind == FUNCTION else {}
            reason = _why_not(kind, held)
            if reason:
                others.append(f"data set {index + 1} is {reason}")
                continue
            signal, times = _signal(f"{path}, data set {index + 1}", held)
            if held.get("abscissa_spacing") == 0:
                gathered.add_timed("", times, [signal])
            else:
                step = round(float(np.mean(np.diff(times))), 12) if len(times) > 1 else 0.0
                gathered.add("", signal, 1.0 / step if step else None, float(times[0]) if len(times) else 0.0)
    return DataFile(path, "", gathered.groups(), note_left_out("left out, as they are no responses over time", others))


def _why_not(kind: int, held: Mapping[str, object]) -> str:
    """Return what a data set is if it is no response over time, else an empty text."""
    if kind != FUNCTION:
        return f"no function, but of type {kind}"
    function, axis = (int(cast("int", held[key]) or 0) for key in ("func_type", "abscissa_spec_data_type"))
    if function not in OVER_TIME:
        return FUNCTIONS[function] if 0 < function < len(FUNCTIONS) else f"a function of type {function}"
    return "" if axis in TIME_AXIS else f"a function over {str(held['abscissa_axis_lab']).strip() or axis}"


def _signal(place: str, held: Mapping[str, object]) -> tuple[Signal, Array]:
    """Return a channel and its times in s."""
    values, times = _array(held, "data"), _array(held, "x")
    stated = int(cast("int", held["num_pts"]))
    if min(len(values), len(times)) < stated:
        raise InputError(f"{place}: has {len(values)} of {stated} values; the file is truncated: export it again")
    if len(values) >= stated + OF_LINE:
        raise InputError(f"{place}: has {len(values)} values where it states {stated}; correct the number of them")
    name = next((str(held[key]).strip() for key in NAMES if str(held.get(key, "")).strip().lower() not in NONE), "")
    node = f"{held.get('rsp_node', '')}:{held.get('rsp_dir', '')}"
    unit = _unit(held, "ordinate_axis_units_lab")
    of_time = conversion(_unit(held, "abscissa_axis_units_lab") or "s", DIMENSIONS["time"]).factor
    return Signal(name or node, unit, values[:stated]), of_time * times[:stated]


def _unit(held: Mapping[str, object], key: str) -> str:
    unit = str(held.get(key, "")).strip()
    return "" if unit.lower() in NONE else unit


def _array(held: Mapping[str, object], key: str) -> Array:
    return np.real(np.asarray(held[key])).astype(np.float64)
