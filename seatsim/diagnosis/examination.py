"""What is wrong with a recording, said before anything is fitted.

An `error` would lead to a wrong confident verdict, so that the diagnosis refuses; a `warning` is said and the diagnosis
goes on; a `note` is worth knowing. Thresholds are gross, because the gap between a rig and its simulation is no damage.

Wrong signs, units, exchanged channels and delays are told by undoing them. With `e(a, b) = rms(a - b) /
sqrt(rms(a)^2 + rms(b)^2)` (0 alike, 1 unrelated or of another size, 1.41 opposite) between 0.5 and 8 Hz, the misfit of
a run is the sum of e^2 over

    each compared channel against the nominal simulation,
    x'' against frame acceleration - floor acceleration (a bench: x' against velocity),
    Fd against -(ms zs'' + m zc'' + kf x + cf x'),

where the channels are there. A damage is named where undoing it lowers the misfit grossly, and where the channel itself
then fits. Undoing one on an input takes a new simulation.
"""

from __future__ import annotations

import dataclasses
import functools
import itertools
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.errors import InputError, RunError
from seatsim.recording import Recording
from seatsim.replay import COMPARED, LEAST_ROWS, LEFT_OUT, replay, single
from seatsim.scenario import Scenario
from seatsim.temperature import Thermal

Array = NDArray[np.float64]
Table = Mapping[str, Array]
Severity = Literal["error", "warning", "note"]

MOTION = (
    "floor_acceleration", "frame_acceleration", "driver_acceleration", "suspension_displacement", "displacement",
    "velocity", "damper_force",
)  # fmt: skip
DRIVERS = ("floor_acceleration", "displacement", "velocity", "current_command", "command_voltage")
"""Channels that drive the simulation."""
UNITS: dict[str, dict[str, float]] = {
    "acceleration": {"g": 1 / 9.81, "ft/s^2": 1 / 0.3048, "cm/s^2": 100.0, "mm/s^2": 1000.0},
    "displacement": {"inch": 1 / 0.0254, "cm": 100.0, "mm": 1000.0},
    "velocity": {"cm/s": 100.0, "mm/s": 1000.0},
    "force": {"kN": 0.001},
}
"""What a channel of motion or force reads in another unit, per SI unit, by the last word of its name."""
SHORTEST, SHORT = 4.0, 10.0
"""Seconds compared in all runs together below which nothing can be diagnosed, or not well."""
STUCK = 0.5
"""Seconds without any change that a noisy channel does not have."""
CLIPPED = 0.002
"""Share of rows at an extreme above which clipping is an error."""
NOISE_OFF = 3.0
"""Factor by which the noise may differ from what is stated."""
LATE = 0.05
"""Seconds by which no channel of a healthy recording is late; a coil, which may be slow, twice that."""
GROSS, DELAYED, EXCHANGED = 0.4, 0.2, 0.002
"""Fall of the misfit from which a damage is named; for a delay; misfit of the coil that asks for exchanged currents."""


class Finding(NamedTuple):
    """One thing found; `kind` is a word for it, `channel` and `run` are None where it is about all of them."""

    severity: Severity
    kind: str
    sentence: str
    channel: str | None = None
    run: str | None = None


@dataclass(frozen=True)
class Examination:
    """All findings, errors first."""

    findings: list[Finding]

    @property
    def errors(self) -> list[Finding]:
        """Findings for which the diagnosis must refuse."""
        return [finding for finding in self.findings if finding.severity == "error"]


class Run(NamedTuple):
    """One run under examination: its table, and what the recording says about it."""

    name: str
    table: Table
    recording: Recording
    nominal: Scenario

    @property
    def rate(self) -> float:
        """Rows per second."""
        return self.recording.header.sample_rate

    def noise(self, channel: str) -> float:
        """Return the stated noise of a channel."""
        return self.recording.channels[channel].noise_rms


