"""The problem of a diagnosis: a recording beside its nominal scenario, ready to be simulated again and again."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.fft import prev_fast_len

from seatsim.diagnosis.nuisance import Nuisance, list_nuisances, vary
from seatsim.diagnosis.settings.diagnosis_settings import DiagnosisSettings
from seatsim.effects.base import off
from seatsim.effects.damper import SealFriction
from seatsim.excitations.base import Floor
from seatsim.excitations.recording import RecordedRun
from seatsim.recordings.compared import COMPARED, LEFT_OUT, stands_out
from seatsim.recordings.recording import Recording
from seatsim.scenario.loading import single
from seatsim.scenario.scenario import Scenario, Start
from seatsim.schema.errors import InputError, RunError
from seatsim.simulation.augment import readings
from seatsim.simulation.bench_replay import replay_bench
from seatsim.simulation.simulate import Forces, simulate

Array = NDArray[np.float64]
COARSEST_STEP = 0.002
"""s; longest step of the simulation: with its adaptive sub-steps a shorter one moves no figure of a diagnosis."""
CARRIER: Any = SealFriction
"""An effect that every simulation carries, off, so that all candidates share one compiled loop."""


class Drive(NamedTuple):
    """What drives a simulation instead of the recorded floor alone."""

    floor: Floor | None = None
    forces: Forces | None = None


@dataclass(frozen=True)
class DiagnosisProblem:
    """A recording, its nominal scenario, and what is compared: channels, in order, and runs.

    `measured` holds the compared channels of each run without its first second, shape (channels, samples); `floors` the
    recorded inputs of each run (None on a bench); `parameters` what the owner's tolerance lets vary; simulations are
    shared out over `pool`.
    """

    recording: Recording
    scenario: Scenario
    runs: tuple[str, ...]
    channels: tuple[str, ...]
    measured: dict[str, Array]
    floors: dict[str, Floor | None]
    parameters: tuple[Nuisance, ...]
    settings: DiagnosisSettings
    pool: Executor

    @property
    def bench(self) -> bool:
        """Whether this is a damper bench."""
        return self.recording.header.rig == "damper_bench"

    @property
    def rate(self) -> float:
        """Rows per second of the recording."""
        return self.recording.header.sample_rate

    @property
    def skip(self) -> int:
        """Rows at the start of a run that are not compared."""
        return round(LEFT_OUT * self.rate)

    @property
    def parts(self) -> int:
        """Steps of the simulation in the time of a row."""
        return round(1.0 / self.rate / self.scenario.solver.step)

    @cached_property
    def noise(self) -> Array:
        """Stated noise of the compared channels, shape (channels,)."""
        return np.array([self.recording.channels[name].noise_rms for name in self.channels])

    @cached_property
    def spread(self) -> Array:
        """Standard deviation of what was measured in the compared channels over all runs, shape (channels,)."""
        return np.asarray(np.std(np.concatenate([self.measured[run] for run in self.runs], axis=1), axis=1))

    @property
    def nominal(self) -> Array:
        """Deviations of the nuisance parameters at their nominal values, shape (parameters,)."""
        return np.zeros(len(self.parameters))

    def on_runs(self, runs: Sequence[str]) -> DiagnosisProblem:
        """Return the problem with some of its runs only; channels and their spreads are those of all runs."""
        return dataclasses.replace(self, runs=tuple(runs))

    def augmented(self, deviations: Array, effects: Sequence[Any]) -> Scenario:
        """Return the nominal scenario with other parameters and with effects."""
        chosen = [*self.scenario.effects, *effects]
        carrier = [] if any(isinstance(effect, CARRIER) for effect in chosen) else [off(CARRIER)]
        return dataclasses.replace(vary(self.scenario, self.parameters, deviations), effects=(*chosen, *carrier))

    def simulated(self, run: str, deviations: Array, effects: Sequence[Any], drive: Drive | None = None) -> Array:
        """Return the compared channels of a run, shape (channels, samples), as `measured` has them."""
        scenario = self.augmented(deviations, effects)
        if self.bench:
            answer = replay_bench(scenario, self.recording, run)
        else:
            step = 1.0 / self.recording.header.sample_rate
            drive = drive or Drive()
            history = simulate(scenario, drive.floor or self.floors[run], drive.forces)
            answer = readings(scenario.effects, step, {name: history[name][:: self.parts] for name in self.channels})
        return np.array([answer[name][self.skip : self.skip + self.measured[run].shape[1]] for name in self.channels])

    def _attempted(self, run: str, deviations: Array, effects: Sequence[Any]) -> Array:
        """Return the simulated channels of a run, infinite where the rig leaves all bounds."""
        try:
            return self.simulated(run, deviations, effects)
        except RunError:
            return np.full(self.measured[run].shape, np.inf)

    def residuals(self, rigs: Sequence[tuple[Array, Sequence[Any]]]) -> list[dict[str, Array]]:
        """Return `measured - simulated` of every run for each rig (deviations, effects), on all cores."""
        jobs = [(index, run) for index in range(len(rigs)) for run in self.runs]
        answers = self.pool.map(lambda job: self._attempted(job[1], *rigs[job[0]]), jobs)
        found: list[dict[str, Array]] = [{} for _ in rigs]
        for (index, run), values in zip(jobs, answers, strict=True):
            found[index][run] = self.measured[run] - values
        return found


def pose_problem(recording: Recording, pool: Executor, settings: DiagnosisSettings | None = None) -> DiagnosisProblem:
    """Read a recording and its nominal scenario.

    Raises:
        InputError: the recording or its scenario is not right, or no output stands above its noise.
    """
    scenario = single(recording.nominal)
    interval = 1.0 / recording.header.sample_rate
    parts = max(1, math.ceil(interval / COARSEST_STEP - 1e-9))
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
    # Spectra of a few rows less are many times faster where the number of rows has only small prime factors.
    ends = {run: skip + prev_fast_len(len(table[loud[0]]) - skip, real=True) for run, table in tables.items()}
    measured = {run: np.array([table[name][skip : ends[run]] for name in loud]) for run, table in tables.items()}
    floors = {run: None if scenario.plant is None else _recorded_floor(recording, run, solver.step) for run in tables}
    parameters = tuple(list_nuisances(scenario, recording.header.parameter_tolerance))
    return DiagnosisProblem(
        recording, scenario, tuple(tables), tuple(loud), measured, floors, parameters, settings or DiagnosisSettings(),
        pool,
    )  # fmt: skip


def normalise_rms_errors(problem: DiagnosisProblem, residuals: Mapping[str, Array]) -> Array:
    """Return the RMS error of each run in standard deviations of the channels, shape (runs,)."""
    powers = [np.mean((residuals[run] / problem.spread[:, None]) ** 2) for run in problem.runs]
    return np.asarray(np.sqrt(powers))


def _recorded_floor(recording: Recording, run: str, step: float) -> Floor:
    return RecordedRun(str(recording.folder), run).floor(step, seed=0)
