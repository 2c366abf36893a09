"""Faults that data may have: wrong signs and units, exchanged channels, delays; each with its correction."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from seatsim.recordings.channel_units import BENCH_CHANNELS, SEAT_CHANNELS
from seatsim.recordings.compared import LEFT_OUT
from seatsim.recordings.quality.residual import filter_band, find_delay
from seatsim.recordings.quality.run_under_test import LATE, MOTION, RunUnderTest, Table
from seatsim.schema.arrays import Array
from seatsim.schema.units import USUAL, conversion

TOGETHER = (("floor_acceleration", "frame_acceleration", "driver_acceleration"), ("displacement", "velocity"))
"""Channels whose axis may point down for all of them."""
LONGEST_DELAY = 0.5
"""s; largest delay that is sought: half a period of the slowest motion considered."""
USUAL_REACH, EFFECTS_REACH = 5.0, {"damper_force": 30.0}
"""Factor by which effects may change the size of a channel; a damper without its current has a tenth of its force."""
SAME_PHASE = 0.05
"""Share that one gain and phase leave of a channel below which it is another one at a single frequency, so that effects
that change both of them in size and phase look like an exchange."""
TURNED = 0.5
"""Share of what one phase for all frequencies leaves below which a delay is told from a lag, friction or play."""
ALIKE = 0.8
"""Least correlation with the simulation for a channel to be its delayed copy: below it may be another motion."""


class DataFault(NamedTuple):
    """A fault that channels may have: `correct` takes the table of a run and returns it as it should be.

    `may_be_effect` says that an effect of the library can make a channel look like this.
    """

    kind: str
    channels: tuple[str, ...]
    says: str
    correct: Callable[[Table], Table]
    may_be_effect: bool = False


def list_faults(run: RunUnderTest, outputs: Table | None) -> Iterator[DataFault]:
    """Yield every fault that a run may have; delays are relative to simulated outputs."""
    for channel in run.table:
        yield from _scales(run, channel, outputs or {})
    for channels in TOGETHER:
        swapped = tuple(channel for channel in channels if channel in run.table)
        if len(swapped) > 1:
            yield DataFault("sign", swapped, "all their signs are swapped", _swapped(swapped))
    for first, second in itertools.combinations(MOTION[:3], 2):
        if first in run.table and second in run.table:
            pair = filter_band(run, np.array([run.table[first], run.table[second]]))
            yield exchange_fault(first, second)._replace(may_be_effect=_turned(*pair) < SAME_PHASE)
    yield from _delays(run, outputs or {})


def _scales(run: RunUnderTest, channel: str, outputs: Table) -> Iterator[DataFault]:
    if channel in MOTION or channel == "coil_current":
        is_biased = channel == "coil_current" and not run.opposes_command
        yield DataFault("sign", (channel,), "its sign is swapped", _scaled(channel, -1.0), is_biased)
    if channel in MOTION:
        wanted = (SEAT_CHANNELS | BENCH_CHANNELS)[channel]
        for unit in USUAL[wanted][1:]:
            factor = conversion(unit, wanted).factor
            is_near = _is_near(run, outputs) if channel == run.driver else is_within_reach(channel, factor)
            yield DataFault("unit", (channel,), f"reads as if in {unit}", _scaled(channel, factor), is_near)


def _is_near(run: RunUnderTest, outputs: Table) -> bool:
    """Return whether effects may change the outputs from what is simulated to the size that they have."""
    sizes = {
        c: float(np.std(run.table[c])) / max(float(np.std(values)), 1e-300)
        for c, values in outputs.items()
        if c in MOTION
    }
    return bool(sizes) and all(is_within_reach(channel, size) for channel, size in sizes.items())


def is_within_reach(channel: str, factor: float) -> bool:
    """Return whether an effect of the library may change the size of a channel by a factor."""
    reach = EFFECTS_REACH.get(channel, USUAL_REACH)
    return 1.0 / reach < factor < reach


def _scaled(channel: str, factor: float) -> Callable[[Table], Table]:
    return lambda table: {**table, channel: factor * table[channel]}


def _swapped(channels: Sequence[str]) -> Callable[[Table], Table]:
    return lambda table: {**table, **{channel: -table[channel] for channel in channels}}


def exchange_fault(first: str, second: str) -> DataFault:
    """Return the fault of two channels that are exchanged."""
    says = "are exchanged for each other"
    return DataFault("exchange", (first, second), says, lambda t: {**t, first: t[second], second: t[first]})


def _delays(run: RunUnderTest, outputs: Table) -> Iterator[DataFault]:
    """Yield each output's delay relative to the simulation, and the delay of the floor that explains the most."""
    skip = round(LEFT_OUT * run.rate)
    found, driving = [], filter_band(run, run.table.get(run.driver, np.zeros(run.rows)))
    for channel, values in outputs.items():
        recorded, simulated = filter_band(run, run.table[channel][skip:]), filter_band(run, values)
        late, alike = find_delay(recorded, simulated, round(LONGEST_DELAY * run.rate))
        if alike > ALIKE and abs(late) > (LATE if channel in MOTION else 2.0 * LATE) * run.rate:
            # At a single frequency, and for what turns the phase, a delay is one of many explanations.
            is_turned = (
                channel not in MOTION
                or 1.0 - alike**2 > TURNED * _turned(recorded, simulated)
                or _turned(_moved(driving, late), driving) < SAME_PHASE
            )
            found += [(late, is_turned)] if channel in MOTION else []
            yield _delay(channel, late, run.rate, is_turned)
    if found:
        late, is_turned = sorted(found)[len(found) // 2]
        yield _delay(run.driver, -late, run.rate, is_turned)


def _turned(recorded: Array, simulated: Array) -> float:
    """Return the share of a channel's power that the simulation leaves at one gain and phase for all frequencies."""
    from scipy.signal import hilbert

    parts = np.array([simulated, np.imag(hilbert(simulated))])
    shares = np.linalg.lstsq(parts.T, recorded, rcond=None)[0]
    return float(np.sum((recorded - shares @ parts) ** 2) / np.sum(recorded**2))


def _delay(channel: str, rows: int, rate: float, may_be_effect: bool) -> DataFault:
    says = f"is {abs(rows) / rate:.3g} s {'late' if rows > 0 else 'early'}"
    return DataFault(
        "late", (channel,), says, lambda table: {**table, channel: _moved(table[channel], rows)}, may_be_effect
    )


def _moved(values: Array, rows: int) -> Array:
    """Return values shifted `rows` earlier; the end that becomes empty repeats the edge value."""
    return values[np.clip(np.arange(len(values)) + rows, 0, len(values) - 1)]
