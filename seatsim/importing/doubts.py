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
from seatsim.recordings.quality.issue import Issue, Table
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
        text = f"{len(rows)} rows hold no number, the first at {doubter.at(int(rows[0]))}; fill: true interpolates them"
        yield doubter.say("warning", "missing", text)
    values = raw[~missing] if missing.any() else raw
    if not len(values):
        return
    if np.ptp(values) == 0.0:
        yield doubter.say("warning", "constant", f"is {values[0]:.6g} throughout; a dead sensor, or a stated value")
        return
    if quantity == "acceleration":
        yield from _constant_part(doubter, values)
    elif quantity in _ZERO:
        yield from _rest(doubter, values, quantity)
    elif quantity == "temperature":
        yield from _warming(doubter, values)
    if quantity in BY_UNIT and (text := say_implausible(values, SI_UNITS[quantity])):
        yield doubter.say("warning", "unit", text)
    lengths, starts = plateaus(values)
    if len(np.unique(values[starts[:_MOST_CHANGES]])) <= _FEW_LEVELS:
        if len(lengths) < 0.2 * len(values):
            seen = f"has {len(np.unique(values[starts]))} levels and no noise"
            yield doubter.say("note", "levels", f"{seen}; a command or a nominal value, not measured")
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
        text = f"begins at {first:.3g} degC; read as degF that is {(first - 32.0) / 1.8:.3g} degC: check its unit"
        yield doubter.say("note", "unit", text)
    if rate is None:
        return
    rows = max(1, round(0.5 * rate))
    means = _windows(values, rows).mean(axis=1)
    fastest = float(np.max(np.abs(np.diff(means)), initial=0.0)) * rate / rows
    if fastest > _WARMING:
        text = f"changes by up to {fastest:.2g} K/s, faster than a damper warms: a disturbed or a surface reading"
        yield doubter.say("warning", "warming", text)


def _constant_part(doubter: Doubter, values: Array) -> Iterator[Issue]:
    """Yield gravity, an offset, or the mean of one that gravity in g has."""
    mean = float(np.mean(values))
    if abs(abs(mean) / STANDARD_GRAVITY - 1.0) <= _NEAR:
        text = f"its mean of {mean:.4g} m/s^2 is gravity ({abs(mean) - STANDARD_GRAVITY:+.2g} is offset or tilt); "
        yield doubter.say("warning", "gravity", f"{text}remove_mean: true takes it out")
    elif abs(abs(mean) - 1.0) <= _NEAR and float(np.std(values)) < 0.5:
        text = f"its mean of {mean:.4g} is gravity in g, but m/s^2 is stated; state unit: g, and remove_mean: true"
        yield doubter.say("warning", "unit", text)
    elif abs(mean) > _OFFSET:
        said = f"its mean is {mean:.4g} m/s^2, an offset; remove_mean: true takes it out"
        yield doubter.say("warning", "offset", said)


def _rest(doubter: Doubter, values: Array, quantity: str) -> Iterator[Issue]:
    """Yield the offset of a channel that swings about another value than zero."""
    low, high = np.quantile(values[:: max(1, len(values) // MOST_ROWS)], (0.01, 0.99))
    mean, swing = float(np.mean(values)), 0.5 * float(high - low)
    if swing > 0.0 and abs(mean) > (_ABSOLUTE if quantity == "elevation" else _OFF_CENTRE) * swing:
        text = f"its mean is {mean:.4g} {SI_UNITS[quantity]}, {abs(mean) / swing:.0%} of its swing: {_ZERO[quantity]}"
        yield doubter.say("note", "offset", text)
    if quantity == "displacement" and values[0] == 0.0 and swing > 0.0:
        yield doubter.say("note", "zeroed", "begins at exactly 0: counted from its start, its own zero is lost")
    if quantity != "elevation" and abs(mean) < _CENTRED * swing:
        yield doubter.say("note", "centred", "its mean is zero: an offset was removed, and with it what it would show")


def doubt_time(axis: Axis, channel: str) -> Iterator[Issue]:
    """Yield what is wrong with a column of time."""
    found = {}
    if axis.backwards:
        text = f"runs back {axis.backwards} times, the first at row {axis.breaks[0]}"
        found["restart"] = text
    if axis.repeated:
        found["repeated"] = f"{axis.repeated} rows repeat the time before"
    if axis.lost:
        first = next(row for row in axis.breaks if axis.times[row] - axis.times[row - 1] > 0.0)
        text = f"{axis.lost} rows are missing, the first at {axis.times[first - 1]:.6g} s"
        found["gap"] = text
    if axis.resolution:
        text = f"; the rate is estimated as {axis.rate:.6g} Hz: state it"
        text = text if axis.is_even else ", and the rows are not even by them; state the rate"
        steps = f"its stamps go in steps of {axis.resolution:.4g} s, about as coarse as the rows or coarser"
        found["rounded"] = f"{steps}{text} by sample_rate in the map, or by --rate"
    elif not axis.is_even:
        found["uneven"] = f"rows are not evenly spaced; they are interpolated at {axis.rate:.5g} Hz"
    if not _SLOWEST <= axis.rate <= _FASTEST:
        text = f"rows are {1.0 / axis.rate:.4g} s apart, {axis.rate:.4g} Hz"
        found["rate"] = f"{text}; is its unit another one, such as ms?"
    yield from (Doubter(channel, None).say("warning", kind, text) for kind, text in found.items())


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
            yield Issue("warning", "duplicate", f"{second}: holds the same values as {first}", second)
        elif rate and same and (first in commands) != (second in commands):
            rows, alike = relations.find_delay(part[second], part[first], round(0.2 * rate))
            if alike > _ALIKE and abs(rows) >= 2:
                late, early = (second, first) if rows > 0 else (first, second)
                text = f"follows {early} by {1e3 * abs(rows) / rate:.3g} ms (correlation {alike:.3f})"
                yield Issue("note", "late", f"{late}: {text}", late)
    # No data tell the sign and the size of commanded forces and motions of which nothing was measured.
    measured = {quantities.get(name) for name in channels if name not in commands}
    for name in channels:
        quantity = quantities.get(name)
        if name in commands and quantity in ("force", "velocity", "displacement") and quantity not in measured:
            text = f"is a command by its name, and no {quantity} was measured: nothing here shows its sign or scale"
            yield Issue("note", "command", f"{name}: {text}", name)
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
                text = f"is the derivative of {name} (gain {gain:.3f}); computed from it, no sensor of its own"
                yield Issue("note", "derived", f"{velocity}: {text}", velocity)
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
                text = f"changes by up to {np.max(change):.3g} N in {_REST:g} s after {name} has come to rest"
                said = f"{force}: {text}: it relaxes, its zero drifts, or its current changes"
                yield Issue("note", "relaxation", said, force)


def _windows(values: Array, rows: int) -> Array:
    """Return values in windows of so many rows, shape (windows, rows), without the rows at the end that fill none."""
    return values[: len(values) // rows * rows].reshape(-1, rows)
