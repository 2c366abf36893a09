"""The gap to be expected of a diagnosis on other inputs: what its effects change there, and what stays unexplained.

Only the inputs of a recording are used. With the change d between the augmented and the nominal simulation of a
channel, the mean square m that the augmented one is expected to miss (`ModelError.predict_remainder`), the noise n and
the standard deviation s to be expected of the measured channel,

    after^2 = mean((m + n^2) / s^2),    before^2 = mean((d^2 + m + n^2) / s^2),    shrink = 1 - after / before.

What is missed is taken for uncorrelated with what the effects change, as the residual of a fit is.
"""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.effects.base import EFFECTS
from seatsim.recordings.compared import COMPARED, NOISE_FACTOR
from seatsim.recordings.gap import Gap, measure_gap
from seatsim.recordings.model_error import ModelError, read_model_error
from seatsim.recordings.quality.examination import examine, refuse
from seatsim.recordings.recording import Recording, load_recording
from seatsim.recordings.replay import simulate_table
from seatsim.scenario.loading import single
from seatsim.scenario.scenario import Scenario
from seatsim.schema.errors import InputError
from seatsim.schema.fields import bounds, replace_fields
from seatsim.schema.registry import Record

Array = NDArray[np.float64]

EXCITATION_STD = 0.1
"""Standard deviation of the logarithm of what is missed, between excitations of one kind; on sealed rigs."""
RATIO_STD = 0.03
"""Standard deviation of the logarithm of the share of the gap that is left, whatever is missed; on sealed rigs."""
ONE_RUN_STD = 0.3
"""The same where a single run was diagnosed, so that its spread from run to run is not known."""
QUANTILE = 1.645
"""Of the normal distribution, at the ends of a 90 % interval."""


class StatedCause(NamedTuple):
    """An effect of a `diagnosis.json`: its channel, if it acts on one, and its parameters' standard deviations."""

    effect: str
    channel: str | None
    stds: dict[str, float]


@dataclass(frozen=True)
class Prediction:
    """The gap to be expected before and after, overall and by channel, and the shrink with its 90 % interval."""

    before: float
    after: float
    shrink: float
    shrink_interval: tuple[float, float]
    channels: dict[str, tuple[float, float]]

    def as_dict(self) -> dict[str, object]:
        """Return the prediction as it stands under `predicted` in `gap.json`."""
        channels = {name: {"before": before, "after": after} for name, (before, after) in self.channels.items()}
        return {
            "before": self.before, "after": self.after, "shrink": self.shrink,
            "shrink_interval": list(self.shrink_interval), "channels": channels,
        }  # fmt: skip


class MeasuredGaps(NamedTuple):
    """The gaps that were measured with the nominal and with the augmented scenario."""

    before: Gap
    after: Gap

    @property
    def shrink(self) -> float:
        """By how much the gap shrinks."""
        return 1.0 - _left((self.before.overall, self.after.overall))

    def channel(self, name: str) -> tuple[float, float]:
        """Return the gaps of a channel before and after, NaN where it is not compared."""
        return self.before.channels.get(name, math.nan), self.after.channels.get(name, math.nan)


class Forecast(NamedTuple):
    """What is to be expected on a recording, what was measured if outputs are recorded, and notes on its data."""

    predicted: Prediction
    measured: MeasuredGaps | None
    notes: tuple[str, ...]

    def as_dict(self) -> dict[str, object]:
        """Return the forecast as it stands in `gap.json`, whose measured figures are null where there is none."""
        none: dict[str, object] = {"overall": None, "channels": {}}
        content: dict[str, object] = {"predicted": self.predicted.as_dict()}
        if self.measured is None:
            return none | {"floor": none, "notes": list(self.notes)} | content
        before, after = self.measured.before.overall, self.measured.after.overall
        measured = {"before": before, "after": after, "shrink": self.measured.shrink}
        return self.measured.after.as_dict() | content | {"measured": measured, "notes": list(self.notes)}


def forecast_gap(scenario: str | Path | Scenario, recording: str | Path | Recording, diagnosis: str | Path) -> Forecast:
    """Return what is to be expected on a recording (`predict_gap`) beside what was measured there, where it was.

    Raises:
        InputError: as `predict_gap`, or the recording has a fault.
        RunError: a simulation could not be carried to its end.
    """
    recording = recording if isinstance(recording, Recording) else load_recording(recording)
    examination = examine(recording)
    refuse(examination)
    predicted = predict_gap(scenario, recording, diagnosis)
    measured = None
    if has_outputs(recording):
        measured = MeasuredGaps(measure_gap(recording.nominal, recording), measure_gap(scenario, recording))
    return Forecast(predicted, measured, tuple(examination.sentences))


def has_outputs(recording: Recording) -> bool:
    """Whether an output is recorded; a coil current is an input where it drives the damper in place of a command."""
    recorded, commands = set(recording.channels), {"current_command", "command_voltage"}
    outputs = recorded.intersection(COMPARED[recording.header.rig])
    return bool(outputs if commands & recorded else outputs - {"coil_current"})


