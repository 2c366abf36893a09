"""How strong a fault is: by how much it moves the channels that a gap compares, and the severity that does so.

Materiality (contract, section 4): the largest over compared channels of `rms(moved) / max(0.05 std, noise)`; 1 is the
material limit. What is moved is what a replay would miss: the reading with the fault less the reading without it, and
less what the faulty inputs already move in the replay.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from seatsim.blind.truth.experiment import Experiment, read_channels, simulate_run
from seatsim.blind.truth.faults.scenario import Changes
from seatsim.blind.truth.physics.rig import RigMotion
from seatsim.blind.truth.sensors import Readings
from seatsim.schema.arrays import Array

MATERIAL_SHARE = 0.05
"""Of a channel's spread (contract, section 4)."""
NOISE_FACTOR = 3.0
"""A channel is compared where its spread is at least so many times its noise (contract, section 4)."""
LEFT_OUT = 1.0
"""Seconds at the start of each run that no gap counts (contract, section 4)."""
COARSE_STEP = 2.5e-4
"""Step of the simulations that only measure sizes, s: two and a half times as fast as those that are recorded."""
REMEMBERED = 6
"""Sets of motions that are kept beside the first, which is that of the rig without the fault."""


@dataclass
class CommandedRuns:
    """The recorded runs of an experiment in open loop, under the commands that were recorded in closed loop.

    So a fault is measured by what it does to the rig, and not by what the controller then does about it.
    """

    experiment: Experiment
    commands: list[Array]
    """A, one per row, for each recorded run."""
    known: dict[str, list[RigMotion]] = field(default_factory=dict)
    """Motions simulated so far, by what makes them."""

    @property
    def runs(self) -> range:
        """Recorded runs."""
        return range(len(self.commands))

    @property
    def left_out(self) -> int:
        """Rows at the start of each run that no gap counts."""
        return round(LEFT_OUT * self.experiment.sample_rate)

    def simulate(self, changes: Changes) -> list[RigMotion]:
        """Return the motion of each run; sensor faults do not change it, so one simulation serves all of those."""
        key = repr((sorted(changes.parameters.items()), changes.frame_forces))
        if key not in self.known:
            if len(self.known) > REMEMBERED:
                self.known.pop(list(self.known)[1])
            self.known[key] = [
                simulate_run(self.experiment, changes, k, self.commands[k], step=COARSE_STEP) for k in self.runs
            ]
        return self.known[key]

    def read(self, changes: Changes) -> list[Readings]:
        """Return what the channels show in each run, without noise."""
        motions = self.simulate(changes)
        return [read_channels(self.experiment, changes, k, motions[k]) for k in self.runs]

    def materiality(self, fault: Changes, others: Changes) -> tuple[float, Array]:
        """Return the materiality of a fault in the presence of others, and its response over channels and runs.

        The response is in material limits; a rig that becomes unstable is infinitely material.
        """
        response, limits = self.response(fault, others)
        if not response or not all(np.all(np.isfinite(values)) for values in response.values()):
            return math.inf, np.zeros(1)
        parts = [values / limits[name] for name, values in response.items()]
        return max(rms(part) for part in parts), np.concatenate(parts)

    def response(self, fault: Changes, others: Changes) -> tuple[dict[str, Array], dict[str, float]]:
        """Return what a replay would miss by compared channel (those above noise), and the material limit of each."""
        rest = self.read(others)  # first, so that the motions without the fault are the ones never forgotten
        both = self.read(others + fault)
        on_inputs = any(f.on_input for f in fault.sensor_faults)
        replayed = self._response_of_replay(fault, others, both) if on_inputs else None
        response: dict[str, Array] = {}
        limits: dict[str, float] = {}
        for name in self.experiment.compared:
            with_it = self._pooled(both, name)
            spread, noise = float(np.std(with_it)), self.experiment.noise[name]
            if spread < NOISE_FACTOR * noise:
                continue
            response[name] = with_it - self._pooled(rest, name)
            if replayed is not None:
                response[name] -= replayed[name]
            limits[name] = max(MATERIAL_SHARE * spread, noise)
        return response, limits

    def _response_of_replay(self, fault: Changes, others: Changes, shown: list[Readings]) -> dict[str, Array]:
        """Return what faulty inputs move in a replay, by compared channel."""
        clean = Changes(others.parameters, others.frame_forces)
        base = self.simulate(clean)
        on_floor = any(f.channel == "floor_acceleration" for f in fault.sensor_faults)
        parts: dict[str, list[Array]] = {name: [] for name in self.experiment.compared}
        for k in self.runs:
            floor = shown[k]["floor_acceleration"] if on_floor else None
            motion = simulate_run(self.experiment, clean, k, shown[k]["current_command"], floor, COARSE_STEP)
            new = read_channels(self.experiment, clean, k, motion)
            old = read_channels(self.experiment, clean, k, base[k])
            for name, moved in parts.items():
                moved.append(new[name][self.left_out :] - old[name][self.left_out :])
        return {name: np.concatenate(moved) for name, moved in parts.items()}

    def _pooled(self, runs: list[Readings], name: str) -> Array:
        """Return a channel over all runs, without the rows that no gap counts."""
        return np.concatenate([run[name][self.left_out :] for run in runs])


def rms(values: Array) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(values**2)))


def collinearity(a: Array, b: Array) -> float:
    """Return `|a b| / (|a| |b|)` of two responses, 0..1."""
    size = float(np.linalg.norm(a) * np.linalg.norm(b))
    return abs(float(a @ b)) / size if size else 0.0
