"""A seat whose channels are short filters of its inputs, in place of the simulator: every answer is known.

`channels = sum over causes of (taps of the cause) * (its signal)`: the floor, forces, a current, deviations of the
plant's parameters and effects, each with its own taps by channel. Real effects act where their class is listed.
"""

from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Annotated, NamedTuple

import numpy as np

from seatsim.diagnosis.candidates import Candidate
from seatsim.diagnosis.localise.input_estimate import PORTS, Reconstruction
from seatsim.diagnosis.problem import pose_problem
from seatsim.diagnosis.settings import DiagnosisSettings
from seatsim.effects.base import EffectSpecification
from seatsim.effects.damper import GasSpring, SealFriction
from seatsim.effects.seat import Biodynamics, Friction, ProgressiveSpring
from seatsim.recordings.nuisance import Nuisance
from seatsim.recordings.recording import ChannelEntry, Header, Recording, RunEntry
from seatsim.recordings.replay import recorded_inputs
from seatsim.scenario.loading import single
from seatsim.schema.errors import RunError
from seatsim.schema.fields import param
from seatsim.schema.registry import register
from seatsim.simulation.augment import augment_plant, read_sensors
from seatsim.simulation.respond import SEAT_OUTPUTS

from ...text import beside
from ..builders import SerialExecutor, place
from ..builders import weigh_stated as weigh_stated

RATE, SKIP = 200.0, 200
CHANNELS = SEAT_OUTPUTS
UNITS = ("m/s^2", "m/s^2", "m", "N", "A")
SIZES = np.array([1.0, 1.0, 0.01, 100.0, 0.5])
"""Natural size of each channel, in which noise and taps are stated here."""
NOMINAL = beside(__file__, "toy_nominal.yaml")
TAPS = {
    "floor": [[0.8, 0.4], [0.6, 0.5], [-0.7, 0.4], [0.5, -0.3], [0.0, 0.0]],
    "frame force": [[0.02, 0.01], [0.004, 0.006], [0.02, 0.01], [0.004, 0.002], [0.0, 0.0]],
    "driver force": [[0.004, 0.003], [0.012, 0.003], [0.001, 0.01], [0.001, -0.002], [0.0, 0.0]],
    "current": [[0.1, 0.2], [0.0, 0.1], [0.1, 0.1], [3.0, 0.0], [2.0, 0.0]],
    "mass": [[0.5, -0.5], [-1.0, 0.2], [0.3, 0.0], [0.1, 0.0], [0.0, 0.0]],
    "stiffness": [[1.0, 0.5], [0.4, 0.2], [-0.2, 0.6], [0.2, 0.0], [0.0, 0.0]],
    "one": [[0.3, 0.0], [0.1, 0.2], [0.2, -0.1], [0.4, 0.0], [0.0, 0.0]],
    "two": [[0.0, 0.3], [0.2, -0.2], [0.1, 0.3], [0.0, 0.3], [0.0, 0.0]],
    "three": [[-0.2, 0.1], [0.3, 0.0], [0.0, 0.1], [0.1, 0.2], [0.0, 0.0]],
    "frame alone": [[0.4, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]],
    "driver alone": [[0.0, 0.0], [0.4, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]],
    # On a slow floor these two are the same; where it is fast, the second has the other sign.
    "slow": [[0.4, 0.4], [0.2, 0.2], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]],
    "fast": [[0.8, 0.0], [0.4, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]],
}
"""By cause, the share of the channel's size that its signal, now and a row ago, adds to each channel."""
STAND_INS = {
    SealFriction: ("force", "one", 0.01),
    Friction: ("force", "two", 0.01),
    GasSpring: ("stiffness", "slow", 1e-3),
    ProgressiveSpring: ("rise", "fast", 1e-3),
    Biodynamics: ("share", "one", 1.0),
}
"""Real effects that act here: the field, the cause that it feeds, and by how much."""
BENT = {Biodynamics: "three"}
"""Real effects that feed a second cause by the square of that, so that what they do depends on their size."""
NUISANCES = (Nuisance("plant", "driver_mass", 80.0, 8.0), Nuisance("plant", "suspension_stiffness", 4600.0, 460.0))
TOLERANCE = 0.1


class Added(NamedTuple):
    """Adds the signal of a cause."""

    cause: str
    amount: Annotated[float, param("N", "amount")] = 0.0


