"""The next experiment: one that distinguishes effects that explain the recording equally well.

Every member of the group was fitted to the recording, so that all give nearly the same outputs there. Each candidate
experiment is then simulated with each member, with white noise sigma = hypot(stated noise, model_error * rms) on each
channel. It is assessed by the separability of the nearest pair, in noise units, and by the likeness of the most similar
pair: 0 where their changes of the outputs share nothing, 1 where they are the same.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from typing import Literal, NamedTuple

import numpy as np

from seatsim.diagnosis.answer import write_augmented
from seatsim.diagnosis.design.candidate_experiments import (
    CandidateExperiment,
    list_candidate_experiments,
    optimise_excitation,
)
from seatsim.diagnosis.design.separability import (
    PredictedExperiment,
    measure_likeness,
    measure_separability,
    project,
    stack_jacobian,
    stack_whitened,
)
from seatsim.diagnosis.objective import Evaluation, Linearisation, Objective, Parameters
from seatsim.diagnosis.problem import DiagnosisProblem
from seatsim.diagnosis.result import Content, ProposedExperiment
from seatsim.diagnosis.settings.examining import DesignSettings
from seatsim.excitations.base import Floor
from seatsim.recordings.replay import COMPARED
from seatsim.scenario.numbers import change_numbers, list_numbers
from seatsim.schema.arrays import Array
from seatsim.simulation.augment import augment_plant
from seatsim.simulation.inputs import BenchInputs, RigInputs, SeatInputs
from seatsim.simulation.respond import respond

_Kind = Literal["excitation", "intervention", "none"]

USUAL_NOISE = dict(zip(COMPARED["seat"], (0.03, 0.015, 5e-5, 2.5, 0.003), strict=True))
"""Noise of usual sensors, for those that state none, in the unit of their channel."""
_BEYOND = 10.0
"""Score of an excitation for each time that it takes the permitted travel beyond the first."""
_NOT_REPEATED = ("start", "sweep", "variants", "published")
"""Sections of the nominal scenario that an experiment does not have."""


class _Verdict(NamedTuple):
    """Prediction of an experiment.

    Separability of the nearest pair in noise units, likeness of the most alike pair, and the share of the permitted
    travel of the suspension that an excitation takes.
    """

    separability: float
    likeness: float
    candidate: CandidateExperiment
    reach: float = 0.0


def propose_experiment(
    objective: Objective, nuisances: Linearisation, members: Mapping[str, Evaluation]
) -> ProposedExperiment:
    """Return the cheapest experiment that distinguishes the members of a group, or the statement that none does.

    A faulty sensor is distinguished from other causes by calibrating it. Where several candidates separate all members
    but none brings the likeness below its limit, the one with the least likeness is taken.

    Args:
        objective: over all runs.
        nuisances: the rig found, with its sensitivities to the nuisance parameters.
        members: fitted rigs that explain the recording equally well, by the effect in which they differ.
    """
    base = objective.evaluate([nuisances.evaluation.parameters.remove(*members)])[0]
    whitened = stack_whitened(objective, base.whitened)
    changes = np.array([whitened - stack_whitened(objective, member.whitened) for member in members.values()])
    now = _likeness(objective, changes, stack_jacobian(objective, nuisances))
    sensors, first = _name_sensors(members), ""
    if sensors:
        unloaded = " while it is unloaded" if sensors == ["damper force"] else ""
        first = f"calibrating {' and '.join(sensors)}{unloaded} tells a wrong sensor from a change of the rig"
        members = {name: member for name, member in members.items() if not name.startswith("sensor.")}
        if len(members) <= 1:
            return _propose("intervention", "calibrate_sensor", first, now, 0.0)
        first += "; beside that, "
    return _choose(objective, _assess_candidates(objective, nuisances, base, [*members.values()]), first, now)


def _choose(objective: Objective, seen: Sequence[_Verdict], first: str, now: float) -> ProposedExperiment:
    """Return the best candidate: of those that separate all members, the one with the least likeness."""
    separated = objective.settings.design.separated
    permitted = [each for each in seen if each.reach <= 1.0] or seen
    best = min(permitted, key=lambda each: (each.separability <= separated, each.likeness))
    if best.separability <= separated or best.reach > 1.0:
        best = max(permitted, key=lambda each: each.separability)
        reason = f"no candidate experiment separates them: the best, {best.candidate.name}, does so by"
        reason += f" {best.separability:.1f} times the noise only"
        return _propose("none", "none on the menu", first + reason, now, best.likeness)
    candidate = best.candidate
    reason = f"{candidate.text}: they then differ by {best.separability:.0f} times the noise,"
    reason += f" likeness {best.likeness:.2f} instead of {now:.2f}"
    if candidate.set:
        stated = ", ".join(f"{key}: {value:g}" for key, value in candidate.set.items())
        reason += f"; its run in recording.yaml states set: {{{stated}}}"
    kind: _Kind = "excitation" if candidate.scenario else "intervention"
    proposal = _propose(kind, candidate.name, first + reason, now, best.likeness)
    scenario = _write_scenario(objective.problem, candidate)
    return dataclasses.replace(proposal, scenario=scenario, set=dict(candidate.set))


def _assess_candidates(
    objective: Objective, nuisances: Linearisation, base: Evaluation, members: Sequence[Evaluation]
) -> list[_Verdict]:
    """Return the predictions of the candidates, up to the first kind that distinguishes all members.

    Excitations cost least, so that where none distinguishes them the best is optimised; changes of the rig are tried
    where it does not either.
    """
    settings, candidates = objective.settings.design, list(list_candidate_experiments(objective.problem))

    def assess(candidate: CandidateExperiment) -> _Verdict:
        return _assess(objective, nuisances, base, members, candidate)

    excitations = [each for each in candidates if each.scenario is not None]
    seen = _assess_until_distinct(settings, assess, excitations)
    best = min(seen, key=lambda each: _score(settings, each))

    def score(candidate: CandidateExperiment) -> float:
        seen.append(assess(candidate))
        return _score(settings, seen[-1])

    if not _is_distinct(settings, seen[-1]):
        optimise_excitation(objective.problem, best.candidate.name, score, settings.trials)
    if any(_is_distinct(settings, each) for each in seen):
        return seen
    return seen + _assess_until_distinct(settings, assess, [each for each in candidates if each.scenario is None])


def _assess_until_distinct(
    settings: DesignSettings,
    assess: Callable[[CandidateExperiment], _Verdict],
    candidates: Sequence[CandidateExperiment],
) -> list[_Verdict]:
    seen: list[_Verdict] = []
    for candidate in candidates:
        seen.append(assess(candidate))
        if _is_distinct(settings, seen[-1]):
            break
    return seen


def _is_distinct(settings: DesignSettings, seen: _Verdict) -> bool:
    """Whether an experiment distinguishes all members within the travel of the suspension."""
    return seen.separability > settings.separated and seen.likeness < settings.unlike and seen.reach <= 1.0


def _score(settings: DesignSettings, seen: _Verdict) -> float:
    """Return what an optimised excitation has least: likeness, lack of separability, travel beyond the permitted."""
    lacking = max(0.0, 1.0 - seen.separability / settings.separated)
    return seen.likeness + lacking + _BEYOND * max(0.0, seen.reach - 1.0)


def _propose(kind: _Kind, name: str, reason: str, now: float, then: float) -> ProposedExperiment:
    return ProposedExperiment(kind, name, reason, round(now, 4), round(then, 4))


def _write_scenario(problem: DiagnosisProblem, candidate: CandidateExperiment) -> Content | None:
    """Return the nominal scenario under the excitation of a candidate; nothing else has one."""
    if candidate.scenario is None or problem.bench:
        return None
    nominal = write_augmented(problem, Parameters(problem.nominal))
    values = nominal | {"name": f"experiment-{candidate.name}"} | dict(candidate.scenario)
    return {key: value for key, value in values.items() if key not in _NOT_REPEATED}


def _name_sensors(members: Mapping[str, Evaluation]) -> list[str]:
    """Return the channels whose calibration distinguishes the group's members; none where two act on the same one."""
    terms = [term for name, member in members.items() for term in member.parameters.terms if term.effect == name]
    named = [str(t.fixed.get("channel", "the clock")).replace("_", " ") for t in terms if t.block == "sensor"]
    return named if len(set(named)) == len(named) else []


