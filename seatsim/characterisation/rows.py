"""Steady cycles of a record, as loops of equally many samples, and what they, or a record without cycles, amount to.

That is one row of the table of a characterisation.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import pairwise
from typing import Annotated, NamedTuple, TypeVar

import numpy as np

from seatsim.characterisation.steps import LEAST_RANGE, find_plateaus
from seatsim.metrics.motion import ratio, rms
from seatsim.recordings.bench_tables import BenchRecord
from seatsim.recordings.quality.damage import Doubter, doubt_dropouts, flat_tops, plateaus
from seatsim.schema.arrays import Array
from seatsim.schema.content import Form, IfAny, Unwritten
from seatsim.simulation.damper_bench import SineTest

_BAND = 0.2
"""Half the width, over the amplitude, of the band about mid-stroke that a passage has to cross from side to side."""
_STEADY = 0.03
"""Largest difference of a steady cycle's amplitude and period from their median, relative."""
_CENTRED = 0.05
"""Largest distance of the middle of a steady cycle from the median of the middles, over the amplitude."""
_LEAST_STEADY = 3
"""Steady cycles that make a record cyclic; two where there are no others."""
_SAMPLES = (64, 2000)
"""Least and most samples of a resampled cycle."""


class _Cycle(NamedTuple):
    """One cycle of a record: its ends as rows (with fractions), amplitude and mid-stroke in m."""

    first: float
    last: float
    amplitude: float
    middle: float

    @property
    def rows(self) -> slice:
        """The rows inside."""
        return slice(int(np.ceil(self.first)), int(self.last) + 1)

    @property
    def length(self) -> float:
        """Number of rows, with fractions."""
        return self.last - self.first


def find_cycles(displacement: Array) -> list[_Cycle]:
    """Return the cycles of a displacement, shape (N,), from one upward passage of mid-stroke to the next.

    Mid-stroke is halfway between the 1st and the 99th percentile. A passage leads from below a band about it to
    above, so that noise makes none; its instant is where the straight line through its rows meets mid-stroke.
    """
    low, high = (float(q) for q in np.percentile(displacement, (1, 99)))
    centre, amplitude = 0.5 * (low + high), 0.5 * (high - low)
    if amplitude <= 0.0:
        return []
    above, below = displacement > centre + _BAND * amplitude, displacement < centre - _BAND * amplitude
    side = above.astype(np.int8) - below
    outside = np.flatnonzero(side)
    upward = np.flatnonzero((side[outside][:-1] < 0) & (side[outside][1:] > 0))
    instants = [_passage(displacement, outside[k], outside[k + 1], centre) for k in upward]
    return [_cycle(displacement, a, b) for a, b in pairwise(instants)]


def _passage(x: Array, first: int, last: int, centre: float) -> float:
    part, middle = x[first : last + 1], 0.5 * (first + last)
    rows = np.arange(first, last + 1) - middle
    slope = float(rows @ part) / float(rows @ rows)
    return float(np.clip(middle + (centre - np.mean(part)) / slope, first, last)) if slope > 0.0 else middle


def _cycle(x: Array, first: float, last: float) -> _Cycle:
    inside = x[int(first) : int(np.ceil(last)) + 1]
    low, high = float(np.min(inside)), float(np.max(inside))
    return _Cycle(first, last, 0.5 * (high - low), 0.5 * (high + low))


def select_steady_cycles(cycles: Sequence[_Cycle]) -> list[_Cycle]:
    """Return the cycles whose amplitude, period and mid-stroke agree with their medians: no ring-up, no ring-down.

    Empty where they are fewer than half of all, or fewer than three (two, where these are all): such a record is not
    cyclic.
    """
    if not cycles:
        return []
    table = np.array([(cycle.amplitude, cycle.length, cycle.middle) for cycle in cycles])
    amplitude, length, middle = np.median(table, axis=0)
    alike = np.abs(table[:, 0] - amplitude) <= _STEADY * amplitude
    alike &= np.abs(table[:, 1] - length) <= _STEADY * length
    alike &= np.abs(table[:, 2] - middle) <= _CENTRED * amplitude
    steady = [cycle for cycle, kept in zip(cycles, alike, strict=True) if kept]
    enough = len(steady) >= min(_LEAST_STEADY, max(2, len(cycles)))
    return steady if enough and 2 * len(steady) >= len(cycles) else []


