"""The next experiment: what would tell effects apart that explain a recording equally well.

Every member of the group is fitted to the recording, so that all look alike there. Each entry of a menu is then
simulated with each member, with white noise sigma = hypot(stated noise, TRUST rms) on each channel, and judged by
`collinearity.separability`, in noise units, and `collinearity.likeness` of its worst pair.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.diagnosis.augmented import augmented_content
from seatsim.diagnosis.design.collinearity import (
    PredictedExperiment,
    beside,
    separability,
    shifted,
    likeness,
    stacked,
    with_member,
)
from seatsim.diagnosis.fit import Objective, Parameters, Evaluation
from seatsim.diagnosis.noise import MODEL_ERROR
from seatsim.diagnosis.nuisance import vary
from seatsim.diagnosis.problem import CARRIER, POOL, Problem
from seatsim.effects.base import off
from seatsim.excitations.base import Floor
from seatsim.recordings.compared import COMPARED
from seatsim.recordings.recording import Recording
from seatsim.schema.registry import find
from seatsim.simulation.augment import readings
from seatsim.simulation.bench_replay import replay_bench
from seatsim.simulation.simulate import simulate

Array = NDArray[np.float64]

APART = 30.0
"""Least discrimination, in noise units, of an experiment that is proposed."""
ALIKE = 0.9
"""Alikeness below which the cheapest experiment is taken."""
NOISE = dict(zip(COMPARED["seat"], (0.03, 0.015, 5e-5, 2.5, 0.003), strict=True))
"""Noise of sensors that state none, in the unit of their channel."""


def _tone(frequency: float, amplitude: float, duration: float) -> dict[str, Any]:
    return {"kind": "sine", "amplitude": amplitude, "frequency": frequency, "duration": duration}


STEADY = {"law": "constant", "current": 0.3}
EXCITATIONS: dict[str, tuple[str, dict[str, Any], dict[str, Any]]] = {
    "bump": ("drive over a bump of 50 mm", STEADY, {"kind": "bumps", "shape": "haversine", "height": 0.05,
        "length": 1.0, "speed": 3.0, "duration": 8.0, "through": "direct"}),
    "sweep": ("sweep the floor from 1 to 20 Hz at 1.5 m/s^2", STEADY, {"kind": "chirp", "start_frequency": 1.0,
        "stop_frequency": 20.0, "amplitude": 1.5, "duration": 12.0, "quantity": "acceleration"}),
    "large_slow_sine": ("shake the floor at 0.5 Hz with 25 mm", STEADY, _tone(0.5, 0.025, 12.0)),
    "very_slow_sine": ("move the floor at 0.05 Hz with 25 mm", STEADY, _tone(0.05, 0.025, 20.0)),
    "current_steps": ("switch the current about every 0.25 s on a tone of 1 Hz", {"law": "on_off_skyhook", "on": 0.9},
        _tone(1.0, 0.03, 12.0)),
}  # fmt: skip
"""What is to be done, the control law and the excitation of a scenario; currents are within those of usual coils."""


class CandidateExperiment(NamedTuple):
    """An entry of the menu: what drives the rig, sensors and mass added to it; `scenario` its sections in a file."""

    name: str
    text: str
    floor: Floor
    extra: tuple[str, ...] = ()
    mass: float = 0.0
    scenario: dict[str, Any] | None = None


@dataclasses.dataclass(frozen=True)
class Played(Recording):
    """A recording of a bench whose runs all are a motion that is at hand."""

    floor: Floor

    def table(self, run: str) -> dict[str, Array]:
        """Return the motion, shape (N,) each."""
        parts, floor = round(1.0 / self.header.sample_rate / self.floor.step), self.floor
        names = {"displacement": floor.displacement, "current_command": floor.command,
                 "coil_current": floor.coil_current, "damper_temperature": floor.temperature}  # fmt: skip
        return {name: values[::parts] for name, values in names.items() if values is not None}


def propose_experiment(objective: Objective, evaluation: Evaluation, group: Sequence[str]) -> dict[str, Any]:
    """Return the cheapest experiment that tells the members of a group apart, or that none on the menu does.

    Sensors are told from the rest by calibrating them. Where no trial makes all members unlike (ALIKE), the one that
    makes them least alike is taken.

    `kind` is `excitation` (then with a `scenario`, ready to be written, where the rig is a seat), `intervention` or
    `none`; `alikeness_now` and `alikeness_then` are those of the worst pair.
    """
    if not objective.jacobian:
        objective.refresh(evaluation)
    members = [with_member(objective, evaluation, name, group) for name in group]
    base = objective.states([evaluation.parameters.without(*group)])[0]
    views = [stacked(base.whitened, objective) - stacked(member.whitened, objective) for member in members]
    now = likeness(np.array(views), beside(objective.jacobian, objective))
    wrong, first = _sensors(members), ""
    if wrong:
        first = f"calibrating {' and '.join(wrong)} tells a wrong sensor from a change of the rig"
        members = [member for member in members if member.parameters.terms[-1].block != "sensor"]
        if len(members) <= 1:
            return _answer("intervention", "calibrate_sensor", first, now, 0.0)
        first += "; beside that, "
    seen = _judged_menu(objective, evaluation, base, members)
    apart, then, candidate = min(seen, key=lambda found: (found[0] <= APART, found[1]))
    if apart <= APART:
        apart, then, candidate = max(seen, key=lambda found: found[0])
        reason = f"none on the menu separates them: the best, {candidate.name}, does so by {apart:.1f} times the noise only"
        return _answer("none", "none on the menu", first + reason, now, then)
    reason = f"{candidate.text}: they then differ by {apart:.0f} times the noise, alikeness {then:.2f} instead of {now:.2f}"
    answer = _answer("excitation" if candidate.scenario else "intervention", candidate.name, first + reason, now, then)
    return answer | _scenario(objective.problem, candidate)


def _judged_menu(
    objective: Objective, evaluation: Evaluation, base: Evaluation, members: Sequence[Evaluation]
) -> list[tuple[float, float, CandidateExperiment]]:
    """Return discrimination and alikeness of the worst pair in each trial, as far as the first that tells all apart."""
    seen = []
    for candidate in candidate_experiments(objective.problem):
        apart, then = _judged(objective, evaluation, base, members, candidate)
        seen.append((apart, then, candidate))
        if apart > APART and then < ALIKE:
            break
    return seen


def _answer(kind: str, name: str, reason: str, now: float, then: float) -> dict[str, Any]:
    alike = {"alikeness_now": round(now, 4), "alikeness_then": round(then, 4)}
    return {"kind": kind, "name": name, "reason": reason} | alike


def _scenario(problem: Problem, candidate: CandidateExperiment) -> dict[str, Any]:
    """Return the nominal scenario under an excitation of the menu as `scenario`; nothing else has one."""
    if candidate.scenario is None or problem.bench:
        return {}
    values = augmented_content(problem, Parameters(problem.rest)) | {"name": f"experiment-{candidate.name}"} | candidate.scenario
    return {"scenario": {k: v for k, v in values.items() if k not in ("start", "sweep", "variants", "published")}}


def _sensors(members: Sequence[Evaluation]) -> list[str]:
    """Return the channels whose calibration tells members of a group from the others; none where two have the same."""
    terms = [member.parameters.terms[-1] for member in members]
    named = [str(t.fixed.get("channel", "the clock")).replace("_", " ") for t in terms if t.block == "sensor"]
    return named if len(set(named)) == len(named) else []


def candidate_experiments(problem: Problem) -> Iterator[CandidateExperiment]:
    """Yield what can be done, cheapest first."""
    step, top = problem.scenario.solver.step, problem.scenario.coil.max_current
    for name, (words, law, keys) in EXCITATIONS.items():
        if problem.bench and name == "bump":
            continue
        text = words.replace("the floor", "the damper") if problem.bench else words
        own = {key: value for key, value in keys.items() if key != "kind"}
        floor = find("excitation", keys["kind"])(**own).floor(step, 0)
        current = {key: top * value for key, value in law.items() if key != "law"}
        command = np.full(len(floor.time), current.get("current", 0.0))
        if "on" in current:
            command = current["on"] * (np.floor(floor.time / 0.25) % 2.0)
        scenario = {"controller": {"law": law["law"], **current}, "excitation": keys}
        yield CandidateExperiment(name, text, floor._replace(command=command), scenario=scenario)
    yield from _interventions(problem, _recorded(problem))


def _interventions(problem: Problem, floor: Floor) -> Iterator[CandidateExperiment]:
    rest, time = np.zeros(len(floor.acceleration)), floor.time
    steps = 0.9 * problem.scenario.coil.max_current * (np.floor(time / 0.25) % 2.0)
    still = Floor(floor.step, rest, rest, rest, steps)
    if "coil_current" not in problem.channels:
        yield CandidateExperiment("coil_current", "repeat a run and log the current of the coil", floor, ("coil_current",))
    yield CandidateExperiment("zero_current", "repeat a run without current", floor._replace(command=rest, coil_current=rest))
    ramp = 20.0 + 40.0 * time / time[-1]
    yield CandidateExperiment("warm_up", "repeat a run while the damper warms from 20 to 60 degC", floor._replace(temperature=ramp))
    if not problem.bench:
        yield CandidateExperiment("locked_seat", "lock the seat and switch the current every 0.25 s", still)
        yield CandidateExperiment("added_mass", "repeat a run with 20 kg more on the driver's place", floor, mass=20.0)
    if "damper_force" not in problem.channels:
        yield CandidateExperiment("load_cell", "repeat a run with a load cell at the damper", floor, ("damper_force",))


def _recorded(problem: Problem) -> Floor:
    """Return what drove the first run."""
    run = problem.runs[0]
    floor, table = problem.floors[run], problem.recording.table(run)
    if floor is not None:
        return floor
    zero, current = np.zeros(len(table["displacement"])), table.get("current_command")
    position, step = table["displacement"], 1.0 / problem.recording.header.sample_rate
    return Floor(step, zero, zero, position, current, table.get("coil_current"), table.get("damper_temperature"))


def _simulated(problem: Problem, candidate: CandidateExperiment, parameters: Parameters) -> Array:
    """Return what the sensors say in a trial, shape (channels, rows), without its first second."""
    scenario = vary(problem.scenario, problem.parameters, parameters.u)
    effects = [*scenario.effects, *parameters.effects]
    effects += [] if any(isinstance(effect, CARRIER) for effect in effects) else [off(CARRIER)]
    scenario = dataclasses.replace(scenario, effects=tuple(effects))
    step, names = 1.0 / problem.recording.header.sample_rate, (*problem.channels, *candidate.extra)
    if scenario.plant is None:
        parts = {f.name: getattr(problem.recording, f.name) for f in dataclasses.fields(Recording)}
        answer = replay_bench(scenario, Played(**parts, floor=candidate.floor), problem.runs[0])
    else:
        plant = scenario.plant._replace(driver_mass=scenario.plant.driver_mass + candidate.mass)
        history = simulate(dataclasses.replace(scenario, plant=plant), candidate.floor)
        every = round(step / candidate.floor.step)
        answer = readings(scenario.effects, step, {name: history[name][::every] for name in names})
    return np.array([answer[name][problem.skip :] for name in names])


def _weights(problem: Problem, candidate: CandidateExperiment, signal: Array) -> Array:
    """Return 1 / sigma of the channels of a trial, shape (channels, 1)."""
    stated = [*problem.noise, *(NOISE[name] for name in candidate.extra)]
    noise = [value or NOISE[name] for name, value in zip((*problem.channels, *candidate.extra), stated, strict=True)]
    return np.asarray(1.0 / np.hypot(noise, MODEL_ERROR * np.std(signal, axis=1)))[:, None]


def _judged(objective: Objective, evaluation: Evaluation, base: Evaluation, members: Sequence[Evaluation], candidate: CandidateExperiment) -> tuple[float, float]:
    """Return the discrimination and the alikeness of the worst pair in a trial."""
    count, number = len(evaluation.parameters.u), len(members)
    centres = [evaluation.parameters, *(member.parameters for member in members)]
    moves = [shifted(evaluation.parameters, 0, count)] + [shifted(c, count, len(c.vector)) for c in centres[1:]]
    points = [base.parameters, *centres, *(parameters for found in moves for parameters, _ in found)]
    signals = list(POOL.map(lambda parameters: _simulated(objective.problem, candidate, parameters), points))
    weights = _weights(objective.problem, candidate, signals[1])
    rows = np.array([(weights * signal).ravel() for signal in signals])
    ends = np.cumsum([2 + number] + [len(found) for found in moves])
    jacobian = [
        (rows[ends[k] : ends[k + 1]] - rows[1 + k]) / np.array([difference_step for _, difference_step in found])[:, None]
        for k, found in enumerate(moves)
    ]
    new = PredictedExperiment(rows[2 : 2 + number], jacobian[0], jacobian[1:])
    own = [beside(objective.jacobian(member), objective) for member in members]
    known = np.array([-stacked(member.whitened, objective) for member in members])
    old = PredictedExperiment(known, beside(objective.jacobian, objective), own)
    return separability(old, new), likeness(new.outputs - rows[0], jacobian[0])