def examine(recording: Recording) -> Examination:
    """Look at all runs of a recording and say what is wrong with them.

    Raises:
        InputError: the nominal scenario is wrong.
    """
    nominal = single(recording.nominal)
    runs, findings = [], []
    for name in recording.runs:
        try:
            table = recording.table(name)
            findings += list(_clock(recording, name))
            runs.append(Run(name, table, recording, nominal))
        except InputError as error:
            findings.append(Finding("error", "unreadable", str(error), run=name))
    if not _stopped(findings):
        findings += [*_length(runs), *_runs(runs), *_noise(runs), *_fahrenheit(runs)]
    if not _stopped(findings):
        findings += _merged(list(itertools.chain(*map(_each, runs))), len(runs))
    order = ("error", "warning", "note")
    return Examination(sorted(findings, key=lambda finding: order.index(finding.severity)))


def refuse(examination: Examination) -> None:
    """Raise what stands against a diagnosis, in one sentence.

    Raises:
        InputError: there is an error among the findings.
    """
    errors = examination.errors
    if errors:
        more = f" (and {len(errors) - 1} more)" if len(errors) > 1 else ""
        raise InputError(f"{errors[0].sentence}{more}")


def _each(run: Run) -> list[Finding]:
    """Return what is wrong with one run; a later check asks only where the earlier ones found no error."""
    findings: list[Finding] = []
    for check in (_levels, _exchanged_currents, _shape, _fit):
        findings += check(run)
        if _stopped(findings):
            break
    return findings


def _stopped(findings: list[Finding]) -> bool:
    return any(finding.severity == "error" for finding in findings)


def _merged(findings: list[Finding], runs: int) -> list[Finding]:
    """Return the findings with those that all runs share said once."""
    groups: dict[tuple[str, str, str | None], list[Finding]] = {}
    for finding in findings:
        groups.setdefault(finding[:2] + finding[3:4], []).append(finding)
    merged = []
    for group in groups.values():
        if runs > 1 and len({finding.run for finding in group}) == runs:
            first = group[0]
            text = first.sentence.replace(str(first.run), f"all runs (shown: {first.run})", 1)
            merged.append(first._replace(sentence=text, run=None))
        else:
            merged += group
    return merged


def _clock(recording: Recording, name: str) -> Iterator[Finding]:
    """Compare the column `time` of a run, where there is one, with the stated sample rate."""
    import pandas as pd

    path, interval = recording.folder / recording.runs[name].file, 1.0 / recording.header.sample_rate
    frame = pd.read_csv(path, usecols=lambda column: column == "time")
    if "time" not in frame:
        return
    time = pd.to_numeric(frame["time"], errors="coerce").to_numpy(dtype=np.float64)
    steps = np.diff(time) / interval
    jumps = np.flatnonzero(~(np.abs(steps - 1.0) <= 0.75))
    mean = float(np.mean(steps[np.abs(steps - 1.0) <= 0.75])) if len(jumps) < len(steps) else 0.0
    typical = float(np.median(steps))
    if not (abs(typical - 1.0) <= 0.3 and abs(mean - 1.0) <= 0.005):
        apart = f"rows are {typical * interval:.5g} s apart where sample_rate {recording.header.sample_rate:g} means"
        yield Finding("error", "rate", f"{name}, time: {apart} {interval:.5g} s; resample the run or correct the rate",
                      "time", name)  # fmt: skip
    elif jumps.size:
        lost = float(np.sum(np.abs(steps[jumps] - 1.0))) * interval
        severity: Severity = "error" if not lost <= LATE else "warning"
        place = f"{name}, time: {jumps.size} jumps, the first at {time[jumps[0]]:.3f} s (line {jumps[0] + 3})"
        yield Finding(severity, "jump", f"{place}; rows are missing: fill them or cut the run there", "time", name)


