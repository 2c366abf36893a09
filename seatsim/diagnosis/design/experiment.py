"""The next experiment: one that distinguishes effects that explain the recording equally well.

Every member of the group was fitted to the recording, so that all give nearly the same outputs there. Each candidate
experiment is then simulated with each member, with white noise sigma = hypot(stated noise, model_error * rms) on each
channel. It is assessed by the separability of the nearest pair, in noise units, and by the likeness of the most similar
pair: 0 where their changes of the outputs share nothing, 1 where they are the same.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
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
)
from seatsim.diagnosis.objective import PRIOR_STD, Evaluation, Linearisation, Objective, Parameters
from seatsim.diagnosis.problem import DiagnosisProblem
from seatsim.diagnosis.result import Content, ProposedExperiment
from seatsim.recordings.replay import COMPARED
from seatsim.scenario.numbers import change_numbers, list_numbers
from seatsim.schema.arrays import Array
from seatsim.simulation.augment import augment_plant
from seatsim.simulation.inputs import BenchInputs, SeatInputs
from seatsim.simulation.respond import respond

_Kind = Literal["excitation", "intervention", "none"]

_USUAL_NOISE = dict(zip(COMPARED["seat"], (0.03, 0.015, 5e-5, 2.5, 0.003), strict=True))
"""Noise of usual sensors, for those that state none, in the unit of their channel."""
_BEYOND = 10.0
"""Score of an excitation for each time that it takes the permitted travel beyond the first."""
_EFFECT_STD = 10.0
"""Prior standard deviation of an effect's parameter, in its natural size: no effect is separable by being small."""
_NOT_REPEATED = ("start", "sweep", "variants", "published")
"""Sections of the nominal scenario that an experiment does not have."""


class _Verdict(NamedTuple):
    """Prediction of an experiment.

    Separability of the nearest pair in noise units, likeness of the most alike pair, and the share of the permitted
    travel of the suspension that an excitation takes. `is_distinct` says whether it distinguishes all members within
    that travel; `score` is what an optimised excitation has least: likeness, lack of separability, travel beyond.
    """

    separability: float
    likeness: float
    candidate: CandidateExperiment
    reach: float
    is_distinct: bool
    score: float


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
    changes = np.array([base.stacked - member.stacked for member in members.values()])
    now = _measure_likeness(changes, nuisances.stacked)
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
    candidates = list(list_candidate_experiments(objective.problem))
    rigs = [each.parameters for each in (base, nuisances.evaluation, *members)]
    own = [objective.linearise_effects(member).stacked for member in members]
    known = PredictedExperiment(np.array([-member.stacked for member in members]), nuisances.stacked, own)
    seen = list[_Verdict]()

    def assess(candidate: CandidateExperiment) -> _Verdict:
        seen.append(_assess(objective, rigs, known, candidate))
        return seen[-1]

    def distinguish(offered: Sequence[CandidateExperiment]) -> bool:
        """Assess experiments up to the first that distinguishes all members, and say whether there is one."""
        return any(assess(each).is_distinct for each in offered)

    if not distinguish([each for each in candidates if each.scenario is not None]):
        best = min(seen, key=lambda each: each.score).candidate.name
        optimise_excitation(objective.problem, best, lambda candidate: assess(candidate).score)
        if not any(each.is_distinct for each in seen):
            distinguish([each for each in candidates if each.scenario is None])
    return seen


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


def _measure_likeness(changes: Array, jacobian: Array) -> float:
    """Return the likeness of the most similar pair of changes, with the nuisance parameters projected out."""
    return measure_likeness(project(changes, jacobian, np.full(len(jacobian), PRIOR_STD)))


def _simulate(problem: DiagnosisProblem, candidate: CandidateExperiment, rig: Parameters) -> Array:
    """Return the sensor readings in an experiment, shape (channels, rows), without its first second."""
    outputs = _respond(problem, candidate, rig)
    return np.array([outputs[name][problem.skip :] for name in (*problem.channels, *candidate.added_sensors)])


def _respond(problem: DiagnosisProblem, candidate: CandidateExperiment, rig: Parameters) -> Mapping[str, Array]:
    """Return all sensor readings in an experiment."""
    augmented = problem.augmented(rig.deviations, rig.effects)
    scenario = change_numbers(augmented, candidate.set, list_numbers(problem.scenario))
    floor, interval = candidate.floor, 1.0 / problem.rate
    if not problem.bench:
        return respond(scenario, SeatInputs(floor, interval))
    every = slice(None, None, round(interval / floor.step))
    driving = floor.command, floor.coil_current, floor.temperature
    command, current, temperature = (None if values is None else values[every] for values in driving)
    noise = problem.recording.channels["displacement"].noise_rms
    inputs = BenchInputs(
        interval, floor.displacement[every], noise, current_command=command, coil_current=current,
        damper_temperature=temperature,
    )  # fmt: skip
    return respond(scenario, inputs)


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


def _weigh(problem: DiagnosisProblem, candidate: CandidateExperiment, outputs: Array) -> Array:
    """Return 1 / sigma of the channels of an experiment, shape (channels, 1)."""
    stated = [*problem.noise, *(_USUAL_NOISE[name] for name in candidate.added_sensors)]
    names = (*problem.channels, *candidate.added_sensors)
    noise = [value or _USUAL_NOISE[name] for name, value in zip(names, stated, strict=True)]
    return np.asarray(1.0 / np.hypot(noise, problem.settings.noise.model_error * np.std(outputs, axis=1)))[:, None]


def _assess(
    objective: Objective, rigs: Sequence[Parameters], known: PredictedExperiment, candidate: CandidateExperiment
) -> _Verdict:
    """Return the prediction of an experiment, from a joint simulation of all rigs and their difference steps.

    Args:
        objective: over all runs of the recording at hand.
        rigs: the rig found without the members' effects, the rig found, and then every member.
        known: what the recording at hand tells of the members.
        candidate: the experiment.
    """
    problem, (_, rig, *members) = objective.problem, rigs
    shifts = [[rig.shift(k) for k in rig.nuisance_components]]
    shifts += [[member.shift(k) for k in member.effect_components] for member in members]
    moved = [*rigs, *(parameters for found in shifts for parameters, _ in found)]
    outputs = list(problem.pool.map(lambda each: _simulate(problem, candidate, each), moved))
    weights = _weigh(problem, candidate, outputs[1])
    rows = np.array([(weights * values).ravel() for values in outputs])
    ends = np.cumsum([len(rigs)] + [len(found) for found in shifts])
    jacobians = [
        (rows[ends[k] : ends[k + 1]] - rows[1 + k]) / np.array([signed for _, signed in found])[:, None]
        for k, found in enumerate(shifts)
    ]
    new = PredictedExperiment(rows[2 : len(rigs)], jacobians[0], jacobians[1:])
    separability = measure_separability(known, new, PRIOR_STD, _EFFECT_STD)
    likeness = _measure_likeness(new.outputs - rows[0], jacobians[0])
    settings, reach = problem.settings.design, _measure_reach(problem, candidate, rig)
    is_distinct = separability > settings.separated and likeness < settings.unlike and reach <= 1.0
    lacking = max(0.0, 1.0 - separability / settings.separated)
    score = likeness + lacking + _BEYOND * max(0.0, reach - 1.0)
    return _Verdict(separability, likeness, candidate, reach, is_distinct, score)