def _likeness(objective: Objective, changes: Array, jacobian: Array) -> float:
    """Return the likeness of the most similar pair of changes, with the nuisance parameters projected out."""
    return measure_likeness(project(changes, jacobian, np.full(len(jacobian), objective.settings.fit.prior_std)))


def _simulate(problem: DiagnosisProblem, candidate: CandidateExperiment, rig: Parameters) -> Array:
    """Return the sensor readings in an experiment, shape (channels, rows), without its first second."""
    outputs = _respond(problem, candidate, rig)
    return np.array([outputs[name][problem.skip :] for name in (*problem.channels, *candidate.added_sensors)])


def _respond(problem: DiagnosisProblem, candidate: CandidateExperiment, rig: Parameters) -> Mapping[str, Array]:
    """Return all sensor readings in an experiment."""
    augmented = problem.augmented(rig.deviations, rig.effects)
    scenario = change_numbers(augmented, candidate.set, list_numbers(problem.scenario))
    return respond(scenario, _make_inputs(problem, candidate.floor), carry_all_effects=True)


def _measure_reach(problem: DiagnosisProblem, candidate: CandidateExperiment, rig: Parameters) -> float:
    """Return the share of the permitted travel, or of a bench's stroke, that an excitation takes; 0 for other kinds."""
    plant, largest = problem.scenario.plant, problem.settings.design.largest_travel
    if candidate.scenario is None:
        return 0.0
    if plant is None or problem.bench:
        return float(np.max(np.abs(candidate.floor.displacement))) / largest
    low, high = augment_plant(problem.scenario.effects, plant).end_stops or (-largest, largest)
    travel = _respond(problem, candidate, rig)["suspension_displacement"]
    return float(max(np.max(travel) / max(high, 1e-9), np.min(travel) / min(low, -1e-9)))


