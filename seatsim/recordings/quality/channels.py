"""Faults of a channel of a run that its own values show: their range, their size and their shape."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from seatsim.recordings.quality import damage
from seatsim.recordings.quality.issue import Issue, RunUnderTest, Severity, is_at_rest, place_in_run
from seatsim.recordings.recording import ACCELEROMETERS, COMMANDS, MOTION
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
        yield run.issue("dead", channel, value=values[0])
    elif (channel in MOTION or noise > 0.0) and np.ptp(values) == 0.0:
        yield run.issue("at_rest", channel, value=values[0])
    elif channel in MOTION and run.is_still(channel) and channel != run.driver:
        yield run.issue("silent", channel, noise=noise)


def _current(run: RunUnderTest, channel: str, gain: float) -> Iterator[Issue]:
    """Report a current, or a voltage that commands one, outside the range of the coil."""
    values, most = gain * run.table[channel], run.nominal.coil.max_current
    low, high = float(np.min(values)), float(np.max(values))
    if max(-low, high) > 30.0 * most:
        unit = run.recording.channels[channel].unit
        yield run.issue("current_in_mA", channel, low=low, high=high, most=most, unit=unit)
    elif -low > max(0.25 * most, 2.0 * high):
        # A sensor's zero may be off, that of a command not: only its command tells the sign of a current for sure.
        is_sure = channel != "coil_current" or run.opposes_command
        yield run.issue("current_swapped" if is_sure else "current_off_or_swapped", channel, low=low, high=high)
    elif -low > 0.25 * most or high > 1.3 * most:
        yield run.issue("current_range", channel, low=low, high=high, most=most)


def check_shapes(run: RunUnderTest) -> Iterator[Issue]:
    """Report clipped tops, values repeated over several rows, and stretches without change.

    Only a channel whose noise is finer than its resolution is known to be clipped or stuck. A coil current may rest at
    the limit of its supply, and any other channel where friction or play holds what it measures.
    """
    for channel, values in run.table.items():
        if channel in (*COMMANDS, "damper_temperature") or np.ptp(values) == 0.0:
            continue
        is_sure = channel in MOTION and damage.is_fine(run, channel)
        for extreme, rows in damage.flat_tops(values):
            severity: Severity | None = "error" if is_sure and rows > _CLIPPED * len(values) else None
            name = "clipped_sensor" if is_sure else "rests_at_extreme"
            yield run.issue(name, channel, severity, rows=rows, extreme=extreme)
        if run.noise(channel) > damage.quantum(values):
            yield from _held(run, channel, is_sure)


def check_sizes(run: RunUnderTest) -> Iterator[Issue]:
    """Report motions and temperatures that no seat reaches; only a comparison tells of which unit they are."""
    for channel in (*MOTION, "damper_temperature"):
        if channel in run.table and (text := say_implausible(run.table[channel], run.recording.channels[channel].unit)):
            yield run.issue("impossible", channel, said=text)


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
        yield run.issue("stuck", channel, first=rows.start / run.rate, last=rows.stop / run.rate)
    elif usual >= 2 and np.mean(lengths == usual) > damage.REGULAR:
        yield run.issue("held_channel", channel, rows=usual)


def _moves_beside(run: RunUnderTest, channel: str, rows: slice) -> bool:
    """Say whether another channel moves in some rows, as is assumed where there is none."""
    others = [name for name in MOTION if name in run.table and name != channel]
    return not others or any(not is_at_rest(run.table[name][rows], run.noise(name)) for name in others)
