"""The gap between a simulation and a recording."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.table import Table

from seatsim.augmentation import readings
from seatsim.bench_replay import replay_bench
from seatsim.errors import InputError
from seatsim.excitations.recording import RecordedRun
from seatsim.loading import load
from seatsim.recording import Recording, load_recording
from seatsim.scenario import Scenario, Start
from seatsim.simulation import simulate

Array = NDArray[np.float64]
LEFT_OUT = 1.0
"""Seconds at the start of each run that no gap counts."""
COMPARED = {
    "seat": (
        "frame_acceleration", "driver_acceleration", "suspension_displacement", "damper_force", "coil_current",
    ),
    "damper_bench": ("damper_force", "coil_current"),
}  # fmt: skip
"""Recorded outputs that are compared, by rig."""
LEAST_ROWS = 6
"""Rows that must remain after it."""
NOISE_FACTOR = 3.0
"""A channel is compared where its standard deviation is at least this many times its noise."""


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


def single(path: str | Path, settings: Mapping[str, Any] | None = None) -> Scenario:
    """Load a file that holds one run."""
    scenarios = load(path, settings)
    if len(scenarios) != 1:
        raise InputError(f"{path}: holds {len(scenarios)} runs; this command takes one, without sweep or variants")
    return scenarios[0]


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


def replay(scenario: Scenario, recording: Recording, run: str) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return the measured and the simulated channels of a run at the rows compared, without its first second."""
    bench = recording.header.rig == "damper_bench"
    table = recording.table(run)
    skip = round(LEFT_OUT * recording.header.sample_rate)
    rows = len(next(iter(table.values())))
    if rows < skip + LEAST_ROWS:
        raise InputError(f"{recording.folder}, run {run}: {rows} rows are too short; its first second is left out")
    simulated = (replay_bench if bench else _replay_seat)(scenario, recording, run)
    names = [name for name in COMPARED[recording.header.rig] if name in table]
    return {name: table[name][skip:] for name in names}, {name: simulated[name][skip:] for name in names}


def _replay_seat(scenario: Scenario, recording: Recording, run: str) -> dict[str, Array]:
    """Return the simulated channels at the recorded rows: from rest, at the largest step that divides the rows."""
    interval = 1.0 / recording.header.sample_rate
    parts = math.ceil(interval / scenario.solver.step - 1e-9)
    at_rows = dataclasses.replace(
        scenario,
        excitation=RecordedRun(str(recording.folder), run),
        solver=scenario.solver._replace(step=interval / parts),
        start=Start(),
    )
    history = simulate(at_rows)
    return readings(scenario.effects, interval, {name: history[name][::parts] for name in COMPARED["seat"]})


def stands_out(values: Array, noise: float) -> bool:
    """Whether a channel is compared: its standard deviation is at least three times its noise."""
    spread = float(np.std(values)) if values.size else 0.0
    return spread > 0.0 and spread >= NOISE_FACTOR * noise


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _overall(values: dict[str, float]) -> float:
    return float(np.sqrt(np.mean([value**2 for value in values.values()])))


def report(found: Gap) -> Table:
    """Return the gap as a table: each channel and the overall figure beside the noise floor."""
    table = Table(title="gap, in standard deviations of what was measured", title_justify="left")
    for heading in ("channel", "gap", "noise floor"):
        table.add_column(heading, justify="left" if heading == "channel" else "right")
    for name, value in found.channels.items():
        table.add_row(name, f"{value:.4f}", f"{found.floor['channels'][name]:.4f}")
    table.add_section()
    table.add_row("overall", f"{found.overall:.4f}", f"{found.floor['overall']:.4f}")
    return table