def _length(runs: list[Run]) -> Iterator[Finding]:
    seconds = [len(next(iter(run.table.values()))) / run.rate - LEFT_OUT for run in runs]
    for run, left in zip(runs, seconds, strict=True):
        if left * run.rate < LEAST_ROWS:
            text = f"{run.name}: lasts {left + LEFT_OUT:.3g} s and its first second is left out; remove or record anew"
            yield Finding("error", "short", text, run=run.name)
    total = sum(seconds)
    if total < SHORT:
        text = f"all runs: {total:.3g} s remain to compare, at least {SHORT:g} s are wanted; record more"
        yield Finding("warning" if total >= SHORTEST else "error", "short", text)
    if len(runs) == 1:
        text = f"{runs[0].name}: is the only run, so that no other excitation checks the verdict; record a second run"
        yield Finding("warning", "single", text, run=runs[0].name)


def _runs(runs: list[Run]) -> Iterator[Finding]:
    """Compare runs with each other: duplicates, declared repeats, runs at rest."""
    for first, second in itertools.combinations(runs, 2):
        rows = min(len(next(iter(run.table.values()))) for run in (first, second))
        same = np.mean([np.mean(first.table[c][:rows] == second.table[c][:rows]) for c in first.table])
        if same > 0.9:
            text = f"{second.name}: holds the same rows as {first.name}, so that it checks nothing; remove one of them"
            yield Finding("error", "duplicate", text, run=second.name)
    named = {run.name: run for run in runs}
    for run in runs:
        other = run.recording.runs[run.name].repeat_of
        if other is not None and other in named and not _repeats(run, named[other]):
            text = f"{run.name}: is no repeat of {other}, their excitations differ; remove repeat_of"
            yield Finding("error", "repeat", text, run=run.name)
    still = [run for run in runs if _is_still(run, _driven(run))]
    for run in still:
        severity: Severity = "error" if len(still) == len(runs) else "warning"
        moving = [c for c in MOTION if c in run.table and not _is_still(run, c)]
        if moving:
            text = f"{run.name}, {_driven(run)}: does not move while {moving[0]} does; check its cable and its scale"
            yield Finding("error", "still", text, _driven(run), run.name)
        else:
            yield Finding(severity, "still", f"{run.name}: nothing moves; remove the run", run=run.name)


def _driven(run: Run) -> str:
    return "floor_acceleration" if "floor_acceleration" in run.table else "displacement"


def _is_still(run: Run, channel: str) -> bool:
    return float(np.std(run.table[channel])) <= 3.0 * run.noise(channel)


def _repeats(run: Run, other: Run) -> bool:
    """Say whether two runs have one excitation, up to a shift of a second."""
    first, second = (_band(r, r.table[_driven(r)]) for r in (run, other))
    rows = min(len(first), len(second))
    return _late(first[:rows], second[:rows], round(run.rate))[1] > 0.8


def _levels(run: Run) -> Iterator[Finding]:
    """Look at constant channels, currents and temperatures."""
    for channel, values in run.table.items():
        place, noise = f"{run.name}, {channel}", run.noise(channel)
        watched = channel in MOTION or noise > 0.0
        if watched and np.ptp(values) == 0.0:
            severity: Severity = "warning" if channel == "damper_temperature" else "error"
            text = f"{place}: is {values[0]:g} throughout; the sensor is dead: repair it or remove the channel"
            yield Finding(severity, "constant", text, channel, run.name)
        elif channel in MOTION and _is_still(run, channel) and channel != _driven(run):
            text = f"{place}: shows hardly more than its noise of {noise:g}; it cannot be judged"
            yield Finding("warning", "silent", text, channel, run.name)
    for channel in ("current_command", "coil_current"):
        if channel in run.table:
            yield from _current(run, channel)
    if "damper_temperature" in run.table:
        yield from _temperature(run)


