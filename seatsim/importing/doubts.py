"""What channels of a file show, whatever rig: the faults of each; copies, derivatives and delays of two of them.

`values` are in SI units where the unit is known. Nothing is corrected here; each doubt names its place and what would.
"""

from collections.abc import Collection, Iterator, Mapping
from itertools import combinations, product

import numpy as np

from seatsim.importing.names import BY_UNIT, SI_UNITS
from seatsim.importing.signals import Axis
from seatsim.recordings.quality import relations
from seatsim.recordings.quality.channels import say_implausible
from seatsim.recordings.quality.damage import MOST_ROWS, Doubter, doubt_dropouts, doubt_shape, plateaus
from seatsim.recordings.quality.issue import Issue, Table, doubt
from seatsim.schema.arrays import Array
from seatsim.schema.units import STANDARD_GRAVITY

_NEAR = 0.08
"""Share by which a mean may differ from gravity: tilt, scale and offset of the sensor."""
_OFFSET = 0.2
"""m/s^2; mean of an accelerometer from which it has an offset."""
_ZERO = {
    "force": "gas force, preload or the zero of the load cell",
    "displacement": "the zero of the sensor; in the map, offset moves it and remove_mean centres each run",
    "elevation": "an absolute elevation",
}
"""What the mean of a quantity that swings may be."""
_OFF_CENTRE, _CENTRED, _ABSOLUTE = 0.02, 1e-4, 5.0
"""Mean as a share of the swing: from which an offset is said, below which one was removed, and of a height."""
_FEW_LEVELS, _MOST_CHANGES = 12, 20_000
"""Most values that a channel has which was typed in, or switches, among so many changes."""
_HOT = (50.0, 110.0)
"""degC between which a first temperature is a usual one in degF."""
_WARMING = 2.0
"""K/s; a damper's body does not warm faster."""
_SWITCHED = ("current", "voltage")
"""Quantities that rest and jump by themselves."""
_SLOWEST, _FASTEST = 5.0, 200_000.0
"""Hz; rates of loggers of vibration lie between."""
_ALIKE = 0.9
"""Correlation from which a channel is the delayed copy of another one."""
_REST, _STANDING, _RELAXED = 0.5, 0.01, 0.01
"""s for which a motion stands still, its swing there as a share of the whole, and the least change of a force there."""
_FEWEST = 8
"""Rows of such a stretch from which a change can be told."""


def doubt_channel(channel: str, raw: Array, rate: float | None, quantity: str | None) -> Iterator[Issue]:
    """Yield the doubts about one channel; `quantity` says what it holds, in SI units, None where that is not known."""
    doubter = Doubter(channel, rate)
    missing = np.isnan(raw)
    if missing.any():
        rows = np.flatnonzero(missing)
        yield doubter.say("missing", rows=len(rows), first=doubter.at(int(rows[0])))
    values = raw[~missing] if missing.any() else raw
    if not len(values):
        return
    if np.ptp(values) == 0.0:
        yield doubter.say("throughout", value=values[0])
        return
    if quantity == "acceleration":
        yield from _constant_part(doubter, values)
    elif quantity in _ZERO:
        yield from _rest(doubter, values, quantity)
    elif quantity == "temperature":
        yield from _warming(doubter, values)
    if quantity in BY_UNIT and (text := say_implausible(values, SI_UNITS[quantity])):
        yield doubter.say("implausible", said=text)
    lengths, starts = plateaus(values)
    if len(np.unique(values[starts[:_MOST_CHANGES]])) <= _FEW_LEVELS:
        if len(lengths) < 0.2 * len(values):
            yield doubter.say("levels", count=len(np.unique(values[starts])))
        return
    for issue in doubt_shape(doubter, values, lengths):
        # A command is logged at the rate of its controller, and holds until the next.
        yield issue._replace(severity="note") if issue.kind == "held" and quantity in _SWITCHED else issue
    if rate is not None and quantity not in _SWITCHED:
        yield from doubt_dropouts(doubter, values, lengths, starts)


def _warming(doubter: Doubter, values: Array) -> Iterator[Issue]:
    """Yield a temperature that begins warm, or changes faster than a damper does, in means over half a second."""
    first, rate = float(values[0]), doubter.rate
    if _HOT[0] < first < _HOT[1]:
        yield doubter.say("maybe_degF", first=first, read=(first - 32.0) / 1.8)
    if rate is None:
        return
    rows = max(1, round(0.5 * rate))
    means = _windows(values, rows).mean(axis=1)
    fastest = float(np.max(np.abs(np.diff(means)), initial=0.0)) * rate / rows
    if fastest > _WARMING:
        yield doubter.say("warming", fastest=fastest)


def _constant_part(doubter: Doubter, values: Array) -> Iterator[Issue]:
    """Yield gravity, an offset, or the mean of one that gravity in g has."""
    mean = float(np.mean(values))
    if abs(abs(mean) / STANDARD_GRAVITY - 1.0) <= _NEAR:
        yield doubter.say("gravity", mean=mean, off=abs(mean) - STANDARD_GRAVITY)
    elif abs(abs(mean) - 1.0) <= _NEAR and float(np.std(values)) < 0.5:
        yield doubter.say("gravity_in_g", mean=mean)
    elif abs(mean) > _OFFSET:
        yield doubter.say("offset", mean=mean)