def _resample_loops(record: BenchRecord, cycles: Sequence[_Cycle], drift: float) -> list[SineTest]:
    """Return cycles of a record as loops of equally many samples, both ends included, by linear interpolation.

    A sample is the mean of the rows that it stands for, and the slope `drift` in N/s of the zero (see `_find_drift`) is
    taken from the force of each loop about its middle, so that the loop closes.
    """
    from scipy.ndimage import uniform_filter1d

    least, most = _SAMPLES
    length = float(np.median([cycle.length for cycle in cycles]))
    samples = min(most, max(least, 2 * round(0.5 * length)))
    rows = np.arange(len(record.force), dtype=float)
    width = 2 * int(0.5 * length / samples) + 1
    at = np.linspace([cycle.first for cycle in cycles], [cycle.last for cycle in cycles], samples + 1, axis=1)
    time = (at - at[:, :1]) / record.rate
    measured = (record.displacement, record.velocity, record.force)
    x, v, force = (np.interp(at, rows, uniform_filter1d(y, width)) for y in measured)
    force -= drift * (time - 0.5 * time[:, -1:])
    return [SineTest(*parts) for parts in zip(time, x, v, force, strict=True)]


def _find_drift(record: BenchRecord, cycles: Sequence[_Cycle]) -> float:
    """Return the slope in N/s of the mean forces of cycles over time, 0 for a single cycle."""
    if len(cycles) < 2:
        return 0.0
    middles = [0.5 * (cycle.first + cycle.last) / record.rate for cycle in cycles]
    return float(np.polyfit(middles, [np.mean(record.force[cycle.rows]) for cycle in cycles], 1)[0])


def _average_loops(loops: Sequence[SineTest]) -> SineTest:
    """Return the mean of loops of equally many samples, phase by phase."""
    return SineTest(*(np.mean([loop[part] for loop in loops], axis=0) for part in range(4)))


_T = TypeVar("_T")
_COARSE = 16
"""Rows of a cycle below which its peaks and areas are coarse."""
_DISAGREE = 0.05
"""Difference of the energy over displacement from that over velocity from which on a note says so, relative."""
_WANDERS = 0.02
"""Change of the mean force over the cycles from which on a note says so, over half the range of the force."""
_VARIES = 0.05
"""Range of a current, over its largest, from which on a note says so."""
WARMER = 4.0
"""degC; least difference of temperatures that are different settings."""
_ALIKE = 0.05
"""Relative difference of amplitudes, frequencies and speeds that are the same setting."""
WINDOW = 0.1
"""Part of the stroke about its middle over which the force at the peak speed is averaged."""


_Amperes = Annotated[float, Form(unit="A")]
_Celsius = Annotated[float, Form(unit="C")]
_Metres = Annotated[float, Form(unit="m")]
_Hertz = Annotated[float, Form(unit="Hz")]
_Speed = Annotated[float, Form(unit="m_s")]
_Newtons = Annotated[float, Form(unit="N")]
_Joules = Annotated[float, Form(unit="J")]
_Damping = Annotated[float, Form(unit="N_s_m")]


class Row(NamedTuple):
    """Figures of one record; SI units, degC. NaN where a figure does not exist; `sd` is the spread over the cycles.

    amplitude: half the stroke. peak_rebound, peak_compression: largest and smallest force, positive opposes extension.
    energy: dissipated in a cycle, the area of the loop. damping: viscous damping that dissipates the same, `E / (pi w
    X^2)`. offset: mean force of a cycle. asymmetry: RMS of the asymmetric part (difference from the centrosymmetric
    loop, `(F(t) + F(t + T/2)) / 2`) over that of the force. `loop` is the mean of the steady cycles; `cycle_values`
    holds current, temperature, peaks, energy and offset of each, and its force at the peak speed (half the difference
    of both directions).
    """

    record: str
    file: str
    cycles: int
    left_out: int
    current: _Amperes
    temperature: _Celsius = math.nan
    temperature_range: _Celsius = math.nan
    amplitude: _Metres = math.nan
    frequency: _Hertz = math.nan
    peak_speed: _Speed = math.nan
    peak_rebound: _Newtons = math.nan
    peak_compression: _Newtons = math.nan
    energy: _Joules = math.nan
    energy_sd: _Joules = math.nan
    damping: _Damping = math.nan
    offset: _Newtons = math.nan
    asymmetry: float = math.nan
    notes: tuple[str, ...] = ()
    loop: Unwritten[SineTest | None] = None
    cycle_values: IfAny[dict[str, list[float]] | None] = None

    @property
    def ramps(self) -> bool:
        """Whether the current differs from cycle to cycle."""
        current = (self.cycle_values or {}).get("current", [0.0])
        return max(current) - min(current) > max(_VARIES * max(current), LEAST_RANGE)


