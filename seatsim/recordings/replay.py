"""Replay of a scenario against one run of a recording."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from numpy.typing import NDArray

from seatsim.excitations.recording import RecordedRun
from seatsim.recordings.compared import COMPARED, LEAST_ROWS, LEFT_OUT
from seatsim.recordings.recording import Recording
from seatsim.scenario.scenario import Scenario, Start
from seatsim.schema.errors import InputError
from seatsim.simulation.augment import readings
from seatsim.simulation.bench_replay import replay_bench
from seatsim.simulation.simulate import simulate

Array = NDArray[np.float64]


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
