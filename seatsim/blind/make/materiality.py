"""How strong a fault is: by how much it moves the channels that a gap compares, beyond what the tolerance explains.

Materiality (contract, section 4): the largest over compared channels of `rms(moved) / max(0.05 std, noise)`; 1 is the
material limit. What is moved is what a replay would miss: the reading with the fault less the reading without it, and
less what the faulty inputs already move in the replay.

By the contract a gap that the tolerance explains is no gap. So a fault counts here only where it stays material after
the best bounded refit of every nominal parameter, linear in the parameters: `min |g - J theta|`, `|theta| <= 1`.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.optimize import lsq_linear

from seatsim.blind.truth.experiment import CHANNELS, Experiment, Readings, read_channels, simulate_run
from seatsim.blind.truth.faults import Changes, Context
from seatsim.blind.truth.rig import RigMotion
from seatsim.schema.arrays import Array

MATERIAL_SHARE = 0.05
"""Of a channel's spread (contract, section 4)."""
_NOISE_FACTOR = 3.0
"""A channel is compared where its spread is at least so many times its noise (contract, section 4)."""
LEFT_OUT = 1.0
"""Seconds at the start of each run that no gap counts (contract, section 4)."""
COARSE_STEP = 2.5e-4
"""Step of the simulations that only measure sizes, s: two and a half times as fast as those that are recorded."""
_REMEMBERED = 6
"""Sets of motions that are kept beside the first, which is that of the rig without the fault."""
SECONDS = 12.0
"""Of each run that are looked at: half of it, as every parameter costs a simulation."""
_NEGLIGIBLE = 0.2
"""Materiality below which a fault is not material whatever a refit takes away."""
EXACT = ("is_bingham", "n", "i_max", "damper_ratio")
"""Parameters that are choices, not measurements, and are never off."""


def zero_scales(nominal: Mapping[str, float]) -> dict[str, float]:
    """Return what a relative error refers to where the nominal value is zero (contract, section 3)."""
    return {"k0": nominal["kf"], "x0": 0.01, "f0": 100.0}


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

    def simulate(self, changes: Changes) -> list[RigMotion]:
        """Return the motion of each run; sensor faults do not change it, so one simulation serves all of those."""
        key = repr((sorted(changes.parameters.items()), changes.frame_forces))
        if key not in self.known:
            if len(self.known) > _REMEMBERED:
                self.known.pop(list(self.known)[1])
            self.known[key] = [
                simulate_run(self.experiment, changes, k, command, step=COARSE_STEP)
                for k, command in enumerate(self.commands)
            ]
        return self.known[key]

    def read(self, changes: Changes) -> list[Readings]:
        """Return what the channels show in each run, without noise."""
        return [read_channels(self.experiment, changes, k, motion) for k, motion in enumerate(self.simulate(changes))]

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
            if spread < _NOISE_FACTOR * noise:
                continue
            response[name] = with_it - self._pooled(rest, name)
            if replayed is not None:
                response[name] -= replayed[name]
            limits[name] = max(MATERIAL_SHARE * spread, noise)
        return response, limits

    def _response_of_replay(self, fault: Changes, others: Changes, shown: list[Readings]) -> dict[str, Array]:
        """Return what faulty inputs move in a replay, by compared channel."""
        clean = Changes(others.parameters, others.frame_forces)
        on_floor = any(f.channel == "floor_acceleration" for f in fault.sensor_faults)
        new = []
        for k, run in enumerate(shown):
            floor = run["floor_acceleration"] if on_floor else None
            motion = simulate_run(self.experiment, clean, k, run["current_command"], floor, COARSE_STEP)
            new.append(read_channels(self.experiment, clean, k, motion))
        old = self.read(clean)
        return {name: self._pooled(new, name) - self._pooled(old, name) for name in self.experiment.compared}

    def _pooled(self, runs: list[Readings], name: str) -> Array:
        """Return a channel over all runs, without the rows that no gap counts."""
        left_out = round(LEFT_OUT * self.experiment.sample_rate)
        return np.concatenate([run[name][left_out:] for run in runs])


