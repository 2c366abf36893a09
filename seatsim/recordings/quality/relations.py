"""What channels of a seat or a bench show of each other, how well they fit a simulation, and which fault explains it.

Signs and units that no law of motion permits need nothing of the rig. The consistency residual of a run is the sum of
`e(a, b)^2 = rms(a - b)^2 / (rms(a)^2 + rms(b)^2)` (0 alike, 1 unrelated or of another size, 2 opposite) over

    each compared channel against the simulation (the coil current at all frequencies),
    x'' against frame acceleration - floor acceleration (a bench: x' against velocity),
    Fd against -(ms zs'' + m zc'' + kf x + cf x'),

between 0.5 and 8 Hz, where the channels are recorded: in this band even a rough nominal agrees with its seat. A fault
is named where its correction lowers the residual by much, and where the corrected channel itself then fits. Correcting
an input requires a new simulation.
"""

import functools
import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import scipy  # loads `scipy.signal` where it is first used

from seatsim.recordings.quality.issue import LATE, Issue, RunUnderTest, Severity, Table, doubt
from seatsim.recordings.recording import BENCH_CHANNELS, COMMANDS, MOTION, SEAT_CHANNELS
from seatsim.recordings.replay import COMPARED, LEFT_OUT, replay_table
from seatsim.schema.arrays import Array
from seatsim.schema.errors import RunError
from seatsim.schema.units import USUAL, conversion

_ALIKE = 0.9
"""Correlation from which a factor between two sides of an equation is meant."""
MOST_ROWS = 120_000
"""Rows from which relations are computed."""
_TINY_FORCE, _MOVED = 5.0, 1e-3
"""N that a damper exceeds once it is moved by so many m."""
_OPEN, _CLOSED, _AS_GOOD = 0.05, 0.1, 2.0
"""Difference of two sides of an equation from which they contradict each other, share of it that a correction leaves at
most, and ratio to the least that is left up to which another correction does as well."""
_SURELY_ALIKE, _FAR = 0.97, 0.3
"""Correlation of a coil with its command, and share by which a factor differs from one, that no effect gives."""
_NEAR = 0.25
"""Share by which a factor may differ from that of a unit."""
_USUAL_REACH, _EFFECTS_REACH = 5.0, {"damper_force": 30.0}
"""Factor by which effects may change the size of a channel; a damper without its current has a tenth of its force."""


def doubt_relations(table: Table, rate: float) -> Iterator[Issue]:
    """Yield signs and units of a seat's or a bench's channels that contradict the laws of motion, whatever the rig."""
    part = {name: values[:MOST_ROWS] - float(np.mean(values[:MOST_ROWS])) for name, values in table.items()}
    yield from _force(part, rate)
    yield from _motion(part, rate)
    # On a stiff cushion the driver moves as the frame does, and a coil follows its command.
    yield from _copies(part, rate, ("frame_acceleration", "driver_acceleration", "m/s^2"), (0.5, 2.0))
    yield from _copies(part, rate, ("current_command", "coil_current", "A"), (0.0, 2.0))


def _copies(part: Table, rate: float, named: tuple[str, str, str], band: tuple[float, float]) -> Iterator[Issue]:
    """Yield what it means that a channel is another one in a band, but for its sign or its unit."""
    first, second, unit = named
    if first in part and second in part:
        gain, alike = regress(part[first], part[second], rate, *band)
        if alike > _ALIKE and (said := read_gain(gain, unit)):
            text = f"{second}: is {gain:.3g} times {first} below {band[1]:g} Hz: {said}, or that of {first} is wrong"
            yield Issue("warning", kind_of(gain), text, second)
        elif unit == "A" and alike > _SURELY_ALIKE and gain > 1.0 + _FAR:
            yield doubt("scale_of_current", second, gain=gain, other=first, band=band[1])


def kind_of(gain: float) -> str:
    """Return the kind of the issue that a gain is."""
    return "sign" if gain < 0.0 else "unit"


