"""The gap to be expected on a recording beside the one that is measured there, where its outputs are recorded."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from seatsim.recordings.gap import Gap, GapFigures, measure_gap
from seatsim.recordings.prediction import Prediction, predict_gap
from seatsim.recordings.quality.examination import examine, refuse
from seatsim.recordings.recording import Recording, load_recording
from seatsim.recordings.replay import COMPARED, note_unused_log
from seatsim.scenario.loading import single
from seatsim.scenario.scenario import Scenario
from seatsim.schema.content import IfAny, Unwritten


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
    recording = recording if isinstance(recording, Recording) else load_recording(recording)
    scenario = scenario if isinstance(scenario, Scenario) else single(scenario)
    examination = examine(recording)
    refuse(examination)
    predicted = predict_gap(scenario, recording, diagnosis)
    notes = tuple(dict.fromkeys([*note_unused_log(scenario, recording), *examination.sentences]))
    if not has_outputs(recording):
        return Forecast(math.nan, {}, GapFigures(math.nan, {}), notes, predicted=predicted)
    before, after = measure_gap(recording.nominal, recording), measure_gap(scenario, recording)
    measured = MeasuredShrink(before.overall, after.overall, 1.0 - after.overall / before.overall, before.channels)
    return Forecast(after.overall, after.channels, after.floor, notes, measured, predicted=predicted)


def has_outputs(recording: Recording) -> bool:
    """Whether an output is recorded; a coil current is an input where it drives the damper in place of a command."""
    recorded, commands = set(recording.channels), {"current_command", "command_voltage"}
    outputs = recorded.intersection(COMPARED[recording.header.rig])
    return bool(outputs if commands & recorded else outputs - {"coil_current"})
