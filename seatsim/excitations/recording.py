"""What was measured as excitation: a run of a recording, or a table.

Of a run count its floor motion, its command or current, and its temperature; a table holds the acceleration of a floor
over time, or the elevation of a road over distance.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Literal, NamedTuple

import numpy as np

from seatsim.excitations import motion
from seatsim.excitations.base import DURATION, SPEED, Floor, Through, choice, excitation
from seatsim.excitations.road import LONGEST, SHORTEST, TRUCK, Vehicle, floor_response
from seatsim.recordings.recording import load_recording
from seatsim.schema.arrays import Array
from seatsim.schema.bounds import check_steps
from seatsim.schema.errors import InputError, nearest
from seatsim.schema.fields import param
from seatsim.schema.guarded import is_there, nearest_beside
from seatsim.schema.tables import read_finite, read_table

_CORNER = 0.05
"""Hz; below it the floor velocity, an integral of a measured acceleration, is attenuated as unreliable."""


@excitation("recording")
class RecordedRun(NamedTuple):
    """A run of a recording: floor acceleration linear between rows, command constant from its row until the next.

    Coil current and temperature are linear between rows. The floor's velocity and displacement are leaky integrals of
    its acceleration (corner 0.05 Hz). `path` is the recording's folder, `run` the run's name; both are filled in where
    a scenario is replayed against a recording.
    """

    path: str = ""
    run: str = ""

    def floor(self, step: float, seed: int) -> Floor:
        """Return the motion of the floor and the recorded inputs, sampled every `step` seconds from row 0.

        Raises:
            InputError: the recording cannot be read, or its row interval is not a multiple of `step`.
        """
        if not (self.path and self.run):
            raise InputError(
                "excitation: a recording needs 'path' (its folder) and 'run'; state both, or replay the scenario with"
                " 'seatsim gap SCENARIO RECORDING'"
            )
        recording = load_recording(self.path)
        table = recording.table(self.run)
        interval = 1.0 / recording.header.sample_rate
        parts = round(interval / step)
        if parts < 1 or abs(parts * step - interval) > 1e-6 * interval:
            best = interval / max(1, math.ceil(interval / step - 1e-9))
            raise InputError(
                f"{self.path}: rows every {interval:g} s are no multiple of solver.step {step:g}; set it to {best:.9g}"
            )
        return interpolate_floor(table, parts, step)


def interpolate_floor(table: Mapping[str, Array], parts: int, step: float) -> Floor:
    """Return the recorded inputs of a seat, sampled every `step` seconds, `parts` of which are a row of the table."""
    check_steps(float(parts) * len(table["floor_acceleration"]))
    floor, command = _linear(table["floor_acceleration"], parts), table.get("current_command")
    velocity = _leaky_integral(floor, step)
    held = None if command is None else np.append(np.repeat(command[:-1], parts), command[-1])
    finer = {name: _linear(table[name], parts) for name in ("coil_current", "damper_temperature") if name in table}
    current, temperature = finer.get("coil_current"), finer.get("damper_temperature")
    return Floor(step, floor, velocity, _leaky_integral(velocity, step), held, current, temperature)


def _linear(values: Array, parts: int) -> Array:
    """Return the values with `parts - 1` linearly interpolated ones between each pair."""
    rows = np.arange(len(values))
    return np.interp(np.arange((len(values) - 1) * parts + 1) / parts, rows, values)


def _leaky_integral(values: Array, step: float) -> Array:
    """Return the integral with a memory of 1 / (2 pi _CORNER) seconds, by the trapezoidal rule."""
    from scipy.signal import lfilter

    leak = math.pi * _CORNER * step
    gain = 0.5 * step / (1 + leak)
    return np.asarray(lfilter([gain, gain], [1.0, -(1 - leak) / (1 + leak)], values))


_USABLE = 0.8
"""Part of a table's Nyquist frequency up to which its content is used."""
_BAND = (0.1, 80.0)
"""Hz between which a measured acceleration is used."""


