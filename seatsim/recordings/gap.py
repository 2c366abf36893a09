"""The gap between a simulation and a recording, and the one to be expected there, where a diagnosis is given."""

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
from seatsim.recordings.recording import COMMANDS, Recording, load_recording
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


class ReplayedPair(NamedTuple):
    """A run, measured and replayed: time in s, channels in SI units, shape (N,) each, and the channels' units."""

    time: Array
    measured: dict[str, Array]
    simulated: dict[str, Array]
    units: dict[str, str]


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
    replayed: Unwritten[Mapping[str, ReplayedPair]] = field(
        default_factory=dict, repr=False, compare=False, kw_only=True
    )
    """The runs that were compared."""
    iso18571: dict[str, ObjectiveRating] = field(default_factory=dict, kw_only=True)
    """Ratings of each channel against the measured one, means over the runs."""
    v_and_v: dict[str, Validation] = field(default_factory=dict, kw_only=True)
    """Comparison error of each channel and its validation uncertainty."""

    def _repr_html_(self) -> str:
        floor = {name: value or "not stated" for name, value in self.floor.channels.items()}
        stated = {"overall": self.floor.overall or "not stated", "channels": floor}
        return show_record(to_content(self) | {"floor": stated})


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
    replayed = {run: _replay(scenario, recording, run) for run in runs or recording.runs}
    return replace(compare_signals(recording, *_pool(recording, replayed)), replayed=replayed)


def _assess(scenario: Scenario, recording: Recording, runs: Sequence[str], notes: tuple[str, ...]) -> Gap:
    """Return the gap with the ratings and the uncertainty of every channel."""
    found = measure_gap(scenario, recording, runs)
    ratings = _rate(found, recording.header.sample_rate)
    uncertainties = validate(scenario, recording, runs, list(found.channels))
    return replace(found, notes=notes, iso18571=ratings, v_and_v=uncertainties)


def _rate(found: Gap, sample_rate: float) -> dict[str, ObjectiveRating]:
    """Return the mean ratings of the channels of a gap over the runs in which they are not zero throughout."""
    ratings: dict[str, ObjectiveRating] = {}
    for name in found.channels:
        pairs = [(run.measured[name], run.simulated[name]) for run in found.replayed.values()]
        rows = [rate_agreement(*pair, sample_rate) for pair in pairs if np.any(pair[0])]
        ratings[name] = ObjectiveRating(*np.mean(rows, axis=0).tolist())
    return ratings


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
    return _pool(recording, {run: _replay(scenario, recording, run) for run in runs})


def _replay(scenario: Scenario, recording: Recording, run: str) -> ReplayedPair:
    measured, simulated = replay(scenario, recording, run)
    time = LEFT_OUT + np.arange(len(next(iter(simulated.values())))) / recording.header.sample_rate
    return ReplayedPair(time, measured, simulated, {name: each.unit for name, each in recording.channels.items()})


def _pool(recording: Recording, replayed: Mapping[str, ReplayedPair]) -> tuple[dict[str, Array], dict[str, Array]]:
    names = [name for name in COMPARED[recording.header.rig] if name in recording.channels]
    measured = {name: np.concatenate([pair.measured[name] for pair in replayed.values()]) for name in names}
    simulated = {name: np.concatenate([pair.simulated[name] for pair in replayed.values()]) for name in names}
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
    if not _has_outputs(recording):
        return Forecast(math.nan, {}, GapFigures(math.nan, {}), notes, predicted=predicted)
    before, after = measure_gap(recording.nominal, recording), _assess(scenario, recording, list(recording.runs), notes)
    measured = MeasuredShrink(before.overall, after.overall, 1.0 - after.overall / before.overall, before.channels)
    return Forecast(**vars(after), measured=measured, predicted=predicted)


def _has_outputs(recording: Recording) -> bool:
    """Whether an output is recorded; a coil current is an input where it drives the damper in place of a command."""
    outputs = set(recording.channels).intersection(COMPARED[recording.header.rig])
    is_commanded = not set(COMMANDS).isdisjoint(recording.channels)
    return bool(outputs if is_commanded else outputs - {"coil_current"})
