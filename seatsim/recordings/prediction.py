"""The gap to be expected of a diagnosis on other inputs: what its effects change there, and what stays unexplained.

Only the inputs of a recording are used. With the change d between the augmented and the nominal simulation of a
channel, the mean square m that the augmented one is expected to miss (`ModelError.predict_remainder`), the noise n and
the standard deviation s to be expected of the measured channel,

    after^2 = mean((m + n^2) / s^2),    before^2 = mean((d^2 + m + n^2) / s^2),    shrink = 1 - after / before.

What is missed is taken for uncorrelated with what the effects change, as the residual of a fit is.
"""

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from seatsim.effects.base import EFFECTS
from seatsim.recordings.model_error import ModelError, read_model_error
from seatsim.recordings.recording import Recording, load_recording
from seatsim.recordings.replay import COMPARED, NOISE_FACTOR, simulate_table
from seatsim.scenario.loading import single
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.content import show_record
from seatsim.schema.errors import InputError
from seatsim.schema.fields import bounds, replace_fields
from seatsim.schema.guarded import expect, read_json
from seatsim.schema.registry import Record

_EXCITATION_STD = 0.15
"""Standard deviation of the logarithm of what is missed, between excitations of one kind; on sealed rigs."""
_RATIO_STD = 0.05
"""Standard deviation of the logarithm of the share of the gap that is left, whatever is missed; on sealed rigs."""
_ONE_RUN_STD = 0.3
"""The same where a single run was diagnosed, so that its spread from run to run is not known."""
QUANTILE = 1.645
"""Of the normal distribution, at the ends of a 90 % interval."""


class OtherRigError(InputError):
    """A diagnosis is of another kind of rig than the recording."""


class SimulatedRigs(NamedTuple):
    """Outputs of the nominal and the augmented rig, and of that with each parameter of an effect moved, shape (N,)."""

    rate: float
    before: Mapping[str, Array]
    after: Mapping[str, Array]
    shifted: Sequence[Mapping[str, Array]]


class _StatedCause(NamedTuple):
    """An effect of a `diagnosis.json`: its channel, if it acts on one, and its parameters' standard deviations."""

    effect: str
    channel: str | None
    stds: dict[str, float]


class Expected(NamedTuple):
    """The gap to be expected of a channel with the nominal and with the augmented scenario."""

    before: float
    after: float


class Prediction(NamedTuple):
    """The gap to be expected before and after, overall and by channel, and the shrink with its 90 % interval."""

    before: float
    after: float
    shrink: float
    shrink_interval: tuple[float, float]
    channels: dict[str, Expected]

    def _repr_html_(self) -> str:
        return show_record(self)


def predict_gap(
    scenario: str | Path | Scenario, recording: str | Path | Recording, diagnosis: str | Path
) -> Prediction:
    """Return the gap to be expected on the inputs of a recording, of its nominal and of the augmented scenario.

    Args:
        scenario: the augmented scenario that the diagnosis wrote.
        recording: its inputs are used, and its nominal scenario; outputs need not be recorded.
        diagnosis: `diagnosis.json`.

    Raises:
        InputError: the diagnosis is none or states no model error, it is of another rig (`OtherRigError`), the scenario
            lacks an effect that it found, or no channel of it stands above its noise here.
        RunError: a simulation could not be carried to its end.
    """
    recording = recording if isinstance(recording, Recording) else load_recording(recording)
    augmented = scenario if isinstance(scenario, Scenario) else single(scenario)
    stated = read_json(Path(diagnosis), "diagnosis")
    if not isinstance(stated, dict):
        raise InputError(f"{Path(diagnosis)}: is no diagnosis; name the diagnosis.json that 'seatsim diagnose' wrote")
    with expect(diagnosis, "diagnosis"):
        error, causes = read_model_error(stated, str(diagnosis)), _read_causes(stated)
        _check_rig(augmented, error, recording, diagnosis)
        _check_augmented(augmented, stated, causes, Path(diagnosis))
    moved = _move_parameters(augmented, causes)
    rigs = (augmented, recording.nominal, *moved)
    after, before, *shifted = (_simulate(each, recording) for each in rigs)
    simulated = SimulatedRigs(recording.header.sample_rate, before, after, shifted)
    return _combine(error, simulated, str(recording.folder))


def _check_rig(augmented: Scenario, error: ModelError, recording: Recording, diagnosis: str | Path) -> None:
    """Raise OtherRigError where a diagnosis is of a seat and the recording of a bench, or the other way round."""
    rig = recording.header.rig
    if (augmented.plant is None and rig == "seat") or not set(error.noise) <= set(COMPARED[rig]):
        problem = f"{diagnosis}: is of another kind of rig than {recording.folder}, which is of rig '{rig}'"
        raise OtherRigError(f"{problem}; give a diagnosis and its augmented scenario of a {rig}")


