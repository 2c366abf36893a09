"""The problem of a diagnosis: a recording and its nominal scenario, prepared for simulation until a deadline."""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Collection, Container, Hashable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.fft import prev_fast_len

from seatsim.diagnosis.settings import DiagnosisSettings
from seatsim.effects.base import ON_DAMPER, ON_SEAT, acts_on, replace_effects
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

    @classmethod
    def after(cls, seconds: float) -> Deadline:
        """Return the deadline that lies so many seconds ahead."""
        return cls(time.monotonic() + seconds)

    @property
    def is_past(self) -> bool:
        """Whether the time is spent."""
        return time.monotonic() >= self.end

    def check(self) -> None:
        """Raise OutOfTimeError where the time is spent."""
        if self.is_past:
            raise OutOfTimeError


NEVER = Deadline()
"""No limit."""


_COARSEST_STEP = 0.002
"""s; longest step of the simulation: its adaptive sub-steps make a shorter one change no figure of a diagnosis."""
_REACHED = {"m": ("suspension_displacement",), "A": ("coil_current", "current_command")}
"""Channels that tell how far the rig went towards a limit, by its unit: the first that was recorded does."""
_ONLY_READ = tuple(name for name in SEAT_OUTPUTS if name != "coil_current")
"""Channels that nothing is simulated from: an error of their sensor leaves the motion of the rig as it is."""
_IN_LOOP = (*ON_DAMPER, *ON_SEAT, "factors")
"""Hooks of effects that change what the time loop is compiled for."""
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
        inputs = dict[str, RigInputs]()
        for run, driven in self.inputs.items():
            assert isinstance(driven, SeatInputs)
            inputs[run] = driven._replace(forces=Forces(self.spread_over_steps(driven, forces[run])))
        return dataclasses.replace(self, inputs=inputs, traces=traces, motions={})

    def spread_over_steps(self, inputs: SeatInputs, signal: Array) -> Array:
        """Return a signal of the rows that are compared on the simulation's steps, linear between rows, 0 outside."""
        rows = np.arange(len(inputs.floor.acceleration)) / self.parts
        return np.interp(rows, self.skip + np.arange(len(signal)), signal, left=0.0, right=0.0)

    def as_recorded(self) -> DiagnosisProblem:
        """Return the problem without forces about which it was linearised."""
        if not self.traces:
            return self
        seats = {run: each for run, each in self.inputs.items() if isinstance(each, SeatInputs)}
        inputs = dict[str, RigInputs]({run: each._replace(forces=Forces()) for run, each in seats.items()})
        return dataclasses.replace(self, inputs=inputs, traces={}, motions={})

    def augmented(self, deviations: Array, effects: Sequence[Record]) -> Scenario:
        """Return the nominal scenario with other parameters, and effects, which replace its own of the same kind."""
        varied = vary(self.scenario, self.parameters, deviations)
        return dataclasses.replace(varied, effects=replace_effects(self.scenario.effects, effects))

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
        outputs = _respond(scenario, inputs) if inputs else self._replay(run, deviations, scenario)
        end = self.skip + self.measured[run].shape[1]
        simulated = np.array([outputs[name][self.skip : end] for name in self.channels])
        return simulated - self.traces[run] if run in self.traces and inputs is None else simulated

    def _replay(self, run: str, deviations: Array, scenario: Scenario) -> Mapping[str, Array]:
        """Return what the sensors say in a run; a motion that only sensors read otherwise is not simulated again."""
        wrong = tuple(each for each in scenario.effects if _is_only_read(each))
        others = tuple(each for each in scenario.effects if each not in wrong)
        key = run, self.parameters, deviations.tobytes(), repr(others)
        outputs = self.motions.get(key) if wrong else None
        if outputs is None:
            outputs = _respond(dataclasses.replace(scenario, effects=others), self.inputs[run])
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
        jobs = [(index, run) for index in range(len(rigs)) for run in self.runs]
        answers = self.pool.map(lambda job: self._residuals(job[1], *rigs[job[0]]), jobs)
        found: list[dict[str, Array]] = [{} for _ in rigs]
        for (index, run), values in zip(jobs, answers, strict=True):
            found[index][run] = values
        return found


def _is_only_read(effect: object) -> bool:
    """Whether an effect changes what one sensor says, and nothing of the motion of the rig."""
    return hasattr(effect, "reading") and getattr(effect, "channel", "") in _ONLY_READ


def _respond(scenario: Scenario, inputs: RigInputs) -> dict[str, Array]:
    """Return what the sensors say, by one of two compiled loops: without effects or, twice as slow, with all of them.

    Thousands of candidates are simulated, so that none can have a loop of its own.
    """
    return respond(scenario, inputs, carry_all_effects=any(acts_on(type(each), _IN_LOOP) for each in scenario.effects))


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
    parameters = list_varied(recording.header, scenario, settings.fit.fitted_tolerance)
    return DiagnosisProblem(
        recording, scenario, tuple(tables), tuple(loud), measured, inputs, parameters, settings, pool,
        current_falls=shows_falling_current(recording), reached=_measure_reach(recording.channels, tables.values()),
    )  # fmt: skip


def _measure_reach(recorded: Container[str], tables: Collection[Mapping[str, Array]]) -> dict[str, float]:
    """Return the largest value of the first recorded channel of each unit, in any run."""
    first = {unit: next((name for name in names if name in recorded), "") for unit, names in _REACHED.items()}
    return {unit: max(float(np.abs(table[name]).max()) for table in tables) for unit, name in first.items() if name}


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