def _force(part: Table, rate: float) -> Iterator[Issue]:
    """Yield a damper force that drives the motion, where it opposes extension and dissipates, or that is tiny."""
    name = "displacement" if "displacement" in part else "suspension_displacement"
    if name not in part or "damper_force" not in part:
        return
    travel, force = part[name], part["damper_force"]
    largest, stroke = float(np.max(np.abs(force))), float(np.max(np.abs(travel)))
    if largest < _TINY_FORCE and stroke > _MOVED:
        yield doubt("tiny_force", "damper_force", largest=largest, stroke=1e3 * stroke)
    speed = np.gradient(travel, 1.0 / rate)
    gain, alike = regress(speed, force, rate, 0.05)
    if alike > 0.3 and gain < 0.0:
        yield doubt("driving_force", "damper_force", other=name)


def _motion(part: Table, rate: float) -> Iterator[Issue]:
    """Name the signs and units with which the travel's second derivative is frame - floor acceleration.

    No effect on a rig does what a swapped sign or a unit beyond the reach of effects does here: it is an error.
    """
    names = ("suspension_displacement", "frame_acceleration", "floor_acceleration")
    if not set(names) <= set(part):
        return
    slope = np.gradient(np.gradient(part[names[0]], 1.0 / rate), 1.0 / rate)
    sides = slope, part[names[1]], part[names[2]]
    target, frame, floor = (band_passed(each, rate, 0.7, min(8.0, 0.2 * rate)) for each in sides)
    before = _unlike(target, frame - floor)
    left = {
        (channels, said, factor): _unlike(*_corrected(channels, factor, target, frame, floor))
        for channels in ((names[0],), (names[1],), (names[2],), (names[2], names[1]))
        for said, factor in _list_factors(channels[0])
    }
    least = min(left.values())
    is_closed = before > _OPEN and least < _CLOSED * before
    for channels, said, factor in left if is_closed else ():
        if left[channels, said, factor] > _AS_GOOD * least:
            continue
        severity: Severity = "warning" if _is_within_reach(channels[0], factor) else "error"
        of_both = ": of both" if len(channels) > 1 else ":"
        exchanged = ", or the two are exchanged" if len(channels) > 1 and factor == -1.0 else ""
        text = f"{' and '.join(channels)}{of_both} {said}{exchanged}; travel and accelerations contradict each other"
        yield Issue(severity, kind_of(factor), text, channels[0])
    if not is_closed:
        yield from _scale(target, frame - floor, rate)


def _list_factors(channel: str) -> Iterator[tuple[str, float]]:
    """Yield what may be wrong with the scale of a channel, with the factor that corrects it."""
    wanted = SEAT_CHANNELS[channel]
    for unit in USUAL[wanted]:
        factor = conversion(unit, wanted).factor
        said = "" if unit == wanted else f"it reads as if in {unit}"
        if said:
            yield said, factor
        yield " and ".join(filter(None, (said, "its sign is swapped"))), -factor


def _corrected(
    channels: tuple[str, ...], factor: float, target: Array, frame: Array, floor: Array
) -> tuple[Array, Array]:
    """Return the travel's second derivative and frame - floor acceleration once some channels are corrected."""
    own = {"suspension_displacement": target, "frame_acceleration": frame, "floor_acceleration": floor}
    travel, moved, base = (factor * values if name in channels else values for name, values in own.items())
    return travel, moved - base


def _scale(target: Array, relative: Array, rate: float) -> Iterator[Issue]:
    """Yield that the travel's second derivative is frame - floor acceleration but for a factor, where it is."""
    product, power = float(target @ relative), float(relative @ relative)
    if product <= _ALIKE * float(np.linalg.norm(target)) * power**0.5:
        return
    gain = product / power
    if not 1.0 - _FAR < gain < 1.0 / (1.0 - _FAR):
        yield doubt("scale_of_travel", "suspension_displacement", gain=gain, rate=rate / gain**0.5)


