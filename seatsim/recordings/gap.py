"""The gap between a simulation and a recording, and the one to be expected there, where a diagnosis is given."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from seatsim.metrics.motion import rms
from seatsim.metrics.objective_rating import ObjectiveRating, rate_agreement
from seatsim.recordings.prediction import Prediction, predict_gap
from seatsim.recordings.quality.examination import examine, refuse
from seatsim.recordings.quality.sensors import without_gravity
from seatsim.recordings.recording import Recording, load_recording
from seatsim.recordings.replay import COMPARED, LEFT_OUT, note_unused_log, replay, stands_out
from seatsim.recordings.validation import Validation, validate
from seatsim.scenario.loading import single
from seatsim.scenario.numbers import list_doubts
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.content import IfAny, Unwritten, show_record, to_content
from seatsim.schema.errors import InputError

Signals = Mapping[str, Array]


class GapFigures(NamedTuple):
    """A gap in standard deviations of the measured signals, overall and by channel."""

    overall: float
    channels: dict[str, float]


@dataclass(frozen=True)
class Gap:
    """The gap of a simulation, in standard deviations of the measured signals: the content of `gap.json`."""

    overall: float
    """`sqrt(mean of the squares of the channels)`."""
    channels: dict[str, float]
    """`rms(measured - simulated) / std(measured)` by channel."""
    floor: GapFigures
    """The same two for the stated noise alone."""
    notes: tuple[str, ...] = ()
    """A sentence for each warning about the recording."""
    iso18571: dict[str, ObjectiveRating] = field(default_factory=dict, kw_only=True)
    """Ratings of each channel against the measured one, means over the runs."""
    v_and_v: dict[str, Validation] = field(default_factory=dict, kw_only=True)
    """Comparison error of each channel and its validation uncertainty."""

    def _repr_html_(self) -> str:
        floor = {name: value or "not stated" for name, value in self.floor.channels.items()}
        stated = {"overall": self.floor.overall or "not stated", "channels": floor}
        return show_record(to_content(self) | {"floor": stated})


class ReplayedPair(NamedTuple):
    """A run, measured and replayed: time in s, channels in SI units, shape (N,) each, and the channels' units."""

    time: Array
    measured: dict[str, Array]
    simulated: dict[str, Array]
    units: dict[str, str]


def replay_every_run(scenario: str | Path | Scenario, recording: str | Path | Recording) -> dict[str, ReplayedPair]:
    """Return every run of a recording, measured and replayed, as `gap` compares them.

    Raises:
        InputError: the scenario does not fit the rig.
        RunError: a replay could not be carried to its end.
    """
    scenario, recording = _load(scenario, recording)
    recording = without_gravity(recording)
    units = {name: channel.unit for name, channel in recording.channels.items()}
    found = {}
    for run in recording.runs:
        measured, simulated = replay(scenario, recording, run)
        rows = len(next(iter(simulated.values())))
        time = LEFT_OUT + np.arange(rows) / recording.header.sample_rate
        found[run] = ReplayedPair(time, measured, simulated, units)
    return found


def gap(scenario: str | Path | Scenario, recording: str | Path | Recording, runs: Sequence[str] = ()) -> Gap:
    """Replay a scenario against the runs of a recording (all of them where none are named) and return their gap.

    The recording is examined first, as for a diagnosis: a gap to faulty data says nothing about the scenario. Gravity
    that an accelerometer reads is taken out, which a note says.

    Raises:
        InputError: the scenario holds several runs, does not fit the rig, or the recording has a fault or nothing to
            compare.
        RunError: a replay could not be carried to its end.
    """
    scenario, recording = _load(scenario, recording)
    examination = examine(recording)
    refuse(examination)
    notes = dict.fromkeys([*list_doubts(scenario), *note_unused_log(scenario, recording), *examination.sentences])
    return _assess(scenario, without_gravity(recording), list(runs) or list(recording.runs), tuple(notes))


def measure_gap(scenario: str | Path | Scenario, recording: str | Path | Recording, runs: Sequence[str] = ()) -> Gap:
    """Return the gap as `gap` does, without examining the recording, which is known to be sound.

    Raises:
        InputError: the scenario does not fit the rig, or the recording has nothing to compare.
        RunError: a replay could not be carried to its end.
    """
    scenario, recording = _load(scenario, recording)
    return compare_signals(recording, *pool_runs(scenario, recording, list(runs) or list(recording.runs)))


def _assess(scenario: Scenario, recording: Recording, runs: Sequence[str], notes: tuple[str, ...]) -> Gap:
    """Return the gap with the ratings and the uncertainty of every channel."""
    found = measure_gap(scenario, recording, runs)
    names = list(found.channels)
    ratings, uncertainties = _rate(scenario, recording, runs, names), validate(scenario, recording, runs, names)
    return replace(found, notes=notes, iso18571=ratings, v_and_v=uncertainties)