def predict_gap(
    scenario: str | Path | Scenario, recording: str | Path | Recording, diagnosis: str | Path, runs: Sequence[str] = ()
) -> Prediction:
    """Return the gap to be expected on the inputs of a recording, of its nominal and of the augmented scenario.

    Args:
        scenario: the augmented scenario that the diagnosis wrote.
        recording: its inputs are used, and its nominal scenario; outputs need not be recorded.
        diagnosis: `diagnosis.json`.
        runs: all of the recording's where none are named.

    Raises:
        InputError: the diagnosis is none or states no model error, or no channel of it stands above its noise here.
        RunError: a simulation could not be carried to its end.
    """
    recording = recording if isinstance(recording, Recording) else load_recording(recording)
    augmented = scenario if isinstance(scenario, Scenario) else single(scenario)
    stated, names = _read_diagnosis(Path(diagnosis)), list(runs) or list(recording.runs)
    error = read_model_error(stated, str(diagnosis))
    after = _simulate(augmented, recording, names)
    before = _simulate(single(recording.nominal), recording, names)
    shifted = [_simulate(other, recording, names) for other in _move_parameters(augmented, _read_causes(stated))]
    return _combine(error, recording.header.sample_rate, before, after, shifted, str(recording.folder))


def _combine(
    error: ModelError, rate: float, before: Mapping[str, Array], after: Mapping[str, Array],
    shifted: Sequence[Mapping[str, Array]], place: str,
) -> Prediction:  # fmt: skip
    """Return the prediction from simulated channels: nominal, augmented, and with each parameter moved by its error."""
    channels, parts = {}, []
    for name, noise in error.noise.items():
        variance = float(np.sum(error.predict_amplitude(name, after[name], rate)))
        if variance < max((NOISE_FACTOR * noise) ** 2, 1e-300):
            continue
        missed = error.predict_remainder(name, after[name], rate)
        changed = float(np.mean((after[name] - before[name]) ** 2))
        uncertain = sum(float(np.mean((other[name] - after[name]) ** 2)) for other in shifted)
        parts.append(np.array([changed, noise**2, uncertain, *missed]) / variance)
        channels[name] = _roots(changed / variance, noise**2 / variance, _mean_square(missed) / variance)
    if not parts:
        raise InputError(f"{place}: no channel of the diagnosis is to stand above its noise with these inputs")
    means = np.mean(parts, axis=0)
    changes, floor, doubt = (float(value) for value in means[:3])
    rest, width = _mean_square(means[3:]), QUANTILE * _spread(means[3:])
    gaps, share = _roots(changes, floor, rest), np.exp(QUANTILE * RATIO_STD * (changes > 0.0))
    least = share * _left(_roots(changes, floor, rest * np.exp(2.0 * width) + QUANTILE**2 * doubt))
    most = _left(_roots(changes, floor, rest * np.exp(-2.0 * width))) / share
    return Prediction(*gaps, 1.0 - _left(gaps), (1.0 - least, 1.0 - most), channels)


def _roots(changed: float, floor: float, missed: float) -> tuple[float, float]:
    """Return the gap before and after, from mean squares in variances of the channels."""
    return float(np.sqrt(changed + floor + missed)), float(np.sqrt(floor + missed))


def _left(gaps: tuple[float, float]) -> float:
    """Return the share of a gap that is left."""
    return gaps[1] / gaps[0] if gaps[0] > 0.0 else 1.0


def _mean_square(by_run: Array) -> float:
    """Return the mean square that runs let expect: of their root mean squares, so that no single run rules."""
    return float(np.mean(np.sqrt(by_run))) ** 2


def _spread(by_run: Array) -> float:
    """Return the standard deviation of the logarithm of what is missed, from run to run and between excitations."""
    between = float(np.std(0.5 * np.log(np.maximum(by_run, 1e-300)), ddof=1)) if len(by_run) > 1 else ONE_RUN_STD
    return float(np.hypot(EXCITATION_STD, between))


def _simulate(scenario: Scenario, recording: Recording, runs: Sequence[str]) -> dict[str, Array]:
    """Return the simulated outputs over all samples of the runs, driven by the recorded inputs, shape (N,) each."""
    parts = [simulate_table(scenario, recording, recording.table(run)) for run in runs]
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def _move_parameters(scenario: Scenario, causes: Sequence[StatedCause]) -> Iterator[Scenario]:
    """Yield the augmented scenario with each parameter of its effects moved by its standard deviation."""
    for index, effect in enumerate(scenario.effects):
        name, channel = EFFECTS.name_of(type(effect)), effect._asdict().get("channel")
        for cause in causes:
            if cause.effect == name and cause.channel == channel:
                for parameter, std in cause.stds.items():
                    moved = _move(effect, parameter, std)
                    effects = (*scenario.effects[:index], moved, *scenario.effects[index + 1 :])
                    yield dataclasses.replace(scenario, effects=effects)


def _move(effect: Record, parameter: str, std: float) -> Record:
    """Return an effect with one parameter moved by its standard deviation, down where that would leave its range."""
    value = float(str(effect._asdict()[parameter]))
    low, high = bounds(type(effect), parameter)
    moved = value + std if value + std <= high else max(value - std, low)
    return replace_fields(effect, {parameter: moved})


def _read_causes(content: Mapping[str, object]) -> list[StatedCause]:
    """Return the standard deviations of the parameters of every cause that states some."""
    found, causes = [], content.get("causes")
    for cause in causes if isinstance(causes, list) else []:
        stated = cause["parameters"]
        stds = {name: float(value["std"]) for name, value in stated.items() if isinstance(value, dict) and value["std"]}
        found.append(StatedCause(cause["effect"], stated.get("channel"), stds))
    return found


def _read_diagnosis(path: Path) -> Mapping[str, object]:
    """Return the content of a `diagnosis.json`."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be read as a diagnosis: {error}; name the diagnosis.json") from error
    if not isinstance(content, dict):
        raise InputError(f"{path}: is no diagnosis; name the diagnosis.json that 'seatsim diagnose' wrote")
    return content
