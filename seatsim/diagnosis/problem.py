"""The problem of a diagnosis: a recording and its nominal scenario, prepared for simulation until a deadline."""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Hashable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from functools import cached_property
from itertools import islice

import numpy as np
from scipy.fft import prev_fast_len

from seatsim.diagnosis.settings import DiagnosisSettings
from seatsim.effects.base import replace_effects
from seatsim.recordings.nuisance import Nuisance, list_varied, vary
from seatsim.recordings.quality.coverage import shows_falling_current
from seatsim.recordings.quality.sensors import without_gravity
from seatsim.recordings.recording import Recording
from seatsim.recordings.replay import COMPARED, LEFT_OUT, recorded_inputs, stands_out
from seatsim.scenario.scenario import Scenario, Start
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError, RunError
from seatsim.schema.registry import Record
from seatsim.simulation.augment import read_sensors
from seatsim.simulation.inputs import Forces, RigInputs, SeatInputs
from seatsim.simulation.respond import FINER, SEAT_OUTPUTS, respond


class OutOfTimeError(Exception):
    """The time of a search is spent; who catches it goes on with the best found so far."""


@dataclass(frozen=True)
class Deadline:
    """The instant at which a search ends, in seconds of `time.monotonic`."""

    end: float = math.inf

    @property
    def is_past(self) -> bool:
        """Whether the time is spent."""
        return time.monotonic() >= self.end


NEVER = Deadline()
"""No limit."""


_COARSEST_STEP = 0.002
"""s; longest step of the simulation: its adaptive sub-steps make a shorter one change no figure of a diagnosis."""
_REACHED = {"m": ("suspension_displacement",), "A": ("coil_current", "current_command")}
"""Channels that tell how far the rig went towards a limit, by its unit: the first that was recorded does."""
_ONLY_READ = tuple(name for name in SEAT_OUTPUTS if name != "coil_current")
"""Channels that nothing is simulated from: an error of their sensor leaves the motion of the rig as it is."""
LEAST_REMOVABLE = 0.01
"""Removable gap, in standard deviations, below which its share is not asked for, since it is that of a small number."""
_MOST_MOTIONS = 48
"""Motions that are kept, some megabytes each, for candidates and difference steps that share them."""


