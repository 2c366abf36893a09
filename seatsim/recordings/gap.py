"""The gap between a simulation and a recording."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seatsim.recordings.compared import COMPARED, stands_out
from seatsim.recordings.recording import Recording, load_recording
from seatsim.recordings.replay import replay
from seatsim.scenario.loading import single
from seatsim.scenario.scenario import Scenario
from seatsim.schema.errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Gap:
    """The gap of a simulation, in standard deviations of what was measured.

    `channels` holds `rms(measured - simulated) / std(measured)` by channel, `overall` is `sqrt(mean of its squares)`;
    `floor` holds the same two for the stated noise alone.
    """

    overall: float
    channels: dict[str, float]
    floor: dict[str, Any]

    def as_dict(self) -> dict[str, Any]:
        """Return the gap as it stands in `gap.json`."""
        return {"overall": self.overall, "channels": self.channels, "floor": self.floor}


def gap(scenario: str | Path | Scenario, recording: str | Path | Recording, runs: Sequence[str] = ()) -> Gap:
    """Replay a scenario against the runs of a recording (all of them where none are named) and return their gap.

    Raises:
        InputError: the scenario holds several runs, does not fit the rig, or the recording has nothing to compare.
        RunError: a replay could not be carried to its end.
    """
    if not isinstance(recording, Recording):
        recording = load_recording(recording)
    if not isinstance(scenario, Scenario):
        scenario = single(scenario)
    names = list(runs) or list(recording.runs)
    measured, simulated = pooled(scenario, recording, names)
    channels = {name: _rms(measured[name] - simulated[name]) / float(np.std(measured[name])) for name in measured}
    floors = {name: recording.channels[name].noise_rms / float(np.std(measured[name])) for name in measured}
    return Gap(_overall(channels), channels, {"overall": _overall(floors), "channels": floors})


def pooled(scenario: Scenario, recording: Recording, runs: Sequence[str]) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return measured and simulated channels that are compared, over all samples of the runs, shape (N,) each."""
    pairs = [replay(scenario, recording, run) for run in runs]
    names = [name for name in COMPARED[recording.header.rig] if name in recording.channels]
    measured = {name: np.concatenate([m[name] for m, _ in pairs]) for name in names}
    simulated = {name: np.concatenate([s[name] for _, s in pairs]) for name in names}
    loud = [n for n in names if stands_out(measured[n], recording.channels[n].noise_rms)]
    if not loud:
        raise InputError(f"{recording.folder}: no recorded output stands above its noise; there is nothing to compare")
    return {n: measured[n] for n in loud}, {n: simulated[n] for n in loud}


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _overall(values: dict[str, float]) -> float:
    return float(np.sqrt(np.mean([value**2 for value in values.values()])))
