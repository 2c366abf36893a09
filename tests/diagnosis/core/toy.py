"""A linear rig with a known answer: its outputs are sums of fixed signals, so that nothing is simulated or compiled.

`measured = nominal + sum deviation_k nuisance_k + sum amount_j signal_j + noise`, by run and channel.
"""

from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from seatsim.dampers.bingham import Bingham
from seatsim.diagnosis.candidates import Candidate
from seatsim.diagnosis.noise import NoiseWeights, weigh_uniformly
from seatsim.diagnosis.objective import PRIOR_STD, Objective
from seatsim.diagnosis.problem import DiagnosisProblem
from seatsim.diagnosis.settings import DiagnosisSettings
from seatsim.effects.base import EffectSpecification
from seatsim.excitations.base import Floor
from seatsim.recordings.nuisance import Nuisance
from seatsim.recordings.recording import ChannelEntry, Header, Recording, RunEntry
from seatsim.rig.coil import Coil
from seatsim.rig.temperature import TemperatureFactors
from seatsim.scenario.scenario import DamperChoice, Scenario, Solver
from seatsim.schema.registry import register
from seatsim.simulation.inputs import SeatInputs

from ..builders import SerialExecutor
from ..builders import place as place
from ..builders import weigh_stated as weigh_stated

RATE = 200.0
CHANNELS = ("frame_acceleration", "driver_acceleration")
NOISE = np.array([0.1, 0.02])
OFF_LIMIT = 1e3


def toy_effect(name, off=None):
    """Register a record under a kind of its own, so that no listing of real effects sees it."""
    return register("toy effect", name, EffectSpecification("", (), off or {}, (), lambda damper: True, False))


@toy_effect("toy.added")
class Added(NamedTuple):
    """Adds a signal, and another one beside it, in proportion."""

    signal: str
    amount: float = 0.0
    second: float = 0.0

    def outputs(self, signals):
        beside = self.second * signals[f"{self.signal} beside"] if self.second else 0.0
        return self.amount * signals[self.signal] + beside


@toy_effect("toy.stated")
class Stated(NamedTuple):
    """Adds a signal by as much as its amount exceeds 0.6, which the nominal rig has."""

    signal: str
    amount: float = 0.0

    def outputs(self, signals):
        return (self.amount - 0.6) * signals[self.signal]


@toy_effect("toy.cubed")
class Cubed(NamedTuple):
    """Adds a signal with the cube of its amount, on which a whole Gauss-Newton step goes too far."""

    signal: str
    amount: float = 0.0

    def outputs(self, signals):
        return self.amount**3 * signals[self.signal]


@toy_effect("toy.limited", {"limit": OFF_LIMIT})
class Limited(NamedTuple):
    """Adds what exceeds a limit, which is less the larger the limit is."""

    signal: str
    limit: float = OFF_LIMIT

    def outputs(self, signals):
        return max(0.0, 2.0 - self.limit) * signals[self.signal]


@toy_effect("toy.edge")
class Edge(NamedTuple):
    """Adds a signal up to an amount of 1, beyond which the rig leaves all bounds."""

    signal: str
    amount: float = 0.0

    def outputs(self, signals):
        return self.amount * signals[self.signal] if self.amount <= 1.0 else np.full_like(signals["nominal"], np.inf)


@dataclass(frozen=True)
class LinearProblem(DiagnosisProblem):
    """A problem whose rig is linear; `signals[run][name]` has shape (channels, samples), `calls` lists simulations.

    The floor's acceleration and a force on the frame enter the channels by `floor_gain` and `force_gain`.
    """

    signals: dict = field(default_factory=dict)
    floor_gain: tuple = (0.0, 0.0)
    force_gain: tuple = (0.0, 0.0)
    calls: list = field(default_factory=list)

    def simulated(self, run, deviations, effects, inputs=None):
        self.calls.append((run, tuple(deviations), tuple(effects)))
        signals = self.signals[run]
        outputs = signals["nominal"] + sum(d * signals[f"nuisance {k}"] for k, d in enumerate(deviations))
        outputs = outputs + sum(effect.outputs(signals) for effect in effects)
        return outputs if inputs is None else outputs + self._driven(run, inputs)

    def _driven(self, run, inputs):
        """Return what inputs other than the recorded ones add, read at the rows that are compared."""
        samples = self.measured[run].shape[1]

        def read(values):
            return values[:: self.parts][self.skip : self.skip + samples]

        floor = read(inputs.floor.acceleration - self.inputs[run].floor.acceleration)
        added = np.outer(self.floor_gain, floor)
        return added + np.outer(self.force_gain, read(inputs.forces.frame)) if len(inputs.forces.frame) else added


def make_recording(runs, noise=NOISE, floor_noise=0.0, repeats=None):
    """Return a recording that holds no tables."""
    stated = dict(zip(CHANNELS, noise, strict=True)) | {"floor_acceleration": floor_noise}
    channels = {name: ChannelEntry("m/s^2", value) for name, value in stated.items()}
    entries = {run: RunEntry(run, f"{run}.csv", (repeats or {}).get(run)) for run in runs}
    return Recording(Path("toy"), Header("seat", RATE, "nominal.yaml"), entries, channels, None)


