"""The error of a scenario against its uncertainty, after ASME V&V 20: on one run, and over the runs of a recording.

For each channel the comparison error E = RMS of simulation less data is set against the validation uncertainty

    u_val^2 = u_num^2 + u_input^2 + u_D^2,    model form = sqrt(max(E^2 - u_val^2, 0)),

with u_num from halving the step of the integration, u_input from the noise of the recorded inputs carried through the
simulation, and u_D the stated noise of the channel; all are RMS values over the run (ASME V&V 20-2009).
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline, UnivariateSpline

from seatsim.metrics.motion import rms
from seatsim.recordings.nuisance import list_varied, vary
from seatsim.recordings.recording import COMMANDS, Recording
from seatsim.recordings.replay import COMPARED, recorded_inputs, replay_table, select_compared
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.content import written
from seatsim.simulation.inputs import BenchInputs
from seatsim.simulation.respond import respond

_Table = Mapping[str, Array]

_LINEAR = ("coil_current", "damper_temperature")
"""Inputs of a bench that are linear between rows; commands are held."""
_REPLICATES = 3
"""Simulations with newly drawn noise of the inputs."""


class ErrorBudget(NamedTuple):
    """Comparison error of a channel and its parts as in ASME V&V 20, RMS over a run in `unit`."""

    channel: str
    unit: str
    comparison_error: float
    u_num: float
    u_input: float
    u_d: float
    model_form: float


def budget_errors(scenario: Scenario, recording: Recording, run: str, channels: Iterable[str]) -> list[ErrorBudget]:
    """Return the error budget of channels of a run.

    Raises:
        RunError: a simulation could not be carried to its end.
    """
    scenario = recording.scenario_of(run, scenario)
    table = recording.table(run)
    simulated = replay_table(scenario, recording, table)
    measured = select_compared(table, recording.header.rig, recording.header.sample_rate)
    numerical = measure_step_error(scenario, recording, table)
    carried = carry_input_noise(scenario, recording, table)
    budgets = []
    for name in channels:
        entry, error = recording.channels[name], rms(measured[name] - simulated[name])
        parts = numerical[name], carried[name], entry.noise_rms
        left = error**2 - parts[0] ** 2 - parts[1] ** 2 - parts[2] ** 2
        budgets.append(ErrorBudget(name, entry.unit, error, *parts, float(np.sqrt(max(left, 0.0)))))
    return budgets


def measure_step_error(scenario: Scenario, recording: Recording, table: _Table) -> dict[str, float]:
    """Return the RMS change of each output as the step of the integration is halved.

    A method of order p leaves 1 / (2^p - 1) of that; friction and stops make p one at worst, hence the whole change.
    """
    rig, rate = recording.header.rig, recording.header.sample_rate
    inputs = recorded_inputs(recording, table, scenario.solver.step)
    if isinstance(inputs, BenchInputs):
        coarse, fine = _smooth_motion(inputs, 1), _smooth_motion(inputs, 2)
        pair = respond(scenario, coarse), {name: values[::2] for name, values in respond(scenario, fine).items()}
    else:
        half = recorded_inputs(recording, table, 0.5 * inputs.floor.step)
        pair = respond(scenario, inputs), respond(scenario, half)
    first, second = (select_compared(outputs, rig, rate) for outputs in pair)
    return {name: rms(first[name] - second[name]) for name in first}


def _smooth_motion(inputs: BenchInputs, parts: int) -> BenchInputs:
    """Return a bench's inputs with so many rows for one, on the motion that their noise lets see."""
    rows = np.arange(len(inputs.displacement), dtype=np.float64)
    finer = np.arange(parts * (len(rows) - 1) + 1, dtype=np.float64) / parts
    motion = UnivariateSpline(rows, inputs.displacement, k=5, s=len(rows) * inputs.displacement_noise**2)

    given: dict[str, Any] = {name: each for name, each in inputs._asdict().items() if isinstance(each, np.ndarray)}
    finely = {name: given[name][finer.astype(int)] for name in COMMANDS if name in given}
    finely |= {name: np.interp(finer, rows, given[name]) for name in _LINEAR if name in given}
    finely |= {"velocity": CubicSpline(rows, given["velocity"])(finer)} if "velocity" in given else {}
    finely |= {"displacement": motion(finer), "displacement_noise": 0.0, "interval": inputs.interval / parts}
    return inputs._replace(**finely)


