"""A road from a file: elevations of tracks over the distance."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from seatsim.importing.axis_doubts import doubt_distance
from seatsim.importing.doubts import doubt_channel
from seatsim.importing.import_map import ImportMap
from seatsim.importing.signals import LISTED, DataFile
from seatsim.recordings.quality.issue import Issue
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError, nearest
from seatsim.schema.text import name_some
from seatsim.schema.units import DIMENSIONS, conversion

DISTANCE = "distance_m"


def assemble_road(files: Sequence[DataFile], stated: ImportMap) -> tuple[dict[str, Array], list[Issue]]:
    """Return the distance and the tracks that are measured over the whole length, in m, with doubts about them.

    Raises:
        InputError: there are several files, a column is missing, or no track is complete.
    """
    if len(files) > 1:
        raise InputError(f"{files[1].path}: a road is imported from one file; import the others by themselves")
    if stated.distance is None:
        raise InputError(f"{files[0].path}: the map of a road needs distance: {{column: ..., unit: m}}")
    along = _column(files[0], stated.distance.column, stated.distance.unit, "distance")
    doubts = list(doubt_distance(along, stated.distance.column))
    road = {DISTANCE: along}
    left_out = []
    for name, entry in stated.channels.items():
        column = _column(files[0], entry.column or "", entry.unit or "", f"channels.{name}")
        values = entry.sign * entry.scale * column + entry.offset
        doubts += doubt_channel(name, values, None, "elevation")
        if np.isfinite(values).all():
            road[name] = values - float(np.mean(values)) if entry.remove_mean else values
        else:
            left_out.append(name)
    if len(road) < 2:
        raise InputError(f"{files[0].path}: {doubts[-1].sentence}; no track is measured over the whole length")
    if left_out:
        text = f"tracks that are not measured over the whole length are left out: {name_some(left_out, LISTED)}"
        doubts.append(Issue("note", "missing", text))
    return road, doubts


def _column(file: DataFile, name: str, unit: str, key: str) -> Array:
    """Return a column in m."""
    for group in file.groups:
        signal = group.find(name)
        if signal is not None:
            return conversion(unit or signal.unit or "m", DIMENSIONS["length"]).factor * signal.values
    names = [signal.name for group in file.groups for signal in group.signals]
    listed = name_some(names, LISTED)
    raise InputError(f"{file.path}: {key}: no column '{name}'{nearest(name, names)}; columns are {listed}")
