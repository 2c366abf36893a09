"""Candidate experiments that could be run next on a rig, cheapest first, and the best excitation among them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize

from seatsim.diagnosis.problem import DiagnosisProblem
from seatsim.excitations.base import EXCITATIONS as REGISTERED
from seatsim.excitations.base import Floor
from seatsim.recordings.recording import CURRENTS
from seatsim.scenario.numbers import list_numbers
from seatsim.schema.arrays import Array
from seatsim.schema.fields import read_packaged
from seatsim.simulation.inputs import SeatInputs

_Keys = Mapping[str, str | float]
_NOTHING: Mapping[str, float] = MappingProxyType({})

_SWITCHING = 0.25
"""s; time between changes of a switched current: long compared with a coil's lag, short compared with the motion."""
_NEARLY_FULL = 0.9
"""Share of the largest current that is switched, so that no supply is at its limit."""
_WARM_UP = (20.0, 60.0)
"""degC at the start and at the end of a run in which the damper warms up."""
_ADDED_MASS = 20.0
"""kg; mass added in the driver's seat."""
_CURRENT = "controller.current"
"""The number of a scenario that a run without current changes where the current is not recorded."""


class CandidateExperiment(NamedTuple):
    """What drives the rig, sensors added to it, and what is changed of it.

    An excitation has a `scenario`, its sections in a file; `set` is what a recording states of such a run.
    """

    name: str
    text: str
    floor: Floor
    added_sensors: tuple[str, ...] = ()
    set: Mapping[str, float] = _NOTHING
    scenario: Mapping[str, _Keys] | None = None


class _Excitation(NamedTuple):
    """An excitation of the menu: its text, control law, keys, and which of those keys may be optimised."""

    text: str
    law: _Keys
    keys: _Keys
    free: tuple[str, ...]


EXCITATIONS = read_packaged(Path(__file__).with_name("excitations.yaml"), dict[str, _Excitation])
"""The menu; currents are shares of the largest current."""


def list_candidate_experiments(problem: DiagnosisProblem) -> Iterator[CandidateExperiment]:
    """Yield the experiments, cheapest first: excitations with the rig as it is, then changes of the rig."""
    yield from (excite(problem, name) for name in EXCITATIONS if not (problem.bench and name == "bump"))
    yield from _intervene(problem, _recorded_floor(problem))


def excite(problem: DiagnosisProblem, name: str, factors: Mapping[str, float] = _NOTHING) -> CandidateExperiment:
    """Return an excitation of the menu with its law and currents, as a floor and as sections of a scenario.

    `factors` change some of its free keys; no current exceeds the largest.
    """
    item = EXCITATIONS[name]
    keys, law = (
        {key: value if isinstance(value, str) else value * factors.get(key, 1.0) for key, value in each.items()}
        for each in (item.keys, item.law)
    )
    text = item.text.format(**keys, mm=1000.0 * float(keys.get("height", keys.get("amplitude", 0.0))))
    own = {key: value for key, value in keys.items() if key != "kind"}
    floor = REGISTERED.find(str(keys["kind"]))(**own).floor(problem.scenario.solver.step, 0)
    top = problem.scenario.coil.max_current
    law = {key: value if isinstance(value, str) else top * min(value, 1.0) for key, value in law.items()}
    switched = float(law.get("on", 0.0)) * (np.floor(floor.time / _SWITCHING) % 2.0)
    command = switched if "on" in law else np.full(len(floor.time), law["current"])
    scenario = {"controller": law, "excitation": keys}
    text = text.replace("the floor", "the damper") if problem.bench else text
    return CandidateExperiment(name, text, floor._replace(command=command), scenario=scenario)


def _intervene(problem: DiagnosisProblem, floor: Floor) -> Iterator[CandidateExperiment]:
    """Yield changes of the rig, its sensors or its temperature, with the floor motion of a recorded run or none."""
    rest, time = np.zeros(len(floor.acceleration)), floor.time
    steps = _NEARLY_FULL * problem.scenario.coil.max_current * (np.floor(time / _SWITCHING) % 2.0)
    still = Floor(floor.step, rest, rest, rest, steps)
    if "coil_current" not in problem.channels:
        text = "repeat a run and log the current of the coil"
        yield CandidateExperiment("coil_current", text, floor, ("coil_current",))
    without = floor._replace(command=rest, coil_current=rest)
    is_recorded = not set(CURRENTS).isdisjoint(problem.recording.channels)
    # A current that is neither recorded nor stated, as that of a passive damper, cannot be switched off.
    if is_recorded or _CURRENT in list_numbers(problem.scenario):
        off = {} if is_recorded else {_CURRENT: 0.0}
        yield CandidateExperiment("zero_current", "repeat a run without current", without, set=off)
    low, high = _WARM_UP
    warming = floor._replace(temperature=low + (high - low) * time / time[-1])
    yield CandidateExperiment("warm_up", "repeat a run while the damper warms from 20 to 60 degC", warming)
    plant = problem.scenario.plant
    if plant is not None and not problem.bench:
        yield CandidateExperiment("locked_seat", "lock the seat and switch the current every 0.25 s", still)
        text = "repeat a run with 20 kg more on the driver's place"
        yield CandidateExperiment("added_mass", text, floor, set={"plant.driver_mass": plant.driver_mass + _ADDED_MASS})
    if "damper_force" not in problem.channels:
        text = "repeat a run with a load cell at the damper"
        yield CandidateExperiment("load_cell", text, floor, ("damper_force",))


def _recorded_floor(problem: DiagnosisProblem) -> Floor:
    """Return the excitation of the first run: the floor's motion or, on a bench, the damper's."""
    inputs = problem.inputs[problem.runs[0]]
    if isinstance(inputs, SeatInputs):
        return inputs.floor
    still, moved = np.zeros(len(inputs.displacement)), inputs.displacement
    command = inputs.current_command
    if inputs.command_voltage is not None and inputs.voltage_gain is not None:
        command = inputs.voltage_gain * inputs.command_voltage
    return Floor(1.0 / problem.rate, still, still, moved, command, inputs.coil_current, inputs.damper_temperature)


_FIRST_STEP = 0.6
"""First step of the search in the natural logarithm of a key: a factor of 1.8."""
_LARGEST_FACTOR = 2.4
"""Largest factor on a key, either way: the sweep then ends below 50 Hz, which a step of 2 ms resolves."""
_TRIALS = 16
"""Most excitations that are tried, about four for each free key."""


def optimise_excitation(problem: DiagnosisProblem, name: str, score: Callable[[CandidateExperiment], float]) -> None:
    """Search the free keys of an excitation for the least score, by Nelder and Mead's simplex in their logarithms.

    Args:
        problem: the recording, whose coil bounds the current.
        name: of the excitation in the menu.
        score: called with every excitation that is tried; it keeps the best.
    """
    free, largest = EXCITATIONS[name].free, np.log(_LARGEST_FACTOR)

    def score_at(logarithms: Array) -> float:
        return score(excite(problem, name, dict(zip(free, np.exp(logarithms).tolist(), strict=True))))

    corners = np.vstack([np.zeros(len(free)), _FIRST_STEP * np.eye(len(free))])
    minimize(
        score_at,
        corners[0],
        method="Nelder-Mead",
        bounds=[(-largest, largest)] * len(free),
        options={"maxfev": _TRIALS, "initial_simplex": corners},
    )