def _current(run: Run, channel: str) -> Iterator[Finding]:
    values, most = run.table[channel], run.nominal.coil.max_current
    low, high = float(np.min(values)), float(np.max(values))
    place = f"{run.name}, {channel}: ranges from {low:.3g} to {high:.3g} A"
    if max(-low, high) > 30.0 * most:
        yield Finding("error", "unit", f"{place} where max_current is {most:g} A; is it in mA? convert it to A",
                      channel, run.name)  # fmt: skip
    elif -low > max(0.25 * most, 2.0 * high):
        yield Finding("error", "sign", f"{place}; its sign is swapped: turn it", channel, run.name)
    elif -low > 0.25 * most or high > 1.3 * most:
        yield Finding("warning", "range", f"{place}, outside 0 to {most:g} A; check its zero and its scale",
                      channel, run.name)  # fmt: skip


def _temperature(run: Run) -> Iterator[Finding]:
    channel, values = "damper_temperature", run.table["damper_temperature"]
    low, high = float(np.min(values)), float(np.max(values))
    place = f"{run.name}, {channel}: ranges from {low:.4g} to {high:.4g} degC"
    if low < -40.0 or high > 200.0:
        guess = "is it in kelvin? " if low > 230.0 and high < 480.0 else ""
        yield Finding("error", "unit", f"{place}, outside -40 to 200 degC; {guess}convert it to degC", channel,
                      run.name)  # fmt: skip


def _fahrenheit(runs: list[Run]) -> Iterator[Finding]:
    """Say where the lowest temperature, taken as degF, is the one that the nominal scenario states."""
    channel, nominal = "damper_temperature", runs[0].nominal.temperature
    stated = nominal.start if isinstance(nominal, Thermal) else nominal
    low = min((float(np.min(run.table[channel])) for run in runs if channel in run.table), default=stated)
    if abs(low - stated) > 20.0 and abs((low - 32.0) / 1.8 - stated) < 2.5:
        text = f"all runs, {channel}: is never below {low:.3g} degC where the nominal scenario states {stated:g} degC"
        yield Finding("warning", "unit", f"{text}; if it is in degF, convert it", channel)


def _shape(run: Run) -> Iterator[Finding]:
    """Look for flat tops, held values and stretches without change."""
    for channel, values in run.table.items():
        noise, place = run.noise(channel), f"{run.name}, {channel}"
        if channel in ("current_command", "command_voltage", "damper_temperature") or np.ptp(values) == 0.0:
            continue
        for extreme, rows in _flat_tops(values):
            is_sure = noise > _quantum(values) and rows > CLIPPED * len(values)
            text = f"{place}: {rows} rows stand at its extreme {extreme:.4g}; it is clipped: widen its range"
            yield Finding("error" if is_sure else "warning", "clipped", text, channel, run.name)
        if noise > _quantum(values):
            yield from _held(run, channel)


def _held(run: Run, channel: str) -> Iterator[Finding]:
    lengths, starts = _plateaus(run.table[channel])
    longest = int(np.argmax(lengths))
    place = f"{run.name}, {channel}"
    if lengths[longest] > max(STUCK * run.rate, 20):
        begin, end = starts[longest] / run.rate, (starts[longest] + lengths[longest]) / run.rate
        text = f"{place}: is stuck from {begin:.3g} to {end:.3g} s; cut the run there or repair the sensor"
        yield Finding("error", "stuck", text, channel, run.name)
    elif np.median(lengths) >= 2:
        text = f"{place}: holds each value for {int(np.median(lengths))} rows; its own rate is lower: interpolate it"
        yield Finding("warning", "held", text, channel, run.name)


def _plateaus(values: Array) -> tuple[NDArray[np.int_], NDArray[np.int_]]:
    """Return length and first row of each stretch of equal values."""
    starts = np.concatenate([[0], np.flatnonzero(np.diff(values)) + 1])
    return np.diff(np.append(starts, len(values))), starts