def _rest(doubter: Doubter, values: Array, quantity: str) -> Iterator[Issue]:
    """Yield the offset of a channel that swings about another value than zero."""
    low, high = np.quantile(values[:: max(1, len(values) // MOST_ROWS)], (0.01, 0.99))
    mean, swing = float(np.mean(values)), 0.5 * float(high - low)
    if swing > 0.0 and abs(mean) > (_ABSOLUTE if quantity == "elevation" else _OFF_CENTRE) * swing:
        unit, cause = SI_UNITS[quantity], _ZERO[quantity]
        yield doubter.say("off_zero", mean=mean, unit=unit, share=abs(mean) / swing, cause=cause)
    if quantity == "displacement" and values[0] == 0.0 and swing > 0.0:
        yield doubter.say("zeroed")
    if quantity != "elevation" and abs(mean) < _CENTRED * swing:
        yield doubter.say("centred")


def doubt_time(axis: Axis, channel: str) -> Iterator[Issue]:
    """Yield what is wrong with a column of time."""
    if axis.backwards:
        yield doubt("restart", channel, times=axis.backwards, row=axis.breaks[0])
    if axis.repeated:
        yield doubt("repeated", channel, rows=axis.repeated)
    if axis.lost:
        first = next(row for row in axis.breaks if axis.times[row] - axis.times[row - 1] > 0.0)
        yield doubt("gap", channel, rows=axis.lost, first=axis.times[first - 1])
    if axis.resolution:
        yield doubt("rounded" if axis.is_even else "rounded_uneven", channel, step=axis.resolution, rate=axis.rate)
    elif not axis.is_even:
        yield doubt("uneven", channel, rate=axis.rate)
    if not _SLOWEST <= axis.rate <= _FASTEST:
        yield doubt("odd_rate", channel, apart=1.0 / axis.rate, rate=axis.rate)


def doubt_pairs(
    channels: Mapping[str, Array],
    rate: float | None,
    quantities: Mapping[str, str | None],
    commands: Collection[str] = (),
) -> Iterator[Issue]:
    """Yield copies, derived velocities and what follows its command late, among channels of one time base."""
    first_rows = {name: values[: relations.MOST_ROWS] for name, values in channels.items()}
    varying = {name: values for name, values in first_rows.items() if np.ptp(values) > 0.0}
    part = {name: values - float(np.mean(values)) for name, values in varying.items()}
    for first, second in combinations(part, 2):
        same = quantities.get(first) == quantities.get(second)
        if np.array_equal(varying[first], varying[second]):
            yield doubt("copy", second, other=first)
        elif rate and same and (first in commands) != (second in commands):
            rows, alike = relations.find_delay(part[second], part[first], round(0.2 * rate))
            if alike > _ALIKE and abs(rows) >= 2:
                late, early = (second, first) if rows > 0 else (first, second)
                yield doubt("follows", late, other=early, late=1e3 * abs(rows) / rate, alike=alike)
    # No data tell the sign and the size of commanded forces and motions of which nothing was measured.
    measured = {quantities.get(name) for name in channels if name not in commands}
    for name in channels:
        quantity = quantities.get(name)
        if name in commands and quantity in ("force", "velocity", "displacement") and quantity not in measured:
            yield doubt("commanded_only", name, quantity=quantity)
    if rate:
        of = {each: {name: part[name] for name in part if quantities.get(name) == each} for each in BY_UNIT}
        yield from _derived(of["displacement"], of["velocity"], rate)
        yield from _relaxed(of["displacement"], of["force"], rate)


def _derived(displacements: Table, velocities: Table, rate: float) -> Iterator[Issue]:
    """Yield velocities that were computed from a displacement: they are no measurement of their own."""
    for velocity, speed in velocities.items():
        for name, travel in displacements.items():
            gain, alike = relations.regress(np.gradient(travel, 1.0 / rate), speed, rate)
            if alike > 0.98 and abs(gain - 1.0) < 0.1:
                yield doubt("derived", velocity, other=name, gain=gain)
                break
            if alike > 0.98 and (said := relations.read_gain(gain, "m/s")):
                text = f"{velocity}: is {gain:.4g} times the derivative of {name}: {said}"
                yield Issue("warning", relations.kind_of(gain), text, velocity)
                break


def _relaxed(displacements: Table, forces: Table, rate: float) -> Iterator[Issue]:
    """Yield forces that change while the motion stands still after it has moved, as those that relax do."""
    rows = round(_REST * rate)
    for (name, motion), (force, values) in product(displacements.items(), forces.items()):
        if _FEWEST <= rows <= len(motion):
            swing = np.ptp(_windows(motion, rows), axis=1)
            calm = swing < _STANDING * float(np.ptp(motion))
            # The windows in which the motion has come to rest.
            still = _windows(values, rows)[1:][calm[1:] & ~calm[:-1]]
            quarter = rows // 4
            change = np.abs(np.mean(still[:, -quarter:], axis=1) - np.mean(still[:, :quarter], axis=1))
            if np.max(change, initial=0.0) > _RELAXED * np.ptp(values):
                yield doubt("relaxation", force, change=np.max(change), rest=_REST, motion=name)


def _windows(values: Array, rows: int) -> Array:
    """Return values in windows of so many rows, shape (windows, rows), without the rows at the end that fill none."""
    return values[: len(values) // rows * rows].reshape(-1, rows)