_FIGURES: dict[str, Callable[[SineTest], float]] = {
    "peak_rebound": lambda loop: float(np.max(loop.force)),
    "peak_compression": lambda loop: float(np.min(loop.force)),
    "energy": lambda loop: loop.dissipated_energy,
    "damping": lambda loop: loop.equivalent_damping,
    "offset": lambda loop: float(np.mean(loop.force[:-1])),
}
"""Figures that every cycle has."""


def _summarise_loops(record: BenchRecord, steady: Sequence[_Cycle], loops: Sequence[SineTest], window: float) -> Row:
    """Return the row of a record with steady cycles, which are loops of equally many samples too."""
    loop, current = _average_loops(loops), _average_cycles(record.current, steady)
    warmth = np.full(len(loops), math.nan)
    if record.temperature is not None:
        warmth = _average_cycles(record.temperature, steady)
    each = {name: np.array([figure(one) for one in loops]) for name, figure in _FIGURES.items()}
    mean = {name: float(np.mean(values)) for name, values in each.items()}
    ways = np.array([measure_forces(one, window) for one in loops])
    values = {"current": current, "temperature": warmth, **each, "force": 0.5 * (ways[:, 0] - ways[:, 1])}
    return Row(
        record=record.name, file=record.file, cycles=len(loops), left_out=0,
        current=round(float(np.mean(current)), 6),
        temperature=float(np.mean(warmth)), temperature_range=float(np.ptp(warmth)),
        amplitude=0.5 * float(np.ptp(loop.displacement)), frequency=1.0 / float(loop.time[-1]),
        peak_speed=float(np.max(np.abs(loop.velocity))),
        asymmetry=ratio(rms(loop.asymmetric_part[:-1]), rms(loop.force[:-1])), notes=(), loop=loop,
        cycle_values={name: list(map(float, v)) for name, v in values.items()},
        energy_sd=float(np.std(each["energy"], ddof=1)) if len(loops) > 1 else math.nan, **mean,
    )  # fmt: skip


def measure_forces(loop: SineTest, window: float) -> tuple[float, float]:
    """Return the mean force in rebound and in compression over a part of the stroke about its middle."""
    x = loop.displacement - 0.5 * (np.max(loop.displacement) + np.min(loop.displacement))
    near = np.abs(x) <= 0.5 * window * np.ptp(x)
    rebound, compression = (float(np.mean(loop.force[near & (sign * loop.velocity > 0.0)])) for sign in (1.0, -1.0))
    return rebound, compression


def summarise_record(record: BenchRecord, window: float = WINDOW) -> Row:
    """Return the row of a measured record at one current: of its steady cycles, or as a record without cycles.

    `window` is the part of the stroke over which the force at the peak speed is averaged.
    """
    found = find_cycles(record.displacement)
    steady = select_steady_cycles(found)
    if not steady:
        return _summarise_aperiodic_record(record, found)
    drift = _find_drift(record, steady)
    loops = _resample_loops(record, steady, drift)
    moved = drift * (steady[-1].first - steady[0].first) / record.rate
    notes = [*_of_damage(record), *_of_current(record), *_of_loops(loops)]
    if abs(moved) > _WANDERS * 0.5 * float(np.ptp(record.force)):
        notes.append(f"the mean force drifts by {moved:+.3g} N over the cycles: a drifting zero, or a gas that warms")
    notes += _of_sign(record)
    if min(cycle.length for cycle in steady) < _COARSE:
        notes.append(f"fewer than {_COARSE} rows a cycle: peaks and areas are coarse")
    row = _summarise_loops(record, steady, loops, window)
    return row._replace(left_out=len(found) - len(steady), notes=tuple(notes))


def _summarise_aperiodic_record(record: BenchRecord, found: Sequence[_Cycle]) -> Row:
    """Return the row of a record that is no steady cycle: peaks and mean of the force, and what the motion is."""
    warmth = record.temperature if record.temperature is not None else np.array([math.nan])
    return Row(
        record=record.name, file=record.file, cycles=0, left_out=len(found), current=round(record.mean_current, 6),
        temperature=float(np.mean(warmth)), temperature_range=float(np.ptp(warmth)),
        amplitude=0.5 * float(np.ptp(record.displacement)), peak_speed=float(np.max(np.abs(record.velocity))),
        peak_rebound=float(np.max(record.force)), peak_compression=float(np.min(record.force)),
        offset=float(np.mean(record.force)),
        notes=(_motion(record, found), *_of_damage(record), *_of_current(record), *_of_sign(record)),
    )  # fmt: skip