def _flat_tops(values: Array) -> Iterator[tuple[float, int]]:
    """Yield each extreme other than zero at which more rows stand than in the 2 % of the range beside it."""
    band = 0.02 * float(np.ptp(values))
    lengths, starts = _plateaus(values)
    usual = float(np.median(lengths))
    for extreme in (float(np.max(values)), float(np.min(values))):
        at = values == extreme
        beside = int(np.sum(np.abs(values - extreme) <= band)) - int(np.sum(at))
        if extreme != 0.0 and np.sum(at) >= max(5 * usual, beside) and np.max(lengths[at[starts]]) >= 3 * usual:
            yield extreme, int(np.sum(at))


def _quantum(values: Array) -> float:
    """Return the smallest step between two values."""
    return float(np.min(np.diff(np.unique(values)), initial=np.inf))


def _noise(runs: list[Run]) -> Iterator[Finding]:
    """Compare the stated noise with the least white noise seen in any run."""
    for channel, entry in runs[0].recording.channels.items():
        stated = entry.noise_rms
        seen = min((_white(run.table[channel], run.rate) for run in runs), key=lambda pair: pair[1])
        if channel == "current_command" or stated == 0.0 or not 0.0 < seen[1] < np.inf:
            continue
        if seen[1] < stated / NOISE_OFF or (seen[0] > NOISE_OFF * stated and seen[1] > 0.9 * seen[0]):
            text = f"all runs, {channel}: noise_rms is stated as {stated:g}, but about {seen[1]:.2g} is seen"
            yield Finding("warning", "noise", f"{text}; correct it, all thresholds hang on it", channel)


def _white(values: Array, rate: float) -> tuple[float, float]:
    """Return the noise in third and in fourth differences of the quietest fifth of the half seconds; white: alike."""
    rows = max(round(0.5 * rate), 50)
    windows = len(values) // rows
    if windows < 4:
        return np.inf, np.inf
    pieces = values[: windows * rows].reshape(windows, rows)
    third, fourth = (
        np.median(np.abs(np.diff(pieces, n, axis=1)), axis=1) / (0.6745 * norm)
        for n, norm in ((3, 20**0.5), (4, 70**0.5))
    )
    quiet = fourth <= np.quantile(fourth, 0.2)
    return float(np.mean(third[quiet])), float(np.mean(fourth[quiet]))


class Damage(NamedTuple):
    """A damage that may have been done to channels: `undo` takes the table of a run and returns it as it was."""

    kind: str
    channels: tuple[str, ...]
    says: str
    undo: Callable[[Table], Table]


class Restored(NamedTuple):
    """An effect that replaces recorded inputs by others, shape (rows,) each."""

    channels: Table

    def truth(self, channel: str, step: float, values: Array) -> Array:
        """Return what drives the simulation, shape (N,): linear between the rows."""
        rows = self.channels.get(channel)
        return values if rows is None else np.interp(np.linspace(0, len(rows) - 1, len(values)), range(len(rows)), rows)


def _exchanged_currents(run: Run) -> Iterator[Finding]:
    """Say where the coil follows from the command much better once the two are exchanged."""
    damage = _exchange("current_command", "coil_current")
    if not set(damage.channels) <= set(run.table):
        return
    before, after = (_misfit_of_coil(run, table) for table in (run.table, damage.undo(run.table)))
    if before > EXCHANGED and after < 0.3 * before:
        yield _named(run, [damage])


def _misfit_of_coil(run: Run, table: Table) -> float:
    simulated = _simulated(run, {"current_command": table["current_command"]})
    return _misfits(run, table, simulated)["coil_current"]


