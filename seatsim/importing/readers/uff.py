"""Universal files (UFF58), read by pyuff: every data set that is a response over time is a channel."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import cast

import numpy as np

from seatsim.importing.optional import need
from seatsim.importing.readers.reading import TextLayout
from seatsim.importing.signals import Array, DataFile, Group, Signal
from seatsim.schema.errors import InputError

FUNCTION, TIME_RESPONSE = 58, (0, 1)
"""Type of a data set that is a function, and what kinds of functions are over time (0 is general)."""
NAMES = ("id1", "id5", "rsp_ent_name", "ordinate_axis_lab", "id2")
NONE = ("", "none", "notset", "not set", "general", "unknown")


def read(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the time responses, those of equal length, step and start as one group."""
    pyuff = need("pyuff", "UFF58")
    if not content.rstrip().endswith(b"-1"):
        raise InputError(f"{path}: its last data set has no end; the file is truncated: export it again")
    parts: dict[tuple[int, float, float], list[Signal]] = {}
    left_out = 0
    with tempfile.NamedTemporaryFile(suffix=".uff") as file:  # pyuff reads names of files alone
        file.write(content)
        file.flush()
        sets = pyuff.UFF(file.name)
        kinds = [int(kind) for kind in sets.get_set_types()]
        for index, kind in enumerate(kinds):
            held = cast("Mapping[str, object]", sets.read_sets(index)) if kind == FUNCTION else {}
            if held.get("func_type") in TIME_RESPONSE:
                key, signal = _signal(path, index, held)
                parts.setdefault(key, []).append(signal)
            else:
                left_out += 1
    groups = [Group("", tuple(signals), 1.0 / step if step else None, start)
              for (_, step, start), signals in parts.items()]  # fmt: skip
    notes = (f"{left_out} data sets that are no response over time are left out",) if left_out else ()
    return DataFile(path, "", tuple(groups), notes)


def _signal(path: Path, index: int, held: Mapping[str, object]) -> tuple[tuple[int, float, float], Signal]:
    values, time = _array(held, "data"), _array(held, "x")
    stated = int(cast("int", held.get("num_pts", len(values))))
    if len(values) != stated or len(time) != stated:
        problem = f"has {len(values)} of {stated} values; the file is truncated: export it again"
        raise InputError(f"{path}, data set {index + 1}: {problem}")
    step = round(float(np.mean(np.diff(time))), 12) if len(time) > 1 else 0.0
    name = next((str(held[key]).strip() for key in NAMES if str(held.get(key, "")).strip().lower() not in NONE), "")
    node = f"{held.get('rsp_node', '')}:{held.get('rsp_dir', '')}"
    unit = str(held.get("ordinate_axis_units_lab", "")).strip()
    signal = Signal(name or node, "" if unit.lower() in NONE else unit, values)
    return (len(values), step, float(time[0]) if len(time) else 0.0), signal


def _array(held: Mapping[str, object], key: str) -> Array:
    return np.real(np.asarray(held[key])).astype(np.float64)