@excitation("table")
class Table(NamedTuple):
    """A floor or a road that somebody measured, from a CSV or CSV.gz table with one of two axes.

    - `time_column`: `column` is the vertical floor acceleration in m/s^2. Its mean (gravity, bias) is removed, it is
      limited to 0.1 to 80 Hz (less where the table is coarser), and integrated in the frequency domain.
    - `distance_column`: `column` is the road's elevation in m, met at `speed`. Its steady slope is removed,
      it is limited to 0.011 to 2.83 cycles/m (the band of `kind: road`; less where the table is coarser), and
      passes `vehicle.floor_response` unless `through: direct`. Waves shorter than 0.35 m are left out, since
      a tyre's contact patch averages over them.

    Both filters have no phase shift (see `motion.band`). Without `duration` the whole record is played; a
    longer run plays it backwards and forwards in turn where `repeat: mirror` says so. The floor is faded in
    over the first second. The record is stretched by less than half a step over its length so that it holds a
    whole number of steps.
    """

    path: Annotated[str, choice("the table's file, relative to the scenario")]
    column: Annotated[str, choice("column of the acceleration or elevation")]
    time_column: Annotated[str | None, choice("column of the time", "s")] = None
    distance_column: Annotated[str | None, choice("column of the distance", "m")] = None
    speed: Annotated[float | None, SPEED] = None
    duration: Annotated[float | None, DURATION] = None
    start: Annotated[float, param("s or m", "part of the record left out at its beginning", low=0)] = 0.0
    repeat: Annotated[Literal["none", "mirror"], choice("what follows the record's end")] = "none"
    through: Through = "vehicle"
    vehicle: Annotated[Vehicle, choice("the vehicle between a measured road and the floor")] = TRUCK

    def floor(self, step: float, seed: int) -> Floor:
        """Return the motion of the floor; `seed` plays no part.

        Raises:
            InputError: the table cannot be used (see `_read_record`), the keys do not say whether it
                is over time or distance, the run is longer than the record, or `step` is too coarse for its
                band.
        """
        if (self.time_column is None) == (self.distance_column is None):
            raise InputError(f"table {self.path}: give either time_column or distance_column (with speed)")
        if self.time_column is not None:
            return self._measured(_read_record(self.path, self.time_column, self.column, self.start), step)
        return self._driven(_read_record(self.path, str(self.distance_column), self.column, self.start), step)

    def _measured(self, record: _EvenSeries, step: float) -> Floor:
        if self.speed is not None:
            raise InputError(f"table {self.path}: speed belongs to distance_column; drop it beside time_column")
        highest = min(_BAND[1], _USABLE * 0.5 / record.interval)
        period = 2 * record.length
        acceleration = motion.mirrored(record.values - record.values.mean())[: int(highest * period) + 1]
        acceleration *= motion.band(motion.lines(acceleration, period), _BAND[0], highest)
        return self._play(motion.integrated_twice(acceleration, period), record.length, highest, step)

    def _driven(self, record: _EvenSeries, step: float) -> Floor:
        if self.speed is None:
            raise InputError(f"table {self.path}: a table over distance needs speed, in m/s")
        shortest = min(SHORTEST, _USABLE * 0.5 / record.interval)
        period = 2 * record.length
        elevation = motion.limited(record.values, record.interval, LONGEST, shortest)
        road = motion.mirrored(elevation)[: int(shortest * period) + 1]
        wavenumber = motion.lines(road, period)
        if self.through == "vehicle":
            road = road * floor_response(self.speed * wavenumber, self.vehicle)
        return self._play(road, record.length / self.speed, self.speed * shortest, step)

    def _play(self, displacement: motion.Spectrum, length: float, highest: float, step: float) -> Floor:
        motion.check_step("table", step, highest, per_period=5)
        duration = length if self.duration is None else self.duration
        if duration > length + step and self.repeat == "none":
            raise InputError(
                f"table {self.path}: a duration of {duration:g} s exceeds the record's {length:.4g} s; "
                "shorten it, or set repeat: mirror"
            )
        size = round(2 * length / step)
        return motion.soft_start(step, motion.motion_of(displacement, step, size, motion.samples(duration, step)))


_LEAST_ROWS = 16
_REMEDY = "choose another column or mend the table"
# Rounded times of a steady clock deviate by less than this part of an interval; a lost row deviates by more.
_LARGEST_JITTER = 0.25


class _EvenSeries(NamedTuple):
    """Values at even intervals of time (s) or distance (m)."""

    interval: float
    values: Array

    @property
    def length(self) -> float:
        """From the first to the last value, in s or m."""
        return self.interval * (len(self.values) - 1)


def _read_record(path: str, axis: str, column: str, start: float) -> _EvenSeries:
    """Read `column` of a CSV (or CSV.gz) table over its column `axis`, from `start` after its first row.

    Raises:
        InputError: no such file or column, not a table, fewer than 16 rows, an entry that is not a finite
            number, or an `axis` that does not grow in even intervals.
    """
    if not is_there(Path(path)):
        raise InputError(f"{path}: no such file{nearest_beside(Path(path))}")
    table = read_table(Path(path))
    known = list(map(str, table))
    for name in (axis, column):
        if name not in known:
            shown = ", ".join(known[:8]) + (f", ... ({len(known)} in all)" if len(known) > 8 else "")
            raise InputError(f"{path}: no column '{name}'{nearest(name, known)}; columns: {shown}")
    if len(table) < _LEAST_ROWS:
        raise InputError(f"{path}: {len(table)} rows are too few; permitted: at least {_LEAST_ROWS}")
    position = read_finite(table, axis, path, _REMEDY)
    whole = _EvenSeries(_interval(path, axis, position), read_finite(table, column, path, _REMEDY))
    record = whole._replace(values=whole.values[round(start / whole.interval) :])
    if len(record.values) < _LEAST_ROWS:
        raise InputError(f"{path}: start {start:g} leaves fewer than {_LEAST_ROWS} rows of {whole.length:g} (s or m)")
    return record


def _interval(path: str, axis: str, position: Array) -> float:
    back = np.flatnonzero(np.diff(position) <= 0)
    if len(back):
        raise InputError(f"{path}, line {back[0] + 3}: column '{axis}' does not grow; sort the rows, drop repeats")
    interval = float(position[-1] - position[0]) / (len(position) - 1)
    jitter = np.abs(position - position[0] - interval * np.arange(len(position)))
    worst = int(np.argmax(jitter))
    if jitter[worst] > _LARGEST_JITTER * interval:
        raise InputError(
            f"{path}, line {worst + 2}: column '{axis}' is {jitter[worst]:.3g} off even steps of "
            f"{interval:g}; permitted: {_LARGEST_JITTER:g} of a step; resample the table at a steady rate"
        )
    return interval
