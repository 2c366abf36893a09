"""ISO 2631 figures of measured accelerations: each axis, their sum, a day's exposure, and what the seat passes on."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np

from seatsim.metrics.comfort import (
    Dose,
    SeatTransmission,
    dose,
    find_shocks,
    join_doses,
    motion_sickness_dose,
    seat_transmission,
)
from seatsim.metrics.exposure import DIRECTIONS, HOUR, POINTS, Direction, Exposure, assess_exposure, point_of
from seatsim.metrics.spine import SpinalLoad, assess_spine, join_spinal_doses, spinal_dose, spine_response
from seatsim.metrics.weighting import weight
from seatsim.recordings.quality.channels import say_implausible
from seatsim.schema.arrays import Array
from seatsim.schema.content import Form, Joined, Unwritten, show_record
from seatsim.schema.errors import InputError, permit, placed
from seatsim.schema.units import STANDARD_GRAVITY
from seatsim.standards.acceleration_records import AccelerationRecord, choose_axes, load_accelerations

_FLOOR = {"floor.x": "x", "floor.y": "y", "floor.z": "z"}
"""Axes at the base of the seat, and the axis of the seat whose weighting and SEAT factor they belong to."""
_AXES = (*DIRECTIONS, *_FLOOR)
_OFFSET = 0.05
"""Smallest mean in m/s^2 that is said to have been taken out."""
_SHORTEST = 108.0
"""s; duration that ISO 2631-1:1997, 5.5, asks for random vibration from 1 Hz on (recalled)."""


class Stretch(NamedTuple):
    """A run along one axis: acceleration less its mean, as recorded and weighted, shape (N,) each."""

    run: str
    sample_rate: float
    acceleration: Array
    weighted: Array
    dose: Dose


class AxisAssessment(NamedTuple):
    """Figures of one axis, weighted but without multiplying factors."""

    column: str
    direction: Joined[Direction]
    dose: Joined[Dose]
    shocks: Annotated[tuple[str, ...], Form(key="reasons")]
    """Why the basic method does not suffice (`seatsim.metrics.comfort.find_shocks`)."""
    removed: Annotated[float, Form(key="removed_mean")]
    """Mean that was taken out of the record before weighting, in its unit: an offset of the sensor, or gravity."""
    method: str
    """`basic` (a_w) or `additional` (MTVV and VDV beside it; ISO 2631-1:1997, 6.3)."""


class MotionSickness(NamedTuple):
    """Vertical motion weighted with Wf (ISO 2631-1:1997, clause 9): a_w in m/s^2 and MSDV_z in m/s^1.5."""

    rms: float
    msdv: float


class Comfort(NamedTuple):
    """What ISO 2631 says of a record, or of runs taken together: the content of `comfort.json`.

    `duration` in s is what was recorded, `sample_rate` is in Hz.
    """

    name: Annotated[str, Form(key="source")]
    """Name of the file, or of the recording's folder."""
    runs: tuple[str, ...]
    duration: float
    sample_rate: float
    axes: Mapping[str, AxisAssessment]
    totals: Mapping[str, float]
    """Vibration total value a_v in m/s^2 by point of contact, and `overall` (ISO 2631-1:1997, 8.2.2 and 8.2.3)."""
    exposure: Joined[Exposure | None]
    """None where neither x, y nor z on the seat was recorded."""
    seat: Mapping[str, SeatTransmission]
    """SEAT factors by axis, where seat and floor were recorded."""
    motion_sickness: MotionSickness | None
    spine: SpinalLoad | None
    """Of the z axis on the seat; the daily dose is that of the hours of the day."""
    notes: tuple[str, ...]
    stretches: Unwritten[Mapping[str, Sequence[Stretch]]]
    """What was assessed, by axis."""

    def _repr_html_(self) -> str:
        return show_record(self)


def comfort(
    source: str | Path,
    channels: Mapping[str, str] | None = None,
    *,
    hours: float = 8.0,
    runs: Sequence[str] = (),
    rate: float | None = None,
    unit: str | None = None,
) -> Comfort:
    """Assess the accelerations of a measured file, or of the runs of a recording, by ISO 2631-1:1997.

    The mean of every channel is removed before it is weighted.

    Args:
        source: a file of any format that `seatsim import` reads, or the folder of a recording.
        channels: column by axis: `x`, `y`, `z`, `rx`, `ry`, `rz` on the seat, `back.x` .. `feet.z`, and `floor.x` ..
            `floor.z` at its base; None takes columns with usual names.
        hours: duration of such vibration in a day.
        runs: names of the runs of a recording, all of them where empty; they count as one vibration.
        rate: sample rate in Hz of a file without times.
        unit: of the columns for which none is stated, m/s^2 (rad/s^2) where it is None.

    Raises:
        InputError: a file, column, axis or run is not there, the record cannot be weighted, or `hours` do not fit into
            a day.
    """
    named = {axis.lower(): column for axis, column in (channels or {}).items()}
    for axis in named:
        if axis not in _AXES:
            raise InputError(f"no axis is called '{axis}'{permit(axis, _AXES)}")
    records = _chosen(load_accelerations(source, rate, unit, [*named.values()]), runs, source)
    named = named or choose_axes(records[0].name, records[0].columns, records[0].notes)
    every = {axis: _weigh(records, name, DIRECTIONS[_FLOOR.get(axis, axis)]) for axis, name in named.items()}
    stretches = {axis: every[axis] for axis in DIRECTIONS if axis in named}
    if not stretches:
        raise InputError(f"{source}: no axis of the person is named; give one of {', '.join(DIRECTIONS)}")
    doses = {axis: [part.dose for part in parts] for axis, parts in every.items()}
    axes = {axis: _assess(named[axis], DIRECTIONS[axis], doses[axis], records) for axis in stretches}
    joined = {axis: found.dose for axis, found in axes.items()}
    seats = {axis: (doses[axis], doses[base]) for base, axis in _FLOOR.items() if {base, axis} <= {*named}}
    return Comfort(
        name=Path(source).name,
        runs=tuple(record.name for record in records),
        duration=next(iter(joined.values())).duration,
        sample_rate=records[0].sample_rate,
        axes=axes,
        totals=_total_values(joined),
        exposure=assess_exposure(joined, hours),
        seat={axis: seat_transmission(*pair) for axis, pair in seats.items()},
        motion_sickness=_motion_sickness(records, named["z"]) if "z" in named else None,
        spine=_load_spine(records, named["z"], hours) if "z" in named else None,
        notes=tuple(_notes(records, named, axes)),
        stretches=stretches,
    )


