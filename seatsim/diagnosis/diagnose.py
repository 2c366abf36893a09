"""From a recording to its diagnosis."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from threadpoolctl import threadpool_limits

from seatsim.diagnosis.augmented import augmented_content
from seatsim.diagnosis.list_candidates import Candidate, list_candidates
from seatsim.diagnosis.cross_validate import gap_weights, select_by_cross_validation
from seatsim.diagnosis.decide import Decision, beside_unknown, decide_verdict
from seatsim.diagnosis.design.collinearity import collinearity
from seatsim.diagnosis.design.propose_experiment import propose_experiment
from seatsim.diagnosis.design.isolability import find_isolable_groups, missing_sensors
from seatsim.diagnosis.estimates import estimate_causes, collect_evidence
from seatsim.diagnosis.fit import Objective, Parameters
from seatsim.diagnosis.localise.discrepancy import Discrepancy, discrepancy
from seatsim.diagnosis.localise.input_estimate import estimate_nonrepeatable_force
from seatsim.diagnosis.localise.localise import share_gap, localise_remainder
from seatsim.diagnosis.localise.stochastic import add_to_noise, merge_effect, name_stochastic_effect, find_bias_drift, with_strength
from seatsim.diagnosis.noise import measure_broadband, noise_weights
from seatsim.diagnosis.problem import Problem, problem
from seatsim.diagnosis.result import Array, Diagnosis, Share
from seatsim.diagnosis.select import Selection, select_effects
from seatsim.diagnosis.sentences import answer
from seatsim.diagnosis.validate import measure_gaps, choose_held_out_run, scenario_at, shrink_by_run, refit_without
from seatsim.recordings.quality.coverage import coverage
from seatsim.recordings.quality.examination import examine, refuse
from seatsim.recordings.recording import Recording, load_recording
from seatsim.scenario.loading import single
from seatsim.schema.registry import names

CHATTER = 0.5
"""Share of what the best set leaves from which broadband noise is counted as such."""

PLAIN = 2
"""Most effects that are sought, each from the first start of its form, where only the gap counts."""


class Solution(NamedTuple):
    """A search with its judgement; `random` is the effect at work, if any, whose course is that of the rest."""

    objective: Objective
    found: Selection
    decision: Decision
    where: Sequence[Share] = ()
    rest: Discrepancy | None = None
    random: str = ""


def diagnose(
    recording: str | Path | Recording, without: Sequence[str] = (), progress: Callable[[str], None] = lambda _: None
) -> Diagnosis:
    """Say where the gap between a recording and its nominal scenario lies, what causes it, and how far it shrinks.

    `without` names effects that are withheld from the library; `progress` is called with what is being done.

    Raises:
        InputError: the recording is damaged in a way that would lead to a wrong verdict.
        RunError: a simulation could not be carried to its end.
    """
    if not isinstance(recording, Recording):
        recording = load_recording(recording)
    progress("looking at the data")
    examination = examine(recording)
    refuse(examination)
    with threadpool_limits(1):
        solution = solved(problem(recording), without, progress)
        return _stated(recording, solution, [finding.sentence for finding in examination.findings], progress)


def solved(posed: Problem, without: Sequence[str], progress: Callable[[str], None]) -> Solution:
    """Search for the causes; where what is left comes from outside, count it as noise and search again."""
    offered = list_candidates(posed, without)
    effects = [name for name in names("effect") if name not in without]
    progress("weighing the channels")
    objective = Objective(posed, noise_weights(posed))
    shaken = None if posed.bench else estimate_nonrepeatable_force(objective, objective.states([Parameters(posed.rest)])[0])
    if shaken is not None:
        objective = Objective(posed, noise_weights(posed, shaken))
    first = _searched(objective, offered, effects, progress)
    if first.decision.verdict == "unknown":
        first = _past_chatter(first, shaken, offered, effects, progress)
    first = _supported(first, offered, progress) if first.decision.verdict == "unknown" else _placed(first, progress)
    rest = first.rest
    if first.decision.verdict in ("known", "ambiguous") and not posed.bench:
        rest = find_bias_drift(posed, first.decision.chosen)
    random = name_stochastic_effect(posed, rest) if rest else ""
    if rest is None or not random or random in without:
        return first
    progress(f"counting {random} as noise")
    noisy = Objective(posed, add_to_noise(first.objective, random, rest))
    second = _searched(noisy, [each for each in offered if each.effect != random], effects, progress)
    if second.decision.verdict == "unknown":
        return first
    decision, where = merge_effect(second.decision, _placed(second, progress).where, random)
    rest = rest._replace(block=random.partition(".")[0])
    return second._replace(decision=decision, where=where, rest=rest, random=random)


def _past_chatter(
    first: Solution, shaken: Mapping[str, Array] | None, offered: Sequence[Candidate], effects: list[str],
    progress: Callable[[str], None],
) -> Solution:  # fmt: skip
    """Search again where most of what the best set leaves is broadband, and return what explains the gap beside it."""
    posed, best = first.objective.problem, first.found.sets[-1][0]
    errors, weights = measure_broadband(posed, best.residual), first.objective.white.weights
    chatter = sum(float(np.sum(power * weights[run] ** 2)) for run, power in errors.items())
    if chatter < CHATTER * first.found.excess(best) * first.found.rows:
        return first
    progress("counting chatter as noise")
    second = _searched(Objective(posed, noise_weights(posed, shaken, errors)), offered, effects, progress)
    return second if second.decision.verdict in ("known", "ambiguous") else first


def _searched(
    objective: Objective, offered: Sequence[Candidate], effects: list[str], progress: Callable[[str], None]
) -> Solution:
    found = select_effects(objective, offered, progress)
    return Solution(objective, found, decide_verdict(objective, found, effects))


def _supported(first: Solution, offered: Sequence[Candidate], progress: Callable[[str], None]) -> Solution:
    """Return what is unexplained, beside the effects that runs left out support where only the gap counts."""
    progress("weighing the gap alone")
    posed = first.objective.problem
    objective = Objective(posed, gap_weights(posed, first.found.calibrated))
    plainest = {each.structure: each for each in reversed(offered)}
    found = select_effects(objective, list(plainest.values()), progress, PLAIN)
    chosen, alike = select_by_cross_validation(objective, found)
    decision = beside_unknown(first.decision, first.objective.refitted(chosen.parameters), alike)
    placed = _placed(first._replace(decision=decision), progress)
    if placed.decision is not decision:
        return placed
    decision = dataclasses.replace(decision, chosen=chosen)
    return placed._replace(objective=objective, found=found, decision=decision)


def _placed(solution: Solution, progress: Callable[[str], None]) -> Solution:
    """Return the solution with the blocks that the gap lies in, and the course of what is unexplained."""
    objective, found, decision = solution.objective, solution.found, solution.decision
    if decision.verdict == "none":
        return solution
    if decision.verdict != "unknown":
        return solution._replace(where=share_gap(objective, decision.chosen, None))
    if objective.problem.bench:
        return solution._replace(where=[Share("damper", 1.0)])
    progress("asking which block could hold the rest")
    held, evaluation = localise_remainder(objective, found, decision.chosen)
    rest = discrepancy(objective.problem, evaluation.parameters, held.block, held.hypotheses[held.block])
    if evaluation is not decision.chosen:
        decision = beside_unknown(decision, evaluation)
    return solution._replace(decision=decision, where=share_gap(objective, evaluation, held), rest=rest)


def _stated(recording: Recording, solution: Solution, notes: list[str], progress: Callable[[str], None]) -> Diagnosis:
    """State what a solution amounts to on a held-out run; what fails there beside an unknown cause is given up."""
    objective, decision, posed = solution.objective, solution.decision, solution.objective.problem
    chosen = decision.chosen
    progress("holding out a run")
    shrink = shrink_by_run(posed, solution.found.nominal, chosen)
    run = choose_held_out_run(objective, chosen, shrink)
    calibrated, augmented = refit_without(objective, chosen, run)
    if decision.verdict == "unknown" and not chosen.parameters.terms:
        augmented = solution.found.nominal
    nominal = single(recording.nominal)
    points = (Parameters(posed.rest), calibrated.parameters, augmented.parameters)
    scenarios = [scenario_at(posed, nominal, parameters) for parameters in points]
    spread = float(np.std(shrink, ddof=min(1, len(shrink) - 1)))
    found = measure_gaps(posed, scenarios, [run], spread)
    if decision.verdict == "unknown" and chosen.parameters.terms and found.shrink < 0.0:
        helpless = beside_unknown(decision, solution.found.calibrated)
        return _stated(recording, solution._replace(decision=helpless), notes, progress)
    listed = estimate_causes(objective, solution.found, decision, calibrated, augmented, nominal, run)
    if solution.rest is not None:
        listed = [with_strength(c, solution.rest) if c.effect == solution.random else c for c in listed]
    group = decision.groups[0] if decision.groups else []
    asked = propose_experiment(objective, chosen, group) if decision.verdict == "ambiguous" and not posed.bench else None
    scenario = asked.pop("scenario", None) if asked else None
    relevant = [cause.effect for cause in listed[:10] if cause.probability > 0.003]
    at_work = {solution.random, *(term.effect for term in chosen.parameters.terms)}
    diagnosis = Diagnosis(
        name=recording.folder.name, verdict=decision.verdict, sentence="", where=list(solution.where), estimate_causes=listed,
        probability_none=decision.none, probability_unknown=decision.unknown,
        selected=[name for name in decision.probabilities if name in at_work], random=solution.random,
        indistinguishable=decision.groups, propose_experiment=asked, choose_held_out_run=[run],
        find_isolable_groups=find_isolable_groups(recording.header.rig, recording.channels), gap=found,
        notes=[*notes, *missing_sensors(recording.header.rig, recording.channels), *coverage(recording).missing],
        augmented=augmented_content(posed, augmented.parameters), experiment_scenario=scenario,
        evidence=collect_evidence(posed, points, run, solution.rest, collinearity(objective, chosen, relevant)),
    )  # fmt: skip
    return dataclasses.replace(diagnosis, sentence=answer(diagnosis))