def _rate(
    scenario: Scenario, recording: Recording, runs: Sequence[str], channels: Sequence[str]
) -> dict[str, ObjectiveRating]:
    """Return the mean ratings of channels over the runs in which they are not zero throughout."""
    ratings: dict[str, list[ObjectiveRating]] = {name: [] for name in channels}
    for run in runs:
        measured, simulated = replay(scenario, recording, run)
        for name in channels:
            if np.any(measured[name]):
                ratings[name].append(rate_agreement(measured[name], simulated[name], recording.header.sample_rate))
    return {name: ObjectiveRating(*np.mean(rows, axis=0).tolist()) for name, rows in ratings.items()}


def compare_signals(recording: Recording, measured: Signals, simulated: Signals) -> Gap:
    """Return the gap of simulated to measured channels, shape (N,) each, all of which are compared."""
    spreads = {name: float(np.std(values)) for name, values in measured.items()}
    channels = {name: rms(measured[name] - simulated[name]) / spread for name, spread in spreads.items()}
    floors = {name: recording.channels[name].noise_rms / spread for name, spread in spreads.items()}
    return Gap(_overall(channels), channels, GapFigures(_overall(floors), floors))


def _load(scenario: str | Path | Scenario, recording: str | Path | Recording) -> tuple[Scenario, Recording]:
    """Return the object that a path names, read from its file."""
    read = recording if isinstance(recording, Recording) else load_recording(recording)
    return scenario if isinstance(scenario, Scenario) else single(scenario), read


def pool_runs(
    scenario: Scenario, recording: Recording, runs: Sequence[str]
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return measured and simulated channels that are compared, over all samples of the runs, shape (N,) each."""
    pairs = [replay(scenario, recording, run) for run in runs]
    names = [name for name in COMPARED[recording.header.rig] if name in recording.channels]
    measured = {name: np.concatenate([m[name] for m, _ in pairs]) for name in names}
    simulated = {name: np.concatenate([s[name] for _, s in pairs]) for name in names}
    loud = loud_channels(recording, measured)
    if not loud:
        raise InputError(f"{recording.folder}: no recorded output stands above its noise; there is nothing to compare")
    return {n: measured[n] for n in loud}, {n: simulated[n] for n in loud}


def loud_channels(recording: Recording, measured: Signals) -> list[str]:
    """Return the names of the channels that are compared, since they stand above their noise."""
    return [name for name, values in measured.items() if stands_out(values, recording.channels[name].noise_rms)]


def _overall(values: dict[str, float]) -> float:
    return float(np.sqrt(np.mean([value**2 for value in values.values()])))


class MeasuredShrink(NamedTuple):
    """The gaps that were measured with the nominal and with the augmented scenario, and by how much the gap shrinks."""

    before: float
    after: float
    shrink: float
    channels: Unwritten[dict[str, float]]
    """Gaps of the channels with the nominal scenario."""


@dataclass(frozen=True)
class Forecast(Gap):
    """The gap with the augmented scenario, without figures where no outputs are recorded, and what was to be expected.

    It is the content of `gap.json` where a diagnosis is given.
    """

    predicted: Prediction = field(kw_only=True)
    measured: IfAny[MeasuredShrink | None] = None


def forecast_gap(scenario: str | Path | Scenario, recording: str | Path | Recording, diagnosis: str | Path) -> Forecast:
    """Return what is to be expected on a recording (`predict_gap`) beside what was measured there, where it was.

    Raises:
        InputError: as `predict_gap`, or the recording has a fault.
        RunError: a simulation could not be carried to its end.
    """
    scenario, recording = _load(scenario, recording)
    examination = examine(recording)
    refuse(examination)
    predicted = predict_gap(scenario, recording, diagnosis)
    notes = tuple(dict.fromkeys([*note_unused_log(scenario, recording), *examination.sentences]))
    if not has_outputs(recording):
        return Forecast(math.nan, {}, GapFigures(math.nan, {}), notes, predicted=predicted)
    before, after = measure_gap(recording.nominal, recording), _assess(scenario, recording, list(recording.runs), notes)
    measured = MeasuredShrink(before.overall, after.overall, 1.0 - after.overall / before.overall, before.channels)
    return Forecast(**vars(after), measured=measured, predicted=predicted)


def has_outputs(recording: Recording) -> bool:
    """Whether an output is recorded; a coil current is an input where it drives the damper in place of a command."""
    recorded, commands = set(recording.channels), {"current_command", "command_voltage"}
    outputs = recorded.intersection(COMPARED[recording.header.rig])
    return bool(outputs if commands & recorded else outputs - {"coil_current"})