@dataclass(frozen=True)
class DiagnosisProblem:
    """A recording, its nominal scenario, and what is compared: channels, in order, and runs.

    `measured` holds the compared channels of each run without its first second, shape (channels, samples), `inputs` the
    inputs of each run, `parameters` those that the stated tolerance lets vary; `pool` runs simulations in parallel.
    Fits end at the `deadline`. `current_falls` says whether the current falls anywhere, by which memory of it shows,
    `reached` how far the rig went towards a limit of its travel or current, by the limit's unit. `traces` are what
    forces among the inputs leave in the channels, by run (see `about`). `motions` holds the last outputs of rigs some
    of whose sensors err.
    """

    recording: Recording
    scenario: Scenario
    runs: tuple[str, ...]
    channels: tuple[str, ...]
    measured: dict[str, Array]
    inputs: dict[str, RigInputs]
    parameters: tuple[Nuisance, ...]
    settings: DiagnosisSettings
    pool: Executor
    deadline: Deadline = field(default=NEVER, kw_only=True)
    current_falls: bool = field(default=True, kw_only=True)
    reached: Mapping[str, float] = field(default_factory=dict, kw_only=True)
    traces: Mapping[str, Array] = field(default_factory=dict, kw_only=True)
    motions: dict[Hashable, Mapping[str, Array]] = field(default_factory=dict, kw_only=True, repr=False, compare=False)

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
    def command_interval(self) -> float:
        """Interval in s at which a held command may change: a row; on a bench the part by which a log is shifted."""
        return 1.0 / self.rate / (FINER if self.bench else 1)

    @property
    def parts(self) -> int:
        """Steps of the simulation in the time of a row."""
        return round(1.0 / self.rate / self.scenario.solver.step)

    @property
    def repeats(self) -> list[tuple[str, str]]:
        """Pairs of runs with the same excitation: the first, and its repeat."""
        firsts = {run: self.recording.runs[run].repeat_of for run in self.runs}
        return [(first, run) for run, first in firsts.items() if first in self.runs]

    @cached_property
    def noise(self) -> Array:
        """Stated noise of the compared channels, shape (channels,)."""
        return np.array([self.recording.channels[name].noise_rms for name in self.channels])

    @cached_property
    def spread(self) -> Array:
        """Standard deviation of what was measured in the compared channels over all runs, shape (channels,).

        It is infinite for a channel that is constant in these runs, so that whatever is divided by it counts nothing.
        """
        found = np.std(np.concatenate([self.measured[run] for run in self.runs], axis=1), axis=1)
        return np.where(found > 0.0, found, np.inf)

    def seat_inputs(self, run: str) -> SeatInputs:
        """Return the inputs of a run on a seat."""
        inputs = self.inputs[run]
        assert isinstance(inputs, SeatInputs)
        return inputs

    @property
    def nominal(self) -> Array:
        """Deviations of the nuisance parameters at their nominal values, shape (parameters,)."""
        return np.zeros(len(self.parameters))

    def on_runs(self, runs: Sequence[str]) -> DiagnosisProblem:
        """Return the problem with some of its runs; channels stay the same, their spreads are taken over these runs."""
        return dataclasses.replace(self, runs=tuple(runs))

    def until(self, deadline: Deadline) -> DiagnosisProblem:
        """Return the problem with another deadline of its fits."""
        return dataclasses.replace(self, deadline=deadline)

    def about(self, forces: Mapping[str, Array], traces: Mapping[str, Array]) -> DiagnosisProblem:
        """Return the problem linearised about forces on the frame of a seat, in N, shape (samples,) by run.

        The rig is driven by them, and their `traces` in the channels, shape (channels, samples), are taken off again,
        so that the damper slips as it does under the forces.
        """
        seats = {run: self.seat_inputs(run) for run in self.inputs}
        acting = {run: Forces(self.spread_over_steps(seat, forces[run])) for run, seat in seats.items()}
        driven = {run: seat._replace(forces=acting[run]) for run, seat in seats.items()}
        return dataclasses.replace(self, inputs=dict(driven), traces=traces, motions={})

    def spread_over_steps(self, inputs: SeatInputs, signal: Array) -> Array:
        """Return a signal of the rows that are compared on the simulation's steps, linear between rows, 0 outside."""
        rows = np.arange(len(inputs.floor.acceleration)) / self.parts
        return np.interp(rows, self.skip + np.arange(len(signal)), signal, left=0.0, right=0.0)

    def augmented(self, deviations: Array, effects: Sequence[Record], nominal: Scenario | None = None) -> Scenario:
        """Return the nominal scenario with other parameters, and effects, which replace its own of the same kind.

        The nominal scenario is that of the problem, with its solver, unless another one is given.
        """
        nominal = self.scenario if nominal is None else nominal
        varied = vary(nominal, self.parameters, deviations)
        return dataclasses.replace(varied, effects=replace_effects(nominal.effects, effects))

    def scenario_of(self, run: str, deviations: Array, effects: Sequence[Record]) -> Scenario:
        """Return the same rig as it was in a run, with what its owner changed for that run on purpose."""
        return self.recording.scenario_of(run, self.augmented(deviations, effects))

    def simulated(
        self, run: str, deviations: Array, effects: Sequence[Record], inputs: RigInputs | None = None
    ) -> Array:
        """Return the compared channels of a run, shape (channels, samples), as `measured` has them.

        `inputs` drive the rig instead of the recorded ones.
        """
        scenario = self.scenario_of(run, deviations, effects)
        outputs = respond(scenario, inputs) if inputs else self._replay(run, deviations, scenario)
        end = self.skip + self.measured[run].shape[1]
        simulated = np.array([outputs[name][self.skip : end] for name in self.channels])
        return simulated - self.traces[run] if run in self.traces and inputs is None else simulated

    def _replay(self, run: str, deviations: Array, scenario: Scenario) -> Mapping[str, Array]:
        """Return what the sensors say in a run; a motion that only sensors read otherwise is not simulated again."""
        wrong = tuple(
            each for each in scenario.effects if hasattr(each, "reading") and getattr(each, "channel", "") in _ONLY_READ
        )
        others = tuple(each for each in scenario.effects if each not in wrong)
        key = run, self.parameters, deviations.tobytes(), repr(others)
        outputs = self.motions.get(key) if wrong else None
        if outputs is None:
            outputs = respond(dataclasses.replace(scenario, effects=others), self.inputs[run])
        if wrong:
            if len(self.motions) >= _MOST_MOTIONS:
                self.motions.clear()
            self.motions[key] = outputs
        return read_sensors(wrong, 1.0 / self.rate, outputs)

    def _residuals(self, run: str, deviations: Array, effects: Sequence[Record]) -> Array:
        """Return `measured - simulated` of a run, infinite where the rig leaves all bounds."""
        try:
            simulated = self.simulated(run, deviations, effects)
        except RunError:
            return np.full(self.measured[run].shape, np.inf)
        return np.subtract(self.measured[run], simulated, out=simulated)

    def residuals(self, rigs: Sequence[tuple[Array, Sequence[Record]]]) -> list[dict[str, Array]]:
        """Return `measured - simulated` of every run for each rig (deviations, effects), on all cores."""
        jobs = [(run, *rig) for rig in rigs for run in self.runs]
        answers = self.pool.map(lambda job: self._residuals(*job), jobs)
        return [dict(zip(self.runs, islice(answers, len(self.runs)), strict=True)) for _ in rigs]


