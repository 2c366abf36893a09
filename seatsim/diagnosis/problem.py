"""A recording beside its nominal scenario, ready to be simulated again and again."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.fft import prev_fast_len

from seatsim.diagnosis.nuisance import Nuisance, nuisances, varied
from seatsim.recordings.compared import COMPARED, LEFT_OUT, stands_out
from seatsim.recordings.inputs import recorded_inputs
from seatsim.recordings.recording import Recording
from seatsim.scenario.loading import single
from seatsim.scenario.scenario import Scenario, Start
from seatsim.schema.errors import InputError, RunError
from seatsim.simulation.inputs import RigInputs
from seatsim.simulation.respond import respond

Array = NDArray[np.float64]
POOL = ThreadPoolExecutor()


@dataclass(frozen=True)
class Problem:
    """A recording, its nominal scenario, and what is compared: channels, in order, and runs.

    `measured` holds the compared channels of each run without its first second, shape (channels, samples).
    """

    recording: Recording
    scenario: Scenario
    runs: tuple[str, ...]
    channels: tuple[str, ...]
    measured: dict[str, Array]
    inputs: dict[str, RigInputs]
    parameters: tuple[Nuisance, ...]

    @property
    def bench(self) -> bool:
        """Whether this is a damper bench."""
        return self.recording.header.rig == "damper_bench"

    @property
    def skip(self) -> int:
        """Rows at the start of a run that are not compared."""
        return round(LEFT_OUT * self.recording.header.sample_rate)

    @property
    def parts(self) -> int:
        """Steps of the simulation in the time of a row."""
        return round(1.0 / self.recording.header.sample_rate / self.scenario.solver.step)

    @cached_property
    def noise(self) -> Array:
        """Stated noise of the compared channels, shape (channels,)."""
        return np.array([self.recording.channels[name].noise_rms for name in self.channels])

    @cached_property
    def spread(self) -> Array:
        """Standard deviation of what was measured in the compared channels over all runs, shape (channels,)."""
        return np.asarray(np.std(np.concatenate([self.measured[run] for run in self.runs], axis=1), axis=1))

    @property
    def rest(self) -> Array:
        """Nuisance parameters at their nominal values."""
        return np.zeros(len(self.parameters))

    def augmented(self, u: Array, effects: Sequence[Any]) -> Scenario:
        """Return the nominal scenario with other parameters and with effects."""
        chosen = (*self.scenario.effects, *effects)
        return dataclasses.replace(varied(self.scenario, self.parameters, u), effects=chosen)

    def simulated(self, run: str, u: Array, effects: Sequence[Any], inputs: RigInputs | None = None) -> Array:
        """Return the compared channels of a run, shape (channels, samples), as `measured` has them.

        `inputs` drive the rig instead of the recorded ones.
        """
        driven_by = self.inputs[run] if inputs is None else inputs
        # Thousands of candidates are simulated, so that they have to share one compiled loop.
        answer = respond(self.augmented(u, effects), driven_by, carry_all_effects=True)
        return np.array([answer[name][self.skip : self.skip + self.measured[run].shape[1]] for name in self.channels])

    def _attempted(self, run: str, u: Array, effects: Sequence[Any]) -> Array:
        """Return the simulated channels of a run, infinite where the rig leaves all bounds."""
        try:
            return self.simulated(run, u, effects)
        except RunError:
            return np.full(self.measured[run].shape, np.inf)

    def residuals(self, points: Sequence[tuple[Array, Sequence[Any]]]) -> list[dict[str, Array]]:
        """Return `measured - simulated` of every run at each point (parameters, effects), on all cores."""
        jobs = [(index, run) for index in range(len(points)) for run in self.runs]
        answers = POOL.map(lambda job: self._attempted(job[1], *points[job[0]]), jobs)
        found: list[dict[str, Array]] = [{} for _ in points]
        for (index, run), values in zip(jobs, answers, strict=True):
            found[index][run] = self.measured[run] - values
        return found


def problem(recording: Recording) -> Problem:
    """Read a recording and its nominal scenario.

    Raises:
        InputError: the recording or its scenario is not right, or no output stands above its noise.
    """
    scenario = single(recording.nominal)
    interval = 1.0 / recording.header.sample_rate
    parts = max(1, math.ceil(interval / 0.002 - 1e-9))
    solver = scenario.solver._replace(step=interval / parts)
    scenario = dataclasses.replace(scenario, solver=solver, start=Start())
    tables = {run: recording.table(run) for run in recording.runs}
    names = [name for name in COMPARED[recording.header.rig] if name in recording.channels]
    loud = [
        name for name in names
        if stands_out(np.concatenate([table[name] for table in tables.values()]), recording.channels[name].noise_rms)
    ]  # fmt: skip
    if not loud:
        raise InputError(f"{recording.folder}: no recorded output stands above its noise; there is nothing to diagnose")
    skip = round(LEFT_OUT * recording.header.sample_rate)
    ends = {run: skip + prev_fast_len(len(table[loud[0]]) - skip, real=True) for run, table in tables.items()}
    measured = {run: np.array([table[name][skip : ends[run]] for name in loud]) for run, table in tables.items()}
    inputs = {run: recorded_inputs(recording, table, solver.step) for run, table in tables.items()}
    found = tuple(nuisances(scenario, recording.header.parameter_tolerance))
    return Problem(recording, scenario, tuple(tables), tuple(loud), measured, inputs, found)
