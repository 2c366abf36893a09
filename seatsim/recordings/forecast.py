"""The gap to be expected on a recording beside the one that is measured there, where its outputs are recorded."""

from __future__ import annotations

import math
from pathlib import Path
from typing import NamedTuple

from seatsim.recordings.gap import Gap, measure_gap
from seatsim.recordings.prediction import Prediction, predict_gap
from seatsim.recordings.quality.examination import examine, refuse
from seatsim.recordings.recording import Recording, load_recording
from seatsim.recordings.replay import COMPARED, note_unused_log
from seatsim.scenario.loading import single
from seatsim.scenario.scenario import Scenario


class MeasuredGaps(NamedTuple):
    """The gaps that were measured with the nominal and with the augmented scenario."""

    before: Gap
    after: Gap

    @property
    def shrink(self) -> float:
        """By how much the gap shrinks."""
        return 1.0 - self.after.overall / self.before.overall

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
    scenario = scenario if isinstance(scenario, Scenario) else single(scenario)
    examination = examine(recording)
    refuse(examination)
    predicted = predict_gap(scenario, recording, diagnosis)
    measured = None
    if has_outputs(recording):
        measured = MeasuredGaps(measure_gap(recording.nominal, recording), measure_gap(scenario, recording))
    notes = dict.fromkeys([*note_unused_log(scenario, recording), *examination.sentences])
    return Forecast(predicted, measured, tuple(notes))


def has_outputs(recording: Recording) -> bool:
    """Whether an output is recorded; a coil current is an input where it drives the damper in place of a command."""
    recorded, commands = set(recording.channels), {"current_command", "command_voltage"}
    outputs = recorded.intersection(COMPARED[recording.header.rig])
    return bool(outputs if commands & recorded else outputs - {"coil_current"})