def _fit(run: Run) -> Iterator[Finding]:
    """Name the damage whose undoing lowers the misfit of a run most, and those that do it as well."""
    simulated = _simulated(run, {})
    before = _misfits(run, run.table, simulated)
    fall = {}
    for damage in _possible(run, before, simulated):
        table = damage.undo(run.table)
        inputs = {c: table[c] for c in DRIVERS if c in table and table[c] is not run.table[c]}
        after = _misfits(run, table, _simulated(run, inputs) if inputs else simulated)
        if _explains(damage, before, after):
            fall[damage] = sum(before.values()) - sum(after.values())
    named = sorted((d for d in fall if fall[d] > max(fall.values()) - 0.1), key=lambda damage: -fall[damage])
    if named:
        yield _named(run, named)


def _named(run: Run, damages: list[Damage]) -> Finding:
    """Return the finding for damages that explain a run equally well, the best first."""
    first, *others = damages
    said = [f"{' and '.join(first.channels)}: {first.says}"]
    said += [f"{' and '.join(d.channels)} {d.says}" for d in others if d.channels != first.channels]
    text = f"{run.name}, {', or '.join(said)}; correct it and diagnose again"
    severity: Severity = "warning" if first.kind == "late" and first.channels == ("coil_current",) else "error"
    return Finding(severity, first.kind, text, first.channels[0], run.name)


def _explains(damage: Damage, before: Mapping[str, float], after: Mapping[str, float]) -> bool:
    """Say whether undoing a damage lowers the misfit grossly, and what it changed then fits."""
    changed = [name for name in before if abs(before[name] - after[name]) > 0.05]
    limit, left = (DELAYED, 0.1) if damage.kind == "late" else (GROSS, 0.5)
    fall = sum(before.values()) - sum(after.values())
    return fall >= limit and float(np.mean([after[name] for name in changed])) <= left


def _possible(run: Run, before: Mapping[str, float], simulated: Table | None) -> Iterator[Damage]:
    """Yield each damage that could explain such a misfit; one on what drives the rig leaves few outputs alone."""
    if sum(before.values()) < DELAYED:
        return
    driven_wrong = float(np.median([size for name, size in before.items() if name in MOTION])) > 0.5 * DELAYED
    damages = [damage for channel in run.table for damage in _scales(channel)]
    damages += [_exchange(a, b) for a, b in itertools.combinations(MOTION[:3], 2) if a in run.table and b in run.table]
    damages += list(_delays(run, simulated)) if simulated else []
    for damage in damages:
        if driven_wrong or not set(DRIVERS) & set(damage.channels):
            yield damage


def _scales(channel: str) -> Iterator[Damage]:
    quantity = channel.rpartition("_")[2]
    if channel in MOTION or channel == "coil_current":
        yield Damage("sign", (channel,), "its sign is swapped", _scaled(channel, -1.0))
    for unit, factor in UNITS.get(quantity, {}).items():
        yield Damage("unit", (channel,), f"reads as if in {unit}", _scaled(channel, 1.0 / factor))


def _scaled(channel: str, factor: float) -> Callable[[Table], Table]:
    return lambda table: {**table, channel: factor * table[channel]}


def _exchange(first: str, second: str) -> Damage:
    says = "are exchanged for each other"
    return Damage("exchange", (first, second), says, lambda t: {**t, first: t[second], second: t[first]})


def _delays(run: Run, simulated: Table) -> Iterator[Damage]:
    """Yield the delay of each output against the simulation, and that of the floor that would explain the most."""
    skip = round(LEFT_OUT * run.rate)
    found = []
    for channel, values in simulated.items():
        late, alike = _late(_band(run, run.table[channel][skip:]), _band(run, values), round(0.5 * run.rate))
        if alike > 0.8 and abs(late) > (LATE if channel in MOTION else 2.0 * LATE) * run.rate:
            found += [late] if channel in MOTION else []
            yield _delay(channel, late, run.rate)
    if found:
        yield _delay(_driven(run), -int(np.median(found)), run.rate)


def _delay(channel: str, rows: int, rate: float) -> Damage:
    says = f"is {abs(rows) / rate:.3g} s {'late' if rows > 0 else 'early'}"
    return Damage("late", (channel,), says, lambda table: {**table, channel: _moved(table[channel], rows)})


