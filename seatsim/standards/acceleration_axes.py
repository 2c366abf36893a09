"""Which columns of a file are which axes of the person and of the floor, by their names and units."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from seatsim.importing.matching import Column, read_columns
from seatsim.importing.names import is_of, without_unit
from seatsim.importing.signals import Group, Signal
from seatsim.metrics.directions import DIRECTIONS
from seatsim.schema.errors import InputError
from seatsim.schema.units import is_unit

ALIASES = {
    **{axis: (*(f"{a}_{axis}" for a in ("acc", "acceleration", "seat")), axis) for axis in ("x", "y", "z")},
    "floor.z": ("floor_acceleration", "floor_z"),
}
"""Columns that are taken for an axis, without the unit at their end."""
CHANNELS = {"z": "driver_acceleration", "floor.z": "floor_acceleration"}
"""Channel of a recording that stands for an axis."""
PLACES = {"x": "driver", "y": "driver", "z": "driver", "floor.x": "floor", "floor.y": "floor", "floor.z": "floor"}
"""Where an axis is measured, as `seatsim.importing.names` calls it."""


def fit_axes(signals: Iterable[Signal]) -> dict[str, list[str]]:
    """Return by axis the columns that fit it equally well: those of usual names, else those whose words mean it."""
    columns = [each for each in read_columns(Group("", tuple(signals))) if _may_be_acceleration(each)]
    plain = {without_unit(each.signal.name, each.meaning.unit): each.signal.name for each in columns}
    found = {}
    for axis, place in PLACES.items():
        usual = [plain[name] for name in ALIASES.get(axis, ()) if name in plain][:1]
        exact = [each.signal.name for each in columns if each.signal.name == CHANNELS.get(axis)]
        if names := usual or exact or _find_meant(axis[-1], place, columns):
            found[axis] = names
    return found


def choose_axes(name: str, columns: Mapping[str, Signal], said: Sequence[str] = ()) -> dict[str, str]:
    """Return the column of each axis that is found; several that may be one of the floor are none.

    Raises:
        InputError: no column fits, or several fit an axis of the person; it ends with what was `said` of the file.
    """
    fitting = fit_axes(columns.values())
    for axis, names in fitting.items():
        if len(names) > 1 and axis in DIRECTIONS:
            raise InputError(
                f"{name}: {' and '.join(names)} may be axis {axis}; name every axis by --channel AXIS=COLUMN"
            )
    found = {axis: names[0] for axis, names in fitting.items() if len(names) == 1}
    if not found:
        there = f"name them with --channel AXIS=COLUMN; columns: {', '.join(columns) or 'none'}"
        raise InputError("; ".join([f"{name}: no column has a usual name", there, *said]))
    return found


def _may_be_acceleration(column: Column) -> bool:
    unit = column.meaning.unit
    return not unit or is_of(unit, "acceleration") or not is_unit(unit)


def _find_meant(letter: str, place: str, columns: Sequence[Column]) -> list[str]:
    """Return the accelerations along an axis at a place, for the person else those of no place.

    One that names a place and no axis is vertical.
    """
    found: dict[str | None, list[str]] = {}
    for column in columns:
        meaning = column.meaning
        is_along = meaning.axis == letter or (letter == "z" and meaning.axis is None and meaning.place is not None)
        if meaning.quantity == "acceleration" and is_along and not meaning.is_command:
            found.setdefault(meaning.place, []).append(column.signal.name)
    return found.get(place) or (found.get(None, []) if place == "driver" else [])