def rms(values: Array) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(values**2)))


def collinearity(a: Array, b: Array) -> float:
    """Return `|a b| / (|a| |b|)` of two responses, 0..1."""
    size = float(np.linalg.norm(a) * np.linalg.norm(b))
    return abs(float(a @ b)) / size if size else 0.0


class ToleranceRefit:
    """Sensitivities of the compared channels to each parameter of an experiment, one tolerance up."""

    def __init__(self, experiment: Experiment, commands: list[Array]) -> None:
        rows = round(SECONDS * experiment.sample_rate)
        self.runs = CommandedRuns(experiment, [command[:rows] for command in commands])
        scales = zero_scales(experiment.nominal)
        self.sensitivities: list[dict[str, Array]] = []
        for name, value in experiment.nominal.items():
            step = experiment.tolerance * (value or scales.get(name, 0.0))
            if name not in EXACT and step:
                sensitivity, _ = self.runs.response(Changes({name: experiment.true[name] + step}), Changes())
                self.sensitivities.append(sensitivity)

    def unexplained_share(self, fault: Changes, others: Changes) -> float:
        """Return which share of a fault's materiality no refit inside the tolerance takes away, 0..1 or a little more.

        The refit minimises the sum over all channels, so the largest of them may grow. Channels that a sensitivity has
        not, because it does not stand above noise there, take no part.
        """
        response, limits = self.runs.response(fault, others)
        names = [name for name in response if all(name in column for column in self.sensitivities)]
        if not names:
            return 1.0
        g = np.concatenate([response[name] / limits[name] for name in names])
        before = max(rms(response[name] / limits[name]) for name in names)
        if not np.all(np.isfinite(g)) or before < _NEGLIGIBLE:
            return 1.0
        columns = [np.concatenate([c[name] / limits[name] for name in names]) for c in self.sensitivities]
        left = np.split(refit_residuals(columns, g), len(names))
        return max(rms(part) for part in left) / before


def refit_residuals(columns: Sequence[Array], g: Array) -> Array:
    """Return `g - J theta` at its least norm with `|theta| <= 1`, where J has these columns; g where there are none.

    Solved on the triangular factor of `[J g]`, which has the same minimum with a row per column.
    """
    if not columns:
        return g
    J = np.column_stack(columns)
    triangle = np.asarray(np.linalg.qr(np.column_stack([J, g]), mode="r"))
    return np.asarray(g - J @ lsq_linear(triangle[:, :-1], triangle[:, -1], (-1.0, 1.0)).x)


def context_of(experiment: Experiment, readings: Sequence[Readings]) -> Context:
    """Return what fault scenarios may know, from the readings of the rig without them."""
    pooled = {name: np.concatenate([run[name] for run in readings]) for name in CHANNELS}
    driver, mass = pooled["driver_acceleration"], experiment.nominal["m"]
    spread = {name: float(np.std(values)) for name, values in pooled.items()}
    x_peak = float(np.max(np.abs(pooled["suspension_displacement"])))
    y_peak, tension_peak = mass * float(np.max(driver)) / experiment.nominal["kc"], mass * float(np.max(-driver))
    return Context(spread, x_peak, y_peak, tension_peak, experiment.channels, experiment.is_bingham)


class FaultlessRig:
    """A drawn rig, and what measures faults on it; it stays the same whatever is drawn to be wrong with it."""

    def __init__(self, experiment: Experiment) -> None:
        self.experiment = experiment
        recorded = range(len(experiment.runs) - 1)
        motions = [simulate_run(experiment, Changes(), k, step=COARSE_STEP) for k in recorded]
        self.runs = CommandedRuns(experiment, [motion.command for motion in motions])
        self.context = context_of(experiment, [read_channels(experiment, Changes(), k, motions[k]) for k in recorded])

    @cached_property
    def refit(self) -> ToleranceRefit:
        """What the nominal's tolerance explains of a fault."""
        return ToleranceRefit(self.experiment, self.runs.commands)