def pose_problem(recording: Recording, pool: Executor, settings: DiagnosisSettings | None = None) -> DiagnosisProblem:
    """Read a recording, without the gravity in its accelerometers, and its nominal scenario.

    Raises:
        InputError: the recording or its scenario is not right, or no output stands above its noise.
    """
    recording = without_gravity(recording)
    scenario = recording.nominal
    interval = 1.0 / recording.header.sample_rate
    parts = max(1, math.ceil(interval / _COARSEST_STEP - 1e-9))
    solver = scenario.solver._replace(step=interval / parts)
    scenario = dataclasses.replace(scenario, solver=solver, start=Start())
    tables = {run: recording.table(run) for run in recording.runs}
    names = [name for name in COMPARED[recording.header.rig] if name in recording.channels]
    loud = [
        name
        for name in names
        if stands_out(np.concatenate([table[name] for table in tables.values()]), recording.channels[name].noise_rms)
    ]
    if not loud:
        raise InputError(f"{recording.folder}: no recorded output stands above its noise; there is nothing to diagnose")
    skip = round(LEFT_OUT * recording.header.sample_rate)
    # Dropping a few rows leaves a length with small prime factors only, whose spectra are many times faster.
    ends = {run: skip + prev_fast_len(len(table[loud[0]]) - skip, real=True) for run, table in tables.items()}
    measured = {run: np.array([table[name][skip : ends[run]] for name in loud]) for run, table in tables.items()}
    inputs = {run: recorded_inputs(recording, table, solver.step) for run, table in tables.items()}
    settings = settings or DiagnosisSettings()
    telling = {unit: [name for name in names if name in recording.channels] for unit, names in _REACHED.items()}
    reached = {
        unit: max(float(np.abs(table[names[0]]).max()) for table in tables.values())
        for unit, names in telling.items()
        if names
    }
    parameters = list_varied(recording.header, scenario, settings.selection.fitted_tolerance)
    return DiagnosisProblem(
        recording, scenario, tuple(tables), tuple(loud), measured, inputs, parameters, settings, pool,
        current_falls=shows_falling_current(recording), reached=reached,
    )  # fmt: skip


def check_nominal(problem: DiagnosisProblem) -> None:
    """Simulate the nominal rig in every run.

    Raises:
        RunError: it cannot be simulated in a run, so that nothing can be compared with it.
    """
    rig = problem.nominal, ()
    for run, values in problem.residuals([rig])[0].items():
        if not np.all(np.isfinite(values)):
            try:
                problem.simulated(run, *rig)
                happened = "its outputs are not finite"
            except RunError as error:
                happened = str(error)
            place = f"{problem.recording.folder}, run {run}: the nominal scenario {problem.recording.header.nominal}"
            raise RunError(f"{place} cannot be simulated: {happened}; check the values and signs of its parameters")


def normalise_rms_errors(problem: DiagnosisProblem, residuals: Mapping[str, Array]) -> Array:
    """Return the RMS error of each run in standard deviations of the channels, shape (runs,)."""
    powers = [np.mean((residuals[run] / problem.spread[:, None]) ** 2) for run in problem.runs]
    return np.asarray(np.sqrt(powers))
