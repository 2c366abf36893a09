"""Effects tried by hand on a recording: the gap with them, and their sizes fitted to it."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

from seatsim.diagnosis.candidates import Candidate, list_candidates
from seatsim.diagnosis.fit import fit
from seatsim.diagnosis.noise import weigh_uniformly
from seatsim.diagnosis.objective import Objective, Parameters
from seatsim.diagnosis.problem import pose_problem
from seatsim.diagnosis.result import Trace
from seatsim.metrics.motion import rms
from seatsim.recordings.quality.examination import examine, refuse
from seatsim.recordings.recording import load_recording
from seatsim.schema.arrays import Array

PROCESSES = 2
_SETTLED = 1e-4
"""A fit ends where a step lowers the squared gap by less than this share."""


class Trial:
    """A recording, its nominal scenario replayed, and the effects that it could lack, by name."""

    def __init__(self, folder: Path) -> None:
        """Read a recording and replay its nominal scenario.

        Raises:
            InputError: the recording has a fault.
            RunError: the nominal scenario cannot be replayed.
        """
        recording = load_recording(folder)
        refuse(examine(recording))
        posed = pose_problem(recording, ThreadPoolExecutor(PROCESSES))
        self.problem = dataclasses.replace(posed, parameters=())
        self.candidates: dict[str, Candidate] = {}
        for candidate in list_candidates(self.problem):
            self.candidates.setdefault(name_candidate(candidate), candidate)
        self.nominal = self.simulate(Parameters(self.problem.nominal))

    def simulate(self, parameters: Parameters) -> dict[str, Array]:
        """Return the compared channels of each run with some effects, shape (channels, samples).

        Raises:
            RunError: a replay cannot be carried to its end.
        """
        problem = self.problem
        change = (parameters.deviations, parameters.effects)
        jobs = {run: problem.pool.submit(problem.simulated, run, *change) for run in problem.runs}
        return {run: job.result() for run, job in jobs.items()}

    def fit(self, start: Parameters) -> Parameters:
        """Return the parameters of the effects with which the squared gap at the frequencies compared is least."""
        objective = Objective(self.problem, weigh_uniformly(self.problem, self.problem.spread**2))
        begin = objective.evaluate([start])[0]
        return fit(objective, begin, objective.linearise_nuisances(begin), settled=_SETTLED).parameters

    def measure(self, simulated: Mapping[str, Array]) -> Array:
        """Return the gap of each channel over all runs, shape (channels,)."""
        problem = self.problem
        left = np.concatenate([problem.measured[run] - simulated[run] for run in problem.runs], axis=1)
        return np.array([rms(row) for row in left]) / problem.spread

    def list_traces(self, after: Mapping[str, Array]) -> list[Trace]:
        """Return the compared channels of every run beside those without and with effects."""
        problem, signals = self.problem, (self.problem.measured, self.nominal, after, after)
        traces = []
        for run in problem.runs:
            time = (problem.skip + np.arange(problem.measured[run].shape[1])) / problem.rate
            for k, channel in enumerate(problem.channels):
                unit = problem.recording.channels[channel].unit
                traces.append(Trace(run, channel, unit, 0.0, time, *(each[run][k] for each in signals)))
        return traces


def name_candidate(candidate: Candidate) -> str:
    """Return the name of an effect, with its channel where it is one of a sensor."""
    channel = candidate.fixed.get("channel")
    return f"{candidate.effect}:{channel}" if channel else candidate.effect
