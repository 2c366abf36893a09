"""Faults that data may have, each with its correction, and which of them makes a run contradict its nominal rig.

A fault is named where its correction lowers the consistency residual (see `residual`) by much, and where the corrected
channel itself then fits. Correcting an input requires a new simulation.
"""

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from seatsim.recordings.quality.issue import LATE, Issue, RunUnderTest, Severity, Table
from seatsim.recordings.quality.relations import consistency_residuals, filter_band, find_delay, is_within_reach
from seatsim.recordings.recording import BENCH_CHANNELS, MOTION, SEAT_CHANNELS
from seatsim.recordings.replay import LEFT_OUT, replay_table
from seatsim.schema.arrays import Array
from seatsim.schema.errors import RunError
from seatsim.schema.units import USUAL, conversion

_TOGETHER = (("floor_acceleration", "frame_acceleration", "driver_acceleration"), ("displacement", "velocity"))
"""Channels whose axis may point down for all of them."""
_LONGEST_DELAY = 0.5
"""s; largest delay that is sought: half a period of the slowest motion considered."""
_SAME_PHASE = 0.05
"""Share that one gain and phase leave of a channel below which it is another one at a single frequency, so that effects
that change both of them in size and phase look like an exchange."""
_TURNED = 0.5
"""Share of what one phase for all frequencies leaves below which a delay is told from a lag, friction or play."""
_ALIKE = 0.8
"""Least correlation with the simulation for a channel to be its delayed copy: below it may be another motion."""
_INPUTS = ("floor_acceleration", "displacement", "velocity", "current_command", "command_voltage")
"""Channels that drive the simulation."""
_GROSS, _DELAYED = 0.4, 0.2
"""Least fall of the residual for a fault to be named, and for a delay. A flipped sign raises e^2 of a channel by up to
2, a wrong unit by 1. Where mass, stiffness or damper of the nominal are far off, no correction gains more than 0.4."""
_EXCHANGED, _LEFT_BY_EXCHANGE = 0.002, 0.3
"""Residual of the coil from which currents may be exchanged, and largest share of it that undoing the exchange leaves.
A coil follows its command so closely that the right assignment leaves almost nothing."""
_FITS = 0.1
"""Largest mean residual of the channels that a correction changed for them to fit. A fault of the data is exact: its
correction leaves what the rig differs from its nominal. An effect that resembles one leaves more."""
_CHANGED = 0.05
"""Least change of a residual that counts as an influence of the correction."""
_AS_GOOD = 0.1
"""Difference to the largest fall of the residual within which another fault explains the run equally well."""


def _simulate_nominal(run: RunUnderTest, table: Table) -> Table | None:
    """Return the nominal outputs that are compared, driven by a table's inputs; None where there is no solution."""
    try:
        return replay_table(run.nominal, run.recording, table)
    except RunError:
        return None


class _DataFault(NamedTuple):
    """A fault that channels may have: `correct` takes the table of a run and returns it as it should be.

    `may_be_effect` says that an effect of the library can make a channel look like this.
    """

    kind: str
    channels: tuple[str, ...]
    says: str
    correct: Callable[[Table], Table]
    may_be_effect: bool = False


def _list_faults(run: RunUnderTest, outputs: Table | None) -> Iterator[_DataFault]:
    """Yield every fault that a run may have; delays are relative to simulated outputs."""
    for channel in run.table:
        yield from _scales(run, channel, outputs or {})
    for channels in _TOGETHER:
        swapped = tuple(channel for channel in channels if channel in run.table)
        if len(swapped) > 1:
            yield _DataFault("sign", swapped, "all their signs are swapped", _scaled(swapped, -1.0))
    for first, second in itertools.combinations(MOTION[:3], 2):
        if first in run.table and second in run.table:
            pair = filter_band(run, np.array([run.table[first], run.table[second]]))
            yield _exchange_fault(first, second)._replace(may_be_effect=_turned(*pair) < _SAME_PHASE)
    yield from _delays(run, outputs or {})


def _scales(run: RunUnderTest, channel: str, outputs: Table) -> Iterator[_DataFault]:
    if channel in MOTION or channel == "coil_current":
        is_biased = channel == "coil_current" and not run.opposes_command
        yield _DataFault("sign", (channel,), "its sign is swapped", _scaled((channel,), -1.0), is_biased)
    if channel in MOTION:
        wanted = (SEAT_CHANNELS | BENCH_CHANNELS)[channel]
        for unit in USUAL[wanted][1:]:
            factor = conversion(unit, wanted).factor
            is_near = _is_near(run, outputs) if channel == run.driver else is_within_reach(channel, factor)
            yield _DataFault("unit", (channel,), f"reads as if in {unit}", _scaled((channel,), factor), is_near)


def _is_near(run: RunUnderTest, outputs: Table) -> bool:
    """Return whether effects may change the outputs from what is simulated to the size that they have."""
    spreads = {c: (float(np.std(run.table[c])), float(np.std(outputs[c]))) for c in outputs if c in MOTION}
    return bool(spreads) and all(is_within_reach(c, seen / max(own, 1e-300)) for c, (seen, own) in spreads.items())


def _scaled(channels: Sequence[str], factor: float) -> Callable[[Table], Table]:
    return lambda table: {**table, **{channel: factor * table[channel] for channel in channels}}