def _total_values(doses: Mapping[str, Dose]) -> dict[str, float]:
    """Return a_v = sqrt(sum over axes of k^2 a_w^2) in m/s^2 by point of contact, and of all points as `overall`.

    Source: ISO 2631-1:1997, equation 10 in 8.2.2, and 8.2.3 for several points; k as in `seatsim.metrics.exposure`.
    """
    squares = {axis: (DIRECTIONS[axis].comfort * found.rms) ** 2 for axis, found in doses.items()}
    by_point = {point: sum(square for axis, square in squares.items() if point_of(axis) == point) for point in POINTS}
    present = {point: float(np.sqrt(by_point[point])) for point in POINTS if any(point_of(a) == point for a in squares)}
    return present | {"overall": float(np.sqrt(sum(squares.values())))}


def _chosen(records: list[AccelerationRecord], runs: Sequence[str], source: str | Path) -> list[AccelerationRecord]:
    known = [record.name for record in records]
    for name in runs:
        if name not in known:
            raise InputError(f"{source}: no run is called '{name}'{permit(name, known)}")
    return [record for record in records if not runs or record.name in runs]


def _weigh(records: Sequence[AccelerationRecord], column: str, along: Direction) -> list[Stretch]:
    """Return each record of a column, weighted."""
    stretches = []
    for record in records:
        x, rate = _centre(record, column, along.unit), record.sample_rate
        with placed(f"{record.name}, {column}"):
            weighted = weight(x, rate, along.weighting)
        stretches.append(Stretch(record.name, rate, x, weighted, dose(weighted, rate)))
    return stretches


def _centre(record: AccelerationRecord, column: str, unit: str) -> Array:
    """Return a column less its mean.

    The high-pass would take seconds to forget a constant, and gravity in a sensor would be the largest vibration.
    """
    recorded = record.values(column, unit)
    return np.asarray(recorded - np.mean(recorded))


def _assess(
    column: str, along: Direction, doses: Sequence[Dose], records: Sequence[AccelerationRecord]
) -> AxisAssessment:
    joined = join_doses(doses)
    means = [float(np.mean(record.values(column, along.unit))) for record in records]
    shocks = tuple(find_shocks(joined))
    return AxisAssessment(column, along, joined, shocks, max(means, key=abs), "additional" if shocks else "basic")


def _motion_sickness(records: Sequence[AccelerationRecord], column: str) -> MotionSickness:
    stretches = _weigh(records, column, DIRECTIONS["z"]._replace(weighting="Wf"))
    found = join_doses([part.dose for part in stretches])
    return MotionSickness(found.rms, motion_sickness_dose(found.rms, found.duration))


def _load_spine(records: Sequence[AccelerationRecord], column: str, hours: float) -> SpinalLoad:
    """Return the load of the spine by records that have their shares of the hours of a day."""
    doses, lasts = [], 0.0
    for record in records:
        x = _centre(record, column, DIRECTIONS["z"].unit)
        with placed(f"{record.name}, {column}"):
            doses.append(spinal_dose(spine_response(x, record.sample_rate)))
        lasts += len(x) / record.sample_rate
    daily = join_spinal_doses(doses, [HOUR * hours / lasts] * len(doses))
    return SpinalLoad(join_spinal_doses(doses), daily, assess_spine(daily))


def _notes(
    records: Sequence[AccelerationRecord], named: Mapping[str, str], axes: Mapping[str, AxisAssessment]
) -> Iterator[str]:
    yield from (note for record in records for note in record.notes)
    if len(records) > 1:
        yield f"{len(records)} runs count as one vibration: {', '.join(record.name for record in records)}"
    for axis, found in axes.items():
        size = abs(found.removed)
        if size > _OFFSET:
            cause = "gravity" if abs(size - STANDARD_GRAVITY) < 0.05 * STANDARD_GRAVITY else "an offset of the sensor"
            mean = f"{found.removed:.3g} {found.direction.unit}"
            yield f"{axis}: a mean of {mean}, {cause}, was taken out of {found.column}"
        if said := say_implausible(records[0].values(found.column, found.direction.unit), found.direction.unit):
            yield f"{found.column}: {said}"
    unitless = [column for column in dict.fromkeys(named.values()) if records[0].is_unitless(column)]
    if unitless:
        yield f"{', '.join(unitless)}: no unit is stated, so m/s^2 (rad/s^2) is taken; another one by --unit"
    for found in axes.values():
        if found.column in unitless and abs(abs(found.removed) - 1.0) < 0.05:
            yield f"{found.column} has a mean of {found.removed:.3g}, as gravity has in g: then give --unit g"
    duration = next(iter(axes.values())).dose.duration
    if duration < _SHORTEST:
        yield (
            f"the record lasts {duration:.3g} s; ISO 2631-1:1997, 5.5, takes {_SHORTEST:g} s for random vibration"
            " from 1 Hz on (recalled)"
        )