def band_passed(values: Array, rate: float, low: float, high: float) -> Array:
    """Return values between two frequencies in Hz, by smooth edges in the frequency domain."""
    spectrum = np.fft.rfft(values * np.hanning(len(values)))
    frequency = np.fft.rfftfreq(len(values), 1.0 / rate)
    with np.errstate(divide="ignore"):
        edges = 1.0 / (1.0 + (frequency / high) ** 8) / (1.0 + (low / np.maximum(frequency, 1e-12)) ** 8)
    return np.fft.irfft(spectrum * edges, len(values))


def regress(expected: Array, measured: Array, rate: float, low: float = 0.5, high: float = 8.0) -> tuple[float, float]:
    """Return the gain of measured to expected between two frequencies, and their correlation without its sign."""
    high = min(high, 0.2 * rate)
    one, other = band_passed(expected, rate, low, high), band_passed(measured, rate, low, high)
    norm = float(np.linalg.norm(one) * np.linalg.norm(other))
    product = float(one @ other)
    return (product / float(one @ one), abs(product) / norm) if norm else (0.0, 0.0)


def read_gain(gain: float, unit: str) -> str:
    """Return what a gain of values in a unit means; empty where it is close to one, or means nothing."""
    sign = "its sign is swapped" if gain < 0.0 else ""
    if abs(abs(gain) - 1.0) < _NEAR:
        return sign
    for other in USUAL[unit]:
        if abs(abs(gain) * conversion(other, unit).factor - 1.0) < _NEAR:
            return f"it reads as if in {other}" + (f", and {sign}" if sign else "")
    return sign


def _is_within_reach(channel: str, factor: float) -> bool:
    """Return whether an effect of the library may change the size of a channel by a factor."""
    reach = _EFFECTS_REACH.get(channel, _USUAL_REACH)
    return 1.0 / reach < factor < reach


def _consistency_residuals(run: RunUnderTest, table: Table, outputs: Table | None) -> dict[str, float]:
    """Return e^2 of each compared channel (1 where there is no simulation) and of each balance between channels."""
    skip = round(LEFT_OUT * run.rate)
    used = {name: values[skip:] for name, values in table.items()}
    compared = [name for name in COMPARED[run.recording.header.rig] if name in used]
    pairs = {name: (used[name], np.zeros_like(used[name]) if outputs is None else outputs[name]) for name in compared}
    pairs |= _balances(run, used)
    if not pairs:
        return {}
    smooth = dict(zip(pairs, filter_band(run, np.array(list(pairs.values()))), strict=True))
    return {name: _unlike(*(pair if name == "coil_current" else smooth[name])) for name, pair in pairs.items()}


def _balances(run: RunUnderTest, used: Table) -> Iterator[tuple[str, tuple[Array, Array]]]:
    """Yield name and both sides of each equation between recorded channels alone."""
    plant = run.nominal.plant
    travel = used.get("suspension_displacement")
    if {"displacement", "velocity"} <= set(used):
        yield "velocity balance", (_slope(run, used["displacement"]), used["velocity"])
    if plant is None or travel is None or "frame_acceleration" not in used:
        return
    frame, speed = used["frame_acceleration"], _slope(run, travel)
    yield "motion balance", (_slope(run, speed), frame - used["floor_acceleration"])
    if {"damper_force", "driver_acceleration"} <= set(used):
        inertia = plant.frame_mass * frame + plant.driver_mass * used["driver_acceleration"]
        spring = plant.suspension_stiffness * travel + plant.suspension_damping * speed
        yield "force balance", (used["damper_force"], -inertia - spring)


def _slope(run: RunUnderTest, values: Array) -> Array:
    return np.asarray(np.gradient(filter_band(run, values), 1.0 / run.rate))


def _unlike(first: Array, second: Array) -> float:
    """Return e^2: 0 alike, 1 unrelated, 2 opposite."""
    size = float(np.mean(first**2) + np.mean(second**2))
    return float(np.mean((first - second) ** 2)) / size if size > 0.0 else 0.0