def _check_augmented(
    scenario: Scenario, stated: Mapping[str, object], causes: Sequence[_StatedCause], diagnosis: Path
) -> None:
    """Raise InputError where a scenario lacks an effect that the diagnosis found: it is not the augmented one."""
    present = {EFFECTS.name_of(type(effect)) for effect in scenario.effects}
    found = stated.get("selected")
    selected = found if isinstance(found, list) else []
    # The signal of a random disturbance is not simulated: such a cause has no fitted parameters.
    fitted = [cause.effect for cause in causes if cause.stds and cause.effect in selected]
    missing = [effect for effect in fitted if effect not in present]
    if missing:
        lacks = f"{scenario.name}: lacks {' and '.join(dict.fromkeys(missing))}, which {diagnosis} found"
        augmented = diagnosis.parent / str(stated.get("augmented", "augmented.yaml"))
        raise InputError(f"{lacks}; a prediction is of the augmented scenario: give {augmented}")


def _combine(error: ModelError, rigs: SimulatedRigs, place: str) -> Prediction:
    """Return the prediction from what the diagnosed runs missed and from simulations."""
    parts = {name: part for name in error.noise if (part := _measure_channel(error, name, rigs)) is not None}
    if not parts:
        raise InputError(f"{place}: no channel of the diagnosis is to stand above its noise with these inputs")
    mean = np.mean(list(parts.values()), axis=0)
    changes, floor, doubt = (float(value) for value in mean[:3])
    rest, width = _mean_square(mean[3:]), QUANTILE * _spread(mean[3:])
    gaps, share = _roots(changes, floor, rest), np.exp(QUANTILE * _RATIO_STD * (changes > 0.0))
    least = share * _left(_roots(changes, floor, rest * np.exp(2.0 * width) + QUANTILE**2 * doubt))
    most = _left(_roots(changes, floor, rest * np.exp(-2.0 * width))) / share
    channels = {name: Expected(*_roots(part[0], part[1], _mean_square(part[3:]))) for name, part in parts.items()}
    return Prediction(*gaps, 1.0 - _left(gaps), (1.0 - least, 1.0 - most), channels)


def _measure_channel(error: ModelError, name: str, rigs: SimulatedRigs) -> Array | None:
    """Return mean squares of a channel in variances; None if it is not compared.

    What effects change, noise, what doubtful parameters change, then what is missed: two figures by each diagnosed run.
    """
    after, noise = rigs.after[name], error.noise[name]
    variance = float(error.predict_amplitude(name, after, rigs.rate)[0])
    if variance < max((NOISE_FACTOR * noise) ** 2, 1e-300):
        return None
    changed = np.mean((after - rigs.before[name]) ** 2)
    doubtful = sum(float(np.mean((other[name] - after) ** 2)) for other in rigs.shifted)
    missed = error.predict_remainder(name, after, rigs.rate)
    return np.array([changed, noise**2, doubtful, *missed.ravel()]) / variance


def _roots(changed: float, floor: float, missed: float) -> tuple[float, float]:
    """Return the gap before and after, from mean squares in variances of the channels."""
    return float(np.sqrt(changed + floor + missed)), float(np.sqrt(floor + missed))


def _left(gaps: tuple[float, float]) -> float:
    """Return the share of a gap that is left."""
    return gaps[1] / gaps[0] if gaps[0] > 0.0 else 1.0


def _mean_square(missed: Array) -> float:
    """Return the mean square that runs let expect: of their root mean squares, so that no single run rules."""
    return float(np.mean(np.sqrt(missed))) ** 2


def _spread(missed: Array) -> float:
    """Return the standard deviation of the logarithm of what is missed, from two figures by run and beyond these."""
    beyond = _EXCITATION_STD if len(missed) > 2 else _ONE_RUN_STD
    return float(np.hypot(beyond, np.std(0.5 * np.log(np.maximum(missed, 1e-300)), ddof=1)))


def _simulate(scenario: Scenario, recording: Recording) -> dict[str, Array]:
    """Return the simulated outputs over all samples, driven by the recorded inputs, shape (N,) each."""
    parts = [simulate_table(scenario, recording, recording.table(run)) for run in recording.runs]
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def _move_parameters(scenario: Scenario, causes: Sequence[_StatedCause]) -> Iterator[Scenario]:
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


def _read_causes(content: Mapping[str, object]) -> list[_StatedCause]:
    """Return the standard deviations of the parameters of every cause that states some."""
    found, causes = [], content.get("causes")
    for cause in causes if isinstance(causes, list) else []:
        stated = cause["parameters"]
        stds = {name: float(value["std"]) for name, value in stated.items() if isinstance(value, dict) and value["std"]}
        found.append(_StatedCause(cause["effect"], stated.get("channel"), stds))
    return found