def carry_input_noise(scenario: Scenario, recording: Recording, table: _Table) -> dict[str, float]:
    """Return the RMS change of each output as newly drawn noise is added to the recorded inputs."""
    # The same draws for every recording: equal input gives equal output.
    rng = np.random.default_rng(0)
    clean = replay_table(scenario, recording, table)
    noisy = [replay_table(scenario, recording, _add_noise(recording, table, rng)) for _ in range(_REPLICATES)]
    squares = {name: [np.mean((other[name] - values) ** 2) for other in noisy] for name, values in clean.items()}
    return {name: float(np.sqrt(np.mean(each))) for name, each in squares.items()}


def _add_noise(recording: Recording, table: _Table, rng: np.random.Generator) -> dict[str, Array]:
    """Return a table with noise added to what drives the simulation: a coil current only in place of a command."""
    outputs = set(COMPARED[recording.header.rig])
    if not any(name in table for name in COMMANDS):
        outputs -= {"coil_current"}
    levels = {name: recording.channels[name].noise_rms for name in table if name not in outputs}
    drawn = {name: level * rng.standard_normal(len(table[name])) for name, level in levels.items()}
    return {name: values + drawn[name] if name in drawn else values for name, values in table.items()}


_STEP = 0.1
"""Share of its tolerance by which a parameter is moved; the change is linear that far."""
_STANDARD = 1.0 / math.sqrt(3.0)
"""Standard uncertainty of a parameter over its tolerance, within which any value is equally likely."""


class Validation(NamedTuple):
    """Comparison error of a channel and the standard uncertainties that it is set against, RMS values in `unit`."""

    unit: str
    error: float
    u_num: float
    u_input: float
    u_d: float

    @property
    @written()
    def u_val(self) -> float:
        """`sqrt(u_num^2 + u_input^2 + u_d^2)`; an error that is not above it says nothing against the model."""
        return math.sqrt(self.u_num**2 + self.u_input**2 + self.u_d**2)


def validate(
    scenario: Scenario, recording: Recording, runs: Sequence[str], channels: Sequence[str]
) -> dict[str, Validation]:
    """Return the comparison error and the validation uncertainty of channels over all samples of runs.

    With E = S - D of each sample, simulation less data, RMS values over the samples in the unit of the channel are

        error = rms(E),    u_val^2 = u_num^2 + u_input^2 + u_d^2.

    u_num is what halving the step of the integration changes. u_input is what the noise of the recorded inputs and the
    tolerances of the parameters change: each parameter moved by 1/sqrt(3) of its tolerance to first order, the squares
    added; one that was fitted has no tolerance. u_d is the stated noise of the sensor. |error| beyond u_val is of the
    model (ASME V&V 20-2009, recalled).

    Raises:
        RunError: a simulation could not be carried to its end.
    """
    squares, rows = [], []
    for run in runs:
        tolerated = _carry_tolerances(scenario, recording, run)
        budgets = budget_errors(scenario, recording, run, channels)
        inputs = [each.u_input**2 + tolerated[each.channel] for each in budgets]
        pairs = zip(budgets, inputs, strict=True)
        squares.append([(each.comparison_error**2, each.u_num**2, of_inputs, each.u_d**2) for each, of_inputs in pairs])
        measured = select_compared(recording.table(run), recording.header.rig, recording.header.sample_rate)
        rows.append(len(measured[channels[0]]))
    pooled = np.sqrt(np.average(squares, axis=0, weights=rows))
    units = [recording.channels[name].unit for name in channels]
    return {name: Validation(unit, *row) for name, unit, row in zip(channels, units, pooled.tolist(), strict=True)}


def _carry_tolerances(scenario: Scenario, recording: Recording, run: str) -> dict[str, float]:
    """Return the mean square of what the tolerances of all parameters together change in each output of a run."""
    table, parameters = recording.table(run), list_varied(recording.header, scenario, fitted=0.0)

    def replay_moved(deviations: Array) -> dict[str, Array]:
        return replay_table(recording.scenario_of(run, vary(scenario, parameters, deviations)), recording, table)

    base = replay_moved(np.zeros(len(parameters)))
    moved = [replay_moved(row) for row in _STEP * np.eye(len(parameters))]
    change = _STANDARD / _STEP
    return {name: sum(rms(change * (each[name] - values)) ** 2 for each in moved) for name, values in base.items()}