def _make_inputs(problem: DiagnosisProblem, floor: Floor) -> RigInputs:
    """Return the inputs of the rig: the floor's motion or, on a bench, the damper's motion and its current."""
    interval = 1.0 / problem.rate
    if not problem.bench:
        return SeatInputs(floor, interval)
    every = round(interval / floor.step)
    return BenchInputs(
        interval,
        floor.displacement[::every],
        problem.recording.channels["displacement"].noise_rms,
        current_command=None if floor.command is None else floor.command[::every],
        coil_current=None if floor.coil_current is None else floor.coil_current[::every],
        damper_temperature=None if floor.temperature is None else floor.temperature[::every],
    )


def _weigh(problem: DiagnosisProblem, candidate: CandidateExperiment, outputs: Array) -> Array:
    """Return 1 / sigma of the channels of an experiment, shape (channels, 1)."""
    stated = [*problem.noise, *(USUAL_NOISE[name] for name in candidate.added_sensors)]
    names = (*problem.channels, *candidate.added_sensors)
    noise = [value or USUAL_NOISE[name] for name, value in zip(names, stated, strict=True)]
    return np.asarray(1.0 / np.hypot(noise, problem.settings.noise.model_error * np.std(outputs, axis=1)))[:, None]


def _assess(
    objective: Objective,
    nuisances: Linearisation,
    base: Evaluation,
    members: Sequence[Evaluation],
    candidate: CandidateExperiment,
) -> _Verdict:
    """Return the prediction of an experiment, from a joint simulation of all rigs and their difference steps."""
    problem, settings = objective.problem, objective.settings
    rig, step, number = nuisances.evaluation.parameters, settings.fit.difference_step, len(members)
    shifts = [[rig.shift(k, step) for k in rig.nuisance_components]]
    shifts += [[m.parameters.shift(k, step) for k in m.parameters.effect_components] for m in members]
    rigs = [base.parameters, rig, *(m.parameters for m in members), *(p for found in shifts for p, _ in found)]
    outputs = list(problem.pool.map(lambda each: _simulate(problem, candidate, each), rigs))
    weights = _weigh(problem, candidate, outputs[1])
    rows = np.array([(weights * values).ravel() for values in outputs])
    ends = np.cumsum([2 + number] + [len(found) for found in shifts])
    jacobians = [
        (rows[ends[k] : ends[k + 1]] - rows[1 + k]) / np.array([signed for _, signed in found])[:, None]
        for k, found in enumerate(shifts)
    ]
    new = PredictedExperiment(rows[2 : 2 + number], jacobians[0], jacobians[1:])
    own = [stack_jacobian(objective, objective.linearise_effects(member)) for member in members]
    known = np.array([-stack_whitened(objective, member.whitened) for member in members])
    old = PredictedExperiment(known, stack_jacobian(objective, nuisances), own)
    separability = measure_separability(old, new, settings.fit.prior_std, settings.design.effect_std)
    likeness = _likeness(objective, new.outputs - rows[0], jacobians[0])
    return _Verdict(separability, likeness, candidate, _measure_reach(problem, candidate, rig))