def make_scenario(steps_per_row=2):
    return Scenario(
        "toy", DamperChoice(Bingham(), TemperatureFactors()), Coil(), 20.0, solver=Solver(1.0 / RATE / steps_per_row)
    )


def make_problem(signals, measured, nuisances=0, settings=None, **kept):
    """Return a linear problem; `kept` are fields of it, `noise`, `floor_noise` and `repeats` those of its recording."""
    stated = {key: kept.pop(key) for key in ("noise", "floor_noise", "repeats") if key in kept}
    recording, scenario = make_recording(tuple(signals), **stated), make_scenario()
    rows = {run: round(RATE) + values.shape[1] + 1 for run, values in measured.items()}
    still = {run: np.zeros(2 * count) for run, count in rows.items()}
    inputs = {run: SeatInputs(Floor(scenario.solver.step, x, x, x), 1.0 / RATE) for run, x in still.items()}
    parameters = tuple(Nuisance("damper", name, 1.0, 0.1) for name in ("c_a", "fc_a", "f0")[:nuisances])
    return LinearProblem(
        recording, scenario, tuple(signals), CHANNELS, measured, inputs, parameters, settings or DiagnosisSettings(),
        SerialExecutor(), signals=signals, **kept,
    )  # fmt: skip


def draw_signals(names, runs=None, seed=0):
    """Return random signals of standard deviation 1 by run and name, shape (channels, samples)."""
    rng = np.random.default_rng(seed)
    samples = runs or {"first": 120, "second": 160, "third": 200}
    return {run: {name: rng.standard_normal((2, count)) for name in names} for run, count in samples.items()}


def add_up(signals, amounts, noise=NOISE, seed=1):
    """Return what is measured by run: the nominal signal, others by their amounts, and noise."""
    rng = np.random.default_rng(seed)
    return {
        run: own["nominal"]
        + sum(amount * own[name] for name, amount in amounts.items())
        + np.asarray(noise)[:, None] * rng.standard_normal(own["nominal"].shape)
        for run, own in signals.items()
    }


def offer(effect, signal=None, start=1.0, low=-10.0, high=10.0, cls=Added):
    """Return a candidate with one free parameter, that adds the signal of its name where none is given."""
    free = "limit" if cls is Limited else "amount"
    return Candidate(effect, cls, {"signal": signal or effect}, (free,), (start,), (low,), (high,))


def offer_two(effect, start, low, high):
    """Return a candidate with two free parameters."""
    return Candidate(effect, Added, {"signal": effect}, ("amount", "second"), start, low, high)


def tone(samples, cycles, rms):
    """Return a sine of a whole number of cycles with an RMS by channel, shape (channels, samples)."""
    phase = 2.0 * np.pi * cycles * np.arange(samples) / samples
    return np.outer(rms, np.sqrt(2.0) * np.sin(phase))


def pose_tones(sizes, noise, runs, planted=None):
    """Return an objective whose signals are tones that have nothing in common; what is measured has the spread 1.

    Args:
        sizes: RMS of each signal by channel.
        noise: stated noise of the channels; none is added.
        runs: samples by run.
        planted: names of the signals that are measured, all where absent.
    """
    planted = list(sizes) if planted is None else planted
    rest = np.sqrt(1.0 - sum((np.square(sizes[name]) for name in planted), np.zeros(2)))
    signals = {}
    for run, samples in runs.items():
        own = {name: tone(samples, 3 + k, rms) for k, (name, rms) in enumerate(sizes.items())}
        signals[run] = own | {"nominal": tone(samples, 20, rest), "nuisance 0": tone(samples, 30, (1.0, 1.0))}
    measured = {run: sum(own[name] for name in ["nominal", *planted]) for run, own in signals.items()}
    problem = make_problem(signals, measured, nuisances=1, noise=noise)
    compared = weigh_uniformly(problem, np.ones(2)).power
    return Objective(problem, NoiseWeights({run: np.ones_like(each) for run, each in compared.items()}))


def whiten(objective, name):
    """Return a signal's whitened numbers of all runs, stacked, shape (numbers,)."""
    problem = objective.problem
    return np.concatenate([objective.weights(problem.signals[run][name], run).ravel() for run in problem.runs])


def stack(objective, names):
    """Return the least-squares problem (matrix, target) of nuisances and named signals, with the rows of the prior.

    Its unknowns are deviations and amounts, its residual's square is the cost.
    """
    problem = objective.problem
    count, prior = len(problem.parameters), 1.0 / PRIOR_STD
    columns = [whiten(objective, f"nuisance {k}") for k in range(count)] + [whiten(objective, name) for name in names]
    gap = [
        objective.weights(problem.measured[run] - problem.signals[run]["nominal"], run).ravel() for run in problem.runs
    ]
    rows = np.hstack([prior * np.eye(count), np.zeros((count, len(names)))])
    return np.vstack([np.array(columns).T, rows]), np.concatenate([*gap, np.zeros(count)])