def _exchange_fault(first: str, second: str) -> _DataFault:
    """Return the fault of two channels that are exchanged."""
    says = "are exchanged for each other"
    return _DataFault("exchange", (first, second), says, lambda t: {**t, first: t[second], second: t[first]})


def _delays(run: RunUnderTest, outputs: Table) -> Iterator[_DataFault]:
    """Yield each output's delay relative to the simulation, and the delay of the floor that explains the most."""
    skip = round(LEFT_OUT * run.rate)
    found, driving = [], filter_band(run, run.table.get(run.driver, np.zeros(run.rows)))
    for channel, values in outputs.items():
        recorded, simulated = filter_band(run, run.table[channel][skip:]), filter_band(run, values)
        late, alike = find_delay(recorded, simulated, round(_LONGEST_DELAY * run.rate))
        if alike > _ALIKE and abs(late) > (LATE if channel in MOTION else 2.0 * LATE) * run.rate:
            # At a single frequency, and for what turns the phase, a delay is one of many explanations.
            is_turned = (
                channel not in MOTION
                or 1.0 - alike**2 > _TURNED * _turned(recorded, simulated)
                or _turned(_moved(driving, late), driving) < _SAME_PHASE
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


def _delay(channel: str, rows: int, rate: float, may_be_effect: bool) -> _DataFault:
    says = f"is {abs(rows) / rate:.3g} s {'late' if rows > 0 else 'early'}"
    return _DataFault("late", (channel,), says, lambda t: {**t, channel: _moved(t[channel], rows)}, may_be_effect)


def _moved(values: Array, rows: int) -> Array:
    """Return values shifted `rows` earlier; the end that becomes empty repeats the edge value."""
    return values[np.clip(np.arange(len(values)) + rows, 0, len(values) - 1)]


def check_exchanged_currents(run: RunUnderTest) -> Iterator[Issue]:
    """Report a run in which the coil current follows the command much better once the two are exchanged."""
    fault = _exchange_fault("current_command", "coil_current")
    if not set(fault.channels) <= set(run.table):
        return
    before = _coil_residual(run, run.table)
    if before > _EXCHANGED and _coil_residual(run, fault.correct(run.table)) < min(_LEFT_BY_EXCHANGE * before, _FITS):
        yield _named(run, [fault])


def _coil_residual(run: RunUnderTest, table: Table) -> float:
    driving = {**run.table, "current_command": table["current_command"]}
    return consistency_residuals(run, table, _simulate_nominal(run, driving))["coil_current"]


def check_consistency(run: RunUnderTest) -> Iterator[Issue]:
    """Name the fault whose correction lowers the residual of a run most, and those that lower it equally."""
    outputs = _simulate_nominal(run, run.table)
    before = consistency_residuals(run, run.table, outputs)
    fall = {}
    for fault in _possible(run, before, outputs):
        table = fault.correct(run.table)
        inputs = {c: table[c] for c in _INPUTS if c in table and table[c] is not run.table[c]}
        after = consistency_residuals(
            run, table, _simulate_nominal(run, {**run.table, **inputs}) if inputs else outputs
        )
        if _explains(fault, before, after):
            fall[fault] = sum(before.values()) - sum(after.values())
    named = sorted((d for d in fall if fall[d] > max(fall.values()) - _AS_GOOD), key=lambda fault: -fall[fault])
    if named:
        yield _named(run, named)


def _possible(run: RunUnderTest, before: Mapping[str, float], outputs: Table | None) -> Iterator[_DataFault]:
    """Yield each fault that could explain such a residual; a fault of an input affects most outputs."""
    if sum(before.values()) < _DELAYED:
        return
    is_driven_wrong = float(np.median([size for name, size in before.items() if name in MOTION])) > 0.5 * _DELAYED
    for fault in _list_faults(run, outputs):
        if is_driven_wrong or not set(_INPUTS) & set(fault.channels):
            yield fault


def _explains(fault: _DataFault, before: Mapping[str, float], after: Mapping[str, float]) -> bool:
    """Say whether the correction of a fault lowers the residual by much and makes the changed channels fit."""
    changed = [name for name in before if abs(before[name] - after[name]) > _CHANGED]
    fall = sum(before.values()) - sum(after.values())
    is_large = fall >= (_DELAYED if fault.kind == "late" else _GROSS)
    return is_large and float(np.mean([after[name] for name in changed])) <= _FITS


def _named(run: RunUnderTest, explanations: Sequence[_DataFault]) -> Issue:
    """Return the issue for faults that explain a run equally well, the best first."""
    first, *others = explanations
    said = [f"{' and '.join(first.channels)}: {first.says}"]
    said += [f"{' and '.join(d.channels)} {d.says}" for d in others if d.channels != first.channels]
    mend = "correct it, in an import by the keys sign, unit or delay of the map, and compare again"
    if any(fault.may_be_effect for fault in explanations):
        mend = f"an effect may do this too; {mend} if it is none"
    severity: Severity = "warning" if any(fault.may_be_effect for fault in explanations) else "error"
    return Issue(severity, first.kind, f"{run.name}, {', or '.join(said)}; {mend}", first.channels[0], run.name)
