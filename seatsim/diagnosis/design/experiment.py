"""The next experiment: what would tell effects apart that explain a recording equally well.

Every member of the group is fitted to the recording, so that all look alike there. Each entry of a menu is then
simulated with each member, with white noise sigma = hypot(stated noise, TRUST rms) on each channel, and judged by
`alikeness.discrimination`, in noise units, and `alikeness.resemblance` of its worst pair.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.diagnosis.augmented import content
from seatsim.diagnosis.design.collinearity import (
    Side,
    beside,
    discrimination,
    nudged,
    resemblance,
    stacked,
    with_member,
)
from seatsim.diagnosis.fit import Engine, Point, State
from seatsim.diagnosis.noise import TRUST
from seatsim.diagnosis.nuisance import varied
from seatsim.diagnosis.problem import CARRIER, POOL, Problem
from seatsim.effects.base import off
from seatsim.excitations.base import EXCITATIONS as REGISTERED_EXCITATIONS
from seatsim.excitations.base import Floor
from seatsim.recordings.compared import COMPARED
from seatsim.recordings.recording import Recording
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


class Trial(NamedTuple):
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


def experiment(engine: Engine, state: State, group: Sequence[str]) -> dict[str, Any]:
    """Return the cheapest experiment that tells the members of a group apart, or that none on the menu does.

    Sensors are told from the rest by calibrating them. Where no trial makes all members unlike (ALIKE), the one that
    makes them least alike is taken.

    `kind` is `excitation` (then with a `scenario`, ready to be written, where the rig is a seat), `intervention` or
    `none`; `alikeness_now` and `alikeness_then` are those of the worst pair.
    """
    if not engine.slopes:
        engine.refresh(state)
    members = [with_member(engine, state, name, group) for name in group]
    base = engine.states([state.point.without(*group)])[0]
    views = [stacked(base.whitened, engine) - stacked(member.whitened, engine) for member in members]
    now = resemblance(np.array(views), beside(engine.slopes, engine))
    wrong, first = _sensors(members), ""
    if wrong:
        first = f"calibrating {' and '.join(wrong)} tells a wrong sensor from a change of the rig"
        members = [member for member in members if member.point.terms[-1].block != "sensor"]
        if len(members) <= 1:
            return _answer("intervention", "calibrate_sensor", first, now, 0.0)
        first += "; beside that, "
    seen = _judged_menu(engine, state, base, members)
    apart, then, trial = min(seen, key=lambda found: (found[0] <= APART, found[1]))
    if apart <= APART:
        apart, then, trial = max(seen, key=lambda found: found[0])
        reason = f"none on the menu separates them: the best, {trial.name}, does so by {apart:.1f} times the noise only"
        return _answer("none", "none on the menu", first + reason, now, then)
    reason = f"{trial.text}: they then differ by {apart:.0f} times the noise, alikeness {then:.2f} instead of {now:.2f}"
    answer = _answer("excitation" if trial.scenario else "intervention", trial.name, first + reason, now, then)
    return answer | _scenario(engine.problem, trial)


def _judged_menu(
    engine: Engine, state: State, base: State, members: Sequence[State]
) -> list[tuple[float, float, Trial]]:
    """Return discrimination and alikeness of the worst pair in each trial, as far as the first that tells all apart."""
    seen = []
    for trial in menu(engine.problem):
        apart, then = _judged(engine, state, base, members, trial)
        seen.append((apart, then, trial))
        if apart > APART and then < ALIKE:
            break
    return seen


def _answer(kind: str, name: str, reason: str, now: float, then: float) -> dict[str, Any]:
    alike = {"alikeness_now": round(now, 4), "alikeness_then": round(then, 4)}
    return {"kind": kind, "name": name, "reason": reason} | alike


def _scenario(problem: Problem, trial: Trial) -> dict[str, Any]:
    """Return the nominal scenario under an excitation of the menu as `scenario`; nothing else has one."""
    if trial.scenario is None or problem.bench:
        return {}
    values = content(problem, Point(problem.rest)) | {"name": f"experiment-{trial.name}"} | trial.scenario
    return {"scenario": {k: v for k, v in values.items() if k not in ("start", "sweep", "variants", "published")}}


def _sensors(members: Sequence[State]) -> list[str]:
    """Return the channels whose calibration tells members of a group from the others; none where two have the same."""
    terms = [member.point.terms[-1] for member in members]
    named = [str(t.fixed.get("channel", "the clock")).replace("_", " ") for t in terms if t.block == "sensor"]
    return named if len(set(named)) == len(named) else []


def menu(problem: Problem) -> Iterator[Trial]:
    """Yield what can be done, cheapest first."""
    step, top = problem.scenario.solver.step, problem.scenario.coil.max_current
    for name, (words, law, keys) in EXCITATIONS.items():
        if problem.bench and name == "bump":
            continue
        text = words.replace("the floor", "the damper") if problem.bench else words
        own = {key: value for key, value in keys.items() if key != "kind"}
        floor = REGISTERED_EXCITATIONS.find(keys["kind"])(**own).floor(step, 0)
        current = {key: top * value for key, value in law.items() if key != "law"}
        command = np.full(len(floor.time), current.get("current", 0.0))
        if "on" in current:
            command = current["on"] * (np.floor(floor.time / 0.25) % 2.0)
        scenario = {"controller": {"law": law["law"], **current}, "excitation": keys}
        yield Trial(name, text, floor._replace(command=command), scenario=scenario)
    yield from _interventions(problem, _recorded(problem))


def _interventions(problem: Problem, floor: Floor) -> Iterator[Trial]:
    rest, time = np.zeros(len(floor.acceleration)), floor.time
    steps = 0.9 * problem.scenario.coil.max_current * (np.floor(time / 0.25) % 2.0)
    still = Floor(floor.step, rest, rest, rest, steps)
    if "coil_current" not in problem.channels:
        yield Trial("coil_current", "repeat a run and log the current of the coil", floor, ("coil_current",))
    yield Trial("zero_current", "repeat a run without current", floor._replace(command=rest, coil_current=rest))
    ramp = 20.0 + 40.0 * time / time[-1]
    yield Trial("warm_up", "repeat a run while the damper warms from 20 to 60 degC", floor._replace(temperature=ramp))
    if not problem.bench:
        yield Trial("locked_seat", "lock the seat and switch the current every 0.25 s", still)
        yield Trial("added_mass", "repeat a run with 20 kg more on the driver's place", floor, mass=20.0)
    if "damper_force" not in problem.channels:
        yield Trial("load_cell", "repeat a run with a load cell at the damper", floor, ("damper_force",))


def _recorded(problem: Problem) -> Floor:
    """Return what drove the first run."""
    run = problem.runs[0]
    floor, table = problem.floors[run], problem.recording.table(run)
    if floor is not None:
        return floor
    zero, current = np.zeros(len(table["displacement"])), table.get("current_command")
    position, step = table["displacement"], 1.0 / problem.recording.header.sample_rate
    return Floor(step, zero, zero, position, current, table.get("coil_current"), table.get("damper_temperature"))


def _simulated(problem: Problem, trial: Trial, point: Point) -> Array:
    """Return what the sensors say in a trial, shape (channels, rows), without its first second."""
    scenario = varied(problem.scenario, problem.parameters, point.u)
    effects = [*scenario.effects, *point.effects]
    effects += [] if any(isinstance(effect, CARRIER) for effect in effects) else [off(CARRIER)]
    scenario = dataclasses.replace(scenario, effects=tuple(effects))
    step, names = 1.0 / problem.recording.header.sample_rate, (*problem.channels, *trial.extra)
    if scenario.plant is None:
        parts = {f.name: getattr(problem.recording, f.name) for f in dataclasses.fields(Recording)}
        answer = replay_bench(scenario, Played(**parts, floor=trial.floor), problem.runs[0])
    else:
        plant = scenario.plant._replace(driver_mass=scenario.plant.driver_mass + trial.mass)
        history = simulate(dataclasses.replace(scenario, plant=plant), trial.floor)
        every = round(step / trial.floor.step)
        answer = readings(scenario.effects, step, {name: history[name][::every] for name in names})
    return np.array([answer[name][problem.skip :] for name in names])


def _weights(problem: Problem, trial: Trial, course: Array) -> Array:
    """Return 1 / sigma of the channels of a trial, shape (channels, 1)."""
    stated = [*problem.noise, *(NOISE[name] for name in trial.extra)]
    noise = [value or NOISE[name] for name, value in zip((*problem.channels, *trial.extra), stated, strict=True)]
    return np.asarray(1.0 / np.hypot(noise, TRUST * np.std(course, axis=1)))[:, None]


def _judged(engine: Engine, state: State, base: State, members: Sequence[State], trial: Trial) -> tuple[float, float]:
    """Return the discrimination and the alikeness of the worst pair in a trial."""
    count, number = len(state.point.u), len(members)
    centres = [state.point, *(member.point for member in members)]
    moves = [nudged(state.point, 0, count)] + [nudged(c, count, len(c.vector)) for c in centres[1:]]
    points = [base.point, *centres, *(point for found in moves for point, _ in found)]
    courses = list(POOL.map(lambda point: _simulated(engine.problem, trial, point), points))
    weights = _weights(engine.problem, trial, courses[1])
    rows = np.array([(weights * course).ravel() for course in courses])
    ends = np.cumsum([2 + number] + [len(found) for found in moves])
    slopes = [
        (rows[ends[k] : ends[k + 1]] - rows[1 + k]) / np.array([nudge for _, nudge in found])[:, None]
        for k, found in enumerate(moves)
    ]
    new = Side(rows[2 : 2 + number], slopes[0], slopes[1:])
    own = [beside(engine.jacobian(member), engine) for member in members]
    known = np.array([-stacked(member.whitened, engine) for member in members])
    old = Side(known, beside(engine.slopes, engine), own)
    return discrimination(old, new), resemblance(new.outputs - rows[0], slopes[0])