def _moved(values: Array, rows: int) -> Array:
    """Return values taken `rows` earlier, held at the end that runs out."""
    return values[np.clip(np.arange(len(values)) + rows, 0, len(values) - 1)]


def _late(first: Array, second: Array, most: int) -> tuple[int, float]:
    """Return by how many rows the first is late against the second, and their correlation then."""
    from scipy.signal import correlate

    product = correlate(first, second, mode="full", method="fft")[len(second) - 1 - most : len(second) + most]
    size = float(np.linalg.norm(first) * np.linalg.norm(second))
    peak = int(np.argmax(product))
    return peak - most, float(product[peak]) / size if size > 0.0 else 0.0


def _simulated(run: Run, inputs: Table) -> Table | None:
    """Return the nominal outputs without the first second, driven by these inputs; None where there is no solution."""
    effects: tuple[Any, ...] = (*run.nominal.effects, Restored(inputs))
    try:
        return replay(dataclasses.replace(run.nominal, effects=effects), run.recording, run.name)[1]
    except RunError:
        return None


def _misfits(run: Run, table: Table, simulated: Table | None) -> dict[str, float]:
    """Return e^2 of each compared channel and of each balance between channels."""
    skip = round(LEFT_OUT * run.rate)
    used = {name: values[skip:] for name, values in table.items()}
    misfits = {}
    for c in (name for name in COMPARED[run.recording.header.rig] if name in used):
        pair = (used[c], simulated[c]) if simulated else (used[c], np.zeros(1))
        misfits[c] = _unlike(*(pair if c == "coil_current" or not simulated else (_band(run, p) for p in pair)))
    return misfits | {name: _unlike(_band(run, a), _band(run, b)) for name, a, b in _balances(run, used)}


def _balances(run: Run, used: Table) -> Iterator[tuple[str, Array, Array]]:
    """Yield name and both sides of each equation between recorded channels alone."""
    plant = run.nominal.plant
    travel = used.get("suspension_displacement")
    if {"displacement", "velocity"} <= set(used):
        yield "velocity balance", _slope(run, used["displacement"]), used["velocity"]
    if plant is None or travel is None or "frame_acceleration" not in used:
        return
    frame, speed = used["frame_acceleration"], _slope(run, travel)
    yield "motion balance", _slope(run, speed), frame - used["floor_acceleration"]
    if {"damper_force", "driver_acceleration"} <= set(used):
        inertia = plant.frame_mass * frame + plant.driver_mass * used["driver_acceleration"]
        spring = plant.suspension_stiffness * travel + plant.suspension_damping * speed
        yield "force balance", used["damper_force"], -inertia - spring


def _slope(run: Run, values: Array) -> Array:
    return np.asarray(np.gradient(_band(run, values), 1.0 / run.rate))


def _band(run: Run, values: Array) -> Array:
    """Return values between 0.5 and 8 Hz (a bench: below 8 Hz, without their mean)."""
    from scipy.signal import sosfiltfilt

    sections = _filter(run.rate, run.recording.header.rig == "seat")
    return np.asarray(sosfiltfilt(sections, values - np.mean(values), padlen=min(3 * len(values) // 4, 100)))


@functools.cache
def _filter(rate: float, on_seat: bool) -> Array:
    from scipy.signal import butter

    high = min(8.0, 0.4 * rate)
    edges = (min(0.5, 0.5 * high), high) if on_seat else high
    return np.asarray(butter(2, edges, "bandpass" if on_seat else "lowpass", fs=rate, output="sos"))


def _unlike(first: Array, second: Array) -> float:
    """Return e^2, between 0 (alike) and 2 (opposite)."""
    size = float(np.mean(first**2) + np.mean(second**2))
    return float(np.mean((first - second) ** 2)) / size if size > 0.0 else 0.0