def filter_band(run: RunUnderTest, values: Array) -> Array:
    """Return values, shape (..., N), between 0.5 and 8 Hz (a bench: below 8 Hz, without their mean)."""
    sections, rows = _filter(run.rate, run.recording.header.rig == "seat"), values.shape[-1]
    swinging = values - np.mean(values, axis=-1, keepdims=True)
    return np.asarray(scipy.signal.sosfiltfilt(sections, swinging, padlen=min(3 * rows // 4, 100)))


@functools.cache
def _filter(rate: float, on_seat: bool) -> Array:
    high = min(8.0, 0.4 * rate)
    edges = (min(0.5, 0.5 * high), high) if on_seat else high
    return np.asarray(scipy.signal.butter(2, edges, "bandpass" if on_seat else "lowpass", fs=rate, output="sos"))


def find_delay(first: Array, second: Array, most: int) -> tuple[int, float]:
    """Return the delay of the first relative to the second in rows, and their correlation at that delay."""
    product = scipy.signal.correlate(first, second, method="fft")[len(second) - 1 - most : len(second) + most]
    size = float(np.linalg.norm(first) * np.linalg.norm(second))
    peak = int(np.argmax(product))
    return peak - most, float(product[peak]) / size if size > 0.0 else 0.0


_TOGETHER = (("floor_acceleration", "frame_acceleration", "driver_acceleration"), ("displacement", "velocity"))
"""Channels whose axis may point down for all of them."""
_LONGEST_DELAY = 0.5
"""s; largest delay that is sought: half a period of the slowest motion considered."""
_SAME_PHASE = 0.05
"""Share that one gain and phase leave of a channel below which it is another one at a single frequency, so that effects
that change both of them in size and phase look like an exchange."""
_TURNED = 0.5
"""Share of what one phase for all frequencies leaves below which a delay is told from a lag, friction or play."""
_DELAYED_COPY = 0.8
"""Least correlation with the simulation for a channel to be its delayed copy: below it may be another motion."""
_INPUTS = ("floor_acceleration", "displacement", "velocity", *COMMANDS)
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
_EXPLAINS_AS_WELL = 0.1
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
            is_near = _is_near(run, outputs) if channel == run.driver else _is_within_reach(channel, factor)
            yield _DataFault("unit", (channel,), f"reads as if in {unit}", _scaled((channel,), factor), is_near)


def _is_near(run: RunUnderTest, outputs: Table) -> bool:
    """Return whether effects may change the outputs from what is simulated to the size that they have."""
    spreads = {c: (float(np.std(run.table[c])), float(np.std(outputs[c]))) for c in outputs if c in MOTION}
    return bool(spreads) and all(_is_within_reach(c, seen / max(own, 1e-300)) for c, (seen, own) in spreads.items())


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
        if alike > _DELAYED_COPY and abs(late) > (LATE if channel in MOTION else 2.0 * LATE) * run.rate:
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
    return _consistency_residuals(run, table, _simulate_nominal(run, driving))["coil_current"]


def check_consistency(run: RunUnderTest) -> Iterator[Issue]:
    """Name the fault whose correction lowers the residual of a run most, and those that lower it equally."""
    outputs = _simulate_nominal(run, run.table)
    before = _consistency_residuals(run, run.table, outputs)
    fall = {}
    for fault in _possible(run, before, outputs):
        table = fault.correct(run.table)
        inputs = {c: table[c] for c in _INPUTS if c in table and table[c] is not run.table[c]}
        after = _consistency_residuals(
            run, table, _simulate_nominal(run, {**run.table, **inputs}) if inputs else outputs
        )
        if _explains(fault, before, after):
            fall[fault] = sum(before.values()) - sum(after.values())
    named = sorted(
        (d for d in fall if fall[d] > max(fall.values()) - _EXPLAINS_AS_WELL), key=lambda fault: -fall[fault]
    )
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
