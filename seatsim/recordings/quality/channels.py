"""Faults of a channel of a run that its own values show: their range, their size and their shape."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from seatsim.recordings.quality import damage
from seatsim.recordings.quality.issue import Issue, RunUnderTest, is_at_rest, place_in_run
from seatsim.recordings.recording import ACCELEROMETERS, MOTION
from seatsim.schema.arrays import Array
from seatsim.schema.fields import read_packaged
from seatsim.schema.units import conversion

_PLAUSIBLE = read_packaged(Path(__file__).with_name("plausible.yaml"), dict[str, tuple[float, float, tuple[str, ...]]])
"""By SI unit the range of the size of values, of the values themselves for temperatures, and the units to which values
outside it point, the likeliest first."""
_STUCK = 0.5
"""s; a noisy channel without any change for this long is stuck."""
_STEADY = ("suspension_displacement", "displacement", "velocity")
"""Channels that inertia keeps from jumping: a force and an acceleration jump where a current is switched."""
_BEYOND_SWITCHES = 6.0
"""Size in standard deviations of a single row that no switched current makes."""
_CLIPPED = 0.002
"""Share of rows at an extreme above which clipping is an error."""


def say_implausible(values: Array, unit: str) -> str:
    """Return what is said of values in an SI unit that no seat reaches, empty where a seat may reach them."""
    if unit not in _PLAUSIBLE or _is_plausible(values, unit):
        return ""
    low, _, others = _PLAUSIBLE[unit]
    extreme = float(values[np.argmax(np.abs(values))])
    read = {other: conversion(other, unit) for other in others}
    fitting = [other for other, (factor, zero) in read.items() if _is_plausible(factor * values + zero, unit)]
    guess = f"; is it in {' or '.join(fitting)}?" if fitting else ""
    return f"reaches {abs(extreme) if low == 0.0 else extreme:.4g} in SI units, more than a seat does{guess}"


def _is_plausible(values: Array, unit: str) -> bool:
    low, high, _ = _PLAUSIBLE[unit]
    return bool(np.max(np.abs(values)) <= high if low == 0.0 else low <= np.min(values) and np.max(values) <= high)


def check_ranges(run: RunUnderTest) -> Iterator[Issue]:
    """Report constant channels, and currents out of range."""
    for channel in run.table:
        yield from _constant(run, channel)
    gains = {"current_command": 1.0, "coil_current": 1.0, "command_voltage": run.recording.voltage_gain}
    for channel, gain in gains.items():
        if channel in run.table and gain is not None:
            yield from _current(run, channel, gain)


def _constant(run: RunUnderTest, channel: str) -> Iterator[Issue]:
    values, noise = run.table[channel], run.noise(channel)
    # Friction and play may hold a travel, a coil its current: nothing lets an acceleration rest.
    if channel in ACCELEROMETERS and np.ptp(values) == 0.0:
        text = f"is {values[0]:g} throughout; the sensor is dead: repair it or remove the channel"
        yield run.issue("error", "constant", text, channel)
    elif (channel in MOTION or noise > 0.0) and np.ptp(values) == 0.0:
        text = f"is {values[0]:g} throughout; what it measures rests, or the sensor is dead: it cannot be assessed"
        yield run.issue("warning", "constant", text, channel)
    elif channel in MOTION and run.is_still(channel) and channel != run.driver:
        text = f"shows hardly more than its noise of {noise:g}; it cannot be assessed"
        yield run.issue("warning", "silent", text, channel)


def _current(run: RunUnderTest, channel: str, gain: float) -> Iterator[Issue]:
    """Report a current, or a voltage that commands one, outside the range of the coil."""
    values, most = gain * run.table[channel], run.nominal.coil.max_current
    unit = run.recording.channels[channel].unit
    low, high = float(np.min(values)), float(np.max(values))
    seen = f"ranges from {low:.3g} to {high:.3g} A"
    if max(-low, high) > 30.0 * most:
        text = f"{seen} where max_current is {most:g} A; is it in m{unit}? convert it to {unit}"
        yield run.issue("error", "unit", text, channel)
    elif -low > max(0.25 * most, 2.0 * high):
        # A sensor's zero may be off, that of a command not: only its command tells the sign of a current for sure.
        is_sure = channel != "coil_current" or run.opposes_command
        text = "its sign is swapped: turn it" if is_sure else "its sign is swapped, or its zero is off: check both"
        yield run.issue("error" if is_sure else "warning", "sign", f"{seen}; {text}", channel)
    elif -low > 0.25 * most or high > 1.3 * most:
        text = f"{seen}, outside 0 to {most:g} A; check its zero and its scale"
        yield run.issue("warning", "range", text, channel)


def check_shapes(run: RunUnderTest) -> Iterator[Issue]:
    """Report clipped tops, values repeated over several rows, and stretches without change.

    Only a channel whose noise is finer than its resolution is known to be clipped or stuck. A coil current may rest at
    the limit of its supply, and any other channel where friction or play holds what it measures.
    """
    for channel, values in run.table.items():
        if channel in ("current_command", "command_voltage", "damper_temperature") or np.ptp(values) == 0.0:
            continue
        is_sure = channel in MOTION and damage.is_fine(run, channel)
        for extreme, rows in damage.flat_tops(values):
            is_error = is_sure and rows > _CLIPPED * len(values)
            text = f"{rows} rows stand at its extreme {extreme:.4g}"
            cause = "it is clipped: widen its range" if is_sure else "it rests there, or is clipped: look at its range"
            yield run.issue("error" if is_error else "warning", "clipped", f"{text}; {cause}", channel)
        if run.noise(channel) > damage.quantum(values):
            yield from _held(run, channel, is_sure)


def check_sizes(run: RunUnderTest) -> Iterator[Issue]:
    """Report motions and temperatures that no seat reaches; only a comparison tells of which unit they are."""
    for channel in (*MOTION, "damper_temperature"):
        if channel in run.table and (text := say_implausible(run.table[channel], run.recording.channels[channel].unit)):
            yield run.issue("error", "unit", f"{text}; correct its unit", channel)


def check_damage(run: RunUnderTest) -> Iterator[Issue]:
    """Report dropouts of the channels that move, and spikes beyond what a switched current makes of them."""
    for channel in MOTION:
        if channel in run.table and np.ptp(run.table[channel]) > 0.0:
            doubter, values = damage.Doubter(channel, run.rate), run.table[channel]
            found = [*damage.doubt_dropouts(doubter, values, *damage.plateaus(values))]
            found += damage.doubt_spikes(doubter, values, damage.NOTABLE if channel in _STEADY else _BEYOND_SWITCHES)
            yield from place_in_run(run.name, found)


def _held(run: RunUnderTest, channel: str, is_sure: bool) -> Iterator[Issue]:
    lengths, starts = damage.plateaus(run.table[channel])
    longest, usual = int(np.argmax(lengths)), int(np.median(lengths))
    rows = slice(starts[longest], starts[longest] + lengths[longest])
    if is_sure and lengths[longest] > max(_STUCK * run.rate, 20) and _moves_beside(run, channel, rows):
        text = f"is stuck from {rows.start / run.rate:.3g} to {rows.stop / run.rate:.3g} s"
        yield run.issue("error", "stuck", f"{text}; cut the run there or repair the sensor", channel)
    elif usual >= 2 and np.mean(lengths == usual) > damage.REGULAR:
        text = f"holds each value for {usual} rows; its own rate is lower: interpolate it"
        yield run.issue("warning", "held", text, channel)


def _moves_beside(run: RunUnderTest, channel: str, rows: slice) -> bool:
    """Say whether another channel moves in some rows, as is assumed where there is none."""
    others = [name for name in MOTION if name in run.table and name != channel]
    return not others or any(not is_at_rest(run.table[name][rows], run.noise(name)) for name in others)