class AddedTwice(NamedTuple):
    """Adds the signals of two causes, and acts on a channel in name."""

    channel: str
    first: Annotated[float, param("kg", "amount of `one`")] = 0.0
    second: Annotated[float, param("m", "amount of `two`")] = 0.0


class Diverging(NamedTuple):
    """Makes the rig leave all bounds."""

    amount: Annotated[float, param("-", "amount")] = 0.0


for _cls in (Added, AddedTwice, Diverging):
    # A kind of its own, so that no listing of real effects sees it.
    register("toy effect of stages", _cls.__name__, EffectSpecification("", (), {}, (), lambda damper: True, False))(
        _cls
    )


@dataclass(frozen=True)
class TabledRecording(Recording):
    """A recording whose tables are in memory."""

    tables: dict = field(default_factory=dict)

    def table(self, run):
        return dict(self.tables[run])


def add_taps(cause, signal):
    """Return what the signal of a cause adds to each channel, shape (channels, rows)."""
    before = np.concatenate([[0.0], signal[:-1]])
    return np.array([size * (a * signal + b * before) for size, (a, b) in zip(SIZES, TAPS[cause], strict=True)])


def respond_to_taps(cause, samples):
    """Return the frequency response of all channels to a cause, shape (channels, samples // 2 + 1)."""
    late = np.exp(-2j * np.pi * np.arange(samples // 2 + 1) / samples)
    return np.array([size * (a + b * late) for size, (a, b) in zip(SIZES, TAPS[cause], strict=True)])


def respond_linearly(scenario, inputs):
    """Answer as `seatsim.simulation.respond.respond` does, by the sum of all causes."""
    steps = round(inputs.interval / inputs.floor.step)
    floor = inputs.floor.acceleration[::steps]
    plant = augment_plant(scenario.effects, scenario.plant)
    causes = [("floor", floor), ("mass", (plant.driver_mass / 80.0 - 1.0) * floor)]
    causes += [("stiffness", (plant.suspension_stiffness / 4600.0 - 1.0) * floor)]
    current = next((each for each in (inputs.floor.command, inputs.floor.coil_current) if each is not None), None)
    causes += [] if current is None else [("current", current[::steps])]
    for name, force in zip(("frame force", "driver force"), inputs.forces, strict=True):
        causes += [(name, force[::steps])] if len(force) else []
    for effect in scenario.effects:
        if isinstance(effect, Diverging):
            raise RunError("the toy left all bounds")
        causes += [(cause, amount * floor) for cause, amount in _acting(effect)]
    outputs = sum(add_taps(cause, signal) for cause, signal in causes)
    return read_sensors(scenario.effects, inputs.interval, dict(zip(CHANNELS, outputs, strict=True)))


def _acting(effect):
    if isinstance(effect, Added):
        return [(effect.cause, effect.amount)]
    if isinstance(effect, AddedTwice):
        return [("one", effect.first), ("two", effect.second)]
    if type(effect) not in STAND_INS:
        return []
    name, cause, factor = STAND_INS[type(effect)]
    amount, bent = factor * getattr(effect, name), BENT.get(type(effect))
    return [(cause, amount)] + ([(bent, amount**2)] if bent else [])


def record(folder, truth=(), runs=None, channels=CHANNELS[:2], noise=0.05, repeats=None, commands=None, seed=0):
    """Return a recording of the toy seat with effects that its nominal scenario lacks.

    Args:
        folder: holds the nominal scenario.
        truth: effects by run, or those of every run.
        runs: samples after the first second by run, or the whole acceleration of the floor.
        channels: outputs that are recorded.
        noise: of every channel, in its natural size; drawn and stated.
        repeats: the run that a run repeats.
        commands: commanded current by run, shape (rows,).
        seed: of floor and noise.
    """
    rng = np.random.default_rng(seed)
    nominal, tables = single(folder / "nominal.yaml"), {}
    for run, given in (runs or {"first": 240, "second": 300}).items():
        floor = rng.standard_normal(SKIP + given) if isinstance(given, int) else np.asarray(given)
        table = {"floor_acceleration": floor} | ({"current_command": commands[run]} if commands else {})
        true = replace(nominal, effects=tuple(truth[run] if isinstance(truth, dict) else truth))
        outputs = respond_linearly(true, recorded_inputs(_blank(folder), table, 1.0 / RATE))
        for name, size in zip(CHANNELS, SIZES, strict=True):
            drawn = noise * size * rng.standard_normal(len(floor))
            if name in channels:
                table[name] = outputs[name] + drawn
        tables[run] = table
    entries = {run: RunEntry(run, f"{run}.csv", (repeats or {}).get(run)) for run in tables}
    stated = zip(CHANNELS, UNITS, SIZES, strict=True)
    known = {name: ChannelEntry(unit, noise * size) for name, unit, size in stated if name in channels}
    known["floor_acceleration"] = ChannelEntry("m/s^2", 0.0)
    known |= {"current_command": ChannelEntry("A", 0.0)} if commands else {}
    return TabledRecording(folder, _blank(folder).header, entries, known, None, tables)


def _blank(folder):
    return TabledRecording(folder, Header("seat", RATE, "nominal.yaml", TOLERANCE), {}, {}, None)


def pose(recording, nuisances=2, **changed):
    """Return the problem of a toy recording with some of its nuisance parameters; `changed` are groups of settings."""
    settings = DiagnosisSettings()
    # The damper of the toy cannot be driven alone.
    settings = settings._replace(damper_forms=settings.damper_forms._replace(least_rest=float("inf")))
    settings = settings._replace(**{name: getattr(settings, name)._replace(**own) for name, own in changed.items()})
    return replace(pose_problem(recording, SerialExecutor(), settings), parameters=NUISANCES[:nuisances])


def offer(effect, cause, start=1.0, low=-20.0, high=20.0):
    """Return a candidate that adds the signal of a cause."""
    return Candidate(effect, Added, {"cause": cause}, ("amount",), (start,), (low,), (high,))


def whiten(objective, cause):
    """Return the whitened numbers of one unit of a cause, of all runs on end."""
    problem, parts = objective.problem, []
    rows = [CHANNELS.index(name) for name in problem.channels]
    for run in problem.runs:
        kept = slice(problem.skip, problem.skip + problem.measured[run].shape[1])
        added = add_taps(cause, problem.recording.table(run)["floor_acceleration"])[rows][:, kept]
        parts.append(objective.weights(added, run).ravel())
    return np.concatenate(parts)


def drive(problem, run, port, signal):
    """Return what a signal at a port adds to the channels of a run, shape (channels, samples)."""
    rig = Reconstruction(SimpleNamespace(problem=problem), place(problem), run, port)
    return rig.simulate_with(signal) - rig.simulate_with(np.zeros(rig.samples))


def slow_signal(samples, rms, seed=1, corner=3.0):
    """Return a smooth random signal, such as is plausible of a force; `corner` in Hz."""
    spectrum = np.fft.rfft(np.random.default_rng(seed).standard_normal(samples))
    signal = np.fft.irfft(spectrum / (1.0 + (np.fft.rfftfreq(samples, 1.0 / RATE) / corner) ** 2), samples)
    return rms * signal / np.std(signal)


def plant(objective, port, signals):
    """Return the objective with what signals by run, at a port, add to the measured channels."""
    problem = objective.problem
    added = {run: problem.measured[run] + drive(problem, run, port, signal) for run, signal in signals.items()}
    return replace(objective, problem=replace(problem, measured=problem.measured | added))


def evaluate_nominal(objective):
    return objective.evaluate([place(objective.problem)])[0]


def push(problem, newtons, port):
    """Return what a random force at a port adds by run and channel, another one in each run."""
    added = {}
    for seed, (run, values) in enumerate(problem.measured.items()):
        samples = values.shape[1]
        drawn = np.fft.rfft(np.random.default_rng(seed).standard_normal(samples))
        force = np.fft.irfft(drawn / (1.0 + np.arange(len(drawn)) / 20.0), samples)
        change = drive(problem, run, PORTS[port], newtons * force / np.std(force))
        added[run] = dict(zip(problem.channels, change, strict=True))
    return added


def slow_floor(rows, seed=3):
    """Return a floor that hardly moves from one row to the next, so that `slow` and `fast` are the same."""
    return np.convolve(
        np.cumsum(np.random.default_rng(seed).standard_normal(rows + 40)) / 10.0, np.ones(20) / 20.0, "same"
    )[20:-20]


def make_scenario(problem, nominal, rig):
    """Return a nominal scenario with the parameters and effects of a rig."""
    return problem.augmented(rig.deviations, rig.effects, nominal)