_AFTER_STEP = 0.2
"""Seconds after a step of current from which on cycles are counted."""


def summarise_stretches(record: BenchRecord, window: float) -> list[Row]:
    """Return the row of a record, or one for each stretch with steady cycles over which its current rests."""
    rests = find_plateaus(record.current, record.rate)
    if len(rests) < 2:
        return [summarise_record(record, window)]
    skipped = round(_AFTER_STEP * record.rate)
    parts = [(rest, record.part(rest.first + skipped, rest.last)) for rest in rests if rest.last > rest.first + skipped]
    rows = [
        summarise_record(part, window)._replace(record=f"{record.name}, {rest.first / record.rate:.1f} s")
        for rest, part in parts
    ]
    cyclic = [row for row in rows if row.loop is not None]
    return cyclic or [_summarise_aperiodic_record(record, find_cycles(record.displacement))]


def _motion(record: BenchRecord, found: Sequence[_Cycle]) -> str:
    if len(found) < 2:
        return f"not cyclic: {len(found)} whole cycle{'' if len(found) == 1 else 's'} in {record.time[-1]:.3g} s"
    low, high = np.percentile([record.rate / cycle.length for cycle in found], (5, 95))
    small, large = 1e3 * np.percentile([cycle.amplitude for cycle in found], (5, 95))
    return f"not cyclic: {len(found)} cycles, {low:.2g} to {high:.2g} Hz, {small:.2g} to {large:.2g} mm"


def _of_damage(record: BenchRecord) -> Iterator[str]:
    """Yield where force or displacement is clipped or drops out."""
    for name in ("force", "displacement"):
        values = getattr(record, name)
        if not np.ptp(values):
            continue
        for extreme, rows in flat_tops(values):
            yield f"{name}: {rows} rows stand at its extreme {extreme:.5g}; it is clipped"
        for issue in doubt_dropouts(Doubter(name, record.rate), values, *plateaus(values)):
            yield issue.sentence


def _of_current(record: BenchRecord) -> list[str]:
    low, high = (float(q) for q in np.percentile(record.current, (1, 99)))
    drive, unit = ("voltage", "V") if record.in_volts else ("current", "A")
    notes = ["driven by a voltage without a stated gain: volts stand in place of amperes"] * record.in_volts
    if high - low > _VARIES * max(high, 1e-9):
        notes.append(f"the {drive} varies from {low:.2f} to {high:.2f} {unit}")
    return notes


def _of_sign(record: BenchRecord) -> list[str]:
    power = float(np.mean((record.force - np.mean(record.force)) * record.velocity))
    return ["the force drives the motion on average: its sign is the other way round"] if power < 0.0 else []


def _of_loops(loops: Sequence[SineTest]) -> list[str]:
    notes = []
    loop = _average_loops(loops)
    energy = loop.dissipated_energy
    over_stroke = float(np.trapezoid(loop.force, loop.displacement))
    if abs(over_stroke - energy) > _DISAGREE * abs(energy):
        notes.append(f"velocity and displacement disagree: the area over displacement is {over_stroke:.3g} J")
    return notes


def _average_cycles(values: Array, cycles: Sequence[_Cycle]) -> Array:
    return np.array([float(np.mean(values[cycle.rows])) for cycle in cycles])


def group_rows(rows: Iterable[_T], alike: Callable[[_T, _T], bool]) -> list[list[_T]]:
    """Return rows in groups, each row with the first group whose first row is like it, in the order they come."""
    groups: list[list[_T]] = []
    for row in rows:
        group = next((group for group in groups if alike(group[0], row)), None)
        if group is None:
            groups.append(group := [])
        group.append(row)
    return groups


def has_same_motion(a: Row, b: Row) -> bool:
    """Whether two rows have the same amplitude and frequency."""
    return is_alike(a.amplitude, b.amplitude) and is_alike(a.frequency, b.frequency)


def is_alike(a: float, b: float) -> bool:
    """Whether two amplitudes, frequencies or speeds are the same setting."""
    return abs(a - b) <= _ALIKE * a
