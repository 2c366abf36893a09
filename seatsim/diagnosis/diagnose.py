"""From a recording to its diagnosis."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from threadpoolctl import threadpool_limits

from seatsim.diagnosis.augmented import content
from seatsim.diagnosis.candidates import Candidate, candidates
from seatsim.diagnosis.cross_validate import plain, supported
from seatsim.diagnosis.decide import Judgement, beside_unknown, judged
from seatsim.diagnosis.design.collinearity import alikeness
from seatsim.diagnosis.design.experiment import experiment
from seatsim.diagnosis.design.isolability import isolable, losses
from seatsim.diagnosis.estimates import causes, collected
from seatsim.diagnosis.fit import Engine, Point
from seatsim.diagnosis.localise.discrepancy import Latent, latent
from seatsim.diagnosis.localise.input_estimate import unrepeated
from seatsim.diagnosis.localise.localise import places, unexplained
from seatsim.diagnosis.localise.stochastic import counted, joined, random_cause, wandering, with_strength
from seatsim.diagnosis.noise import broadband, whitening
from seatsim.diagnosis.problem import Problem, problem
from seatsim.diagnosis.result import Array, Diagnosis, Share
from seatsim.diagnosis.select import Search, search
from seatsim.diagnosis.sentences import answer
from seatsim.diagnosis.validate import gaps, held_out, scenario_at, shrinks, trained
from seatsim.recordings.quality.coverage import measure_coverage
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

    engine: Engine
    found: Search
    judgement: Judgement
    where: Sequence[Share] = ()
    rest: Latent | None = None
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
        return _stated(recording, solution, examination.sentences, progress)


def solved(posed: Problem, without: Sequence[str], progress: Callable[[str], None]) -> Solution:
    """Search for the causes; where what is left comes from outside, count it as noise and search again."""
    offered = candidates(posed, without)
    effects = [name for name in names("effect") if name not in without]
    progress("weighing the channels")
    engine = Engine(posed, whitening(posed))
    shaken = None if posed.bench else unrepeated(engine, engine.states([Point(posed.rest)])[0])
    if shaken is not None:
        engine = Engine(posed, whitening(posed, shaken))
    first = _searched(engine, offered, effects, progress)
    if first.judgement.verdict == "unknown":
        first = _past_chatter(first, shaken, offered, effects, progress)
    first = _supported(first, offered, progress) if first.judgement.verdict == "unknown" else _placed(first, progress)
    rest = first.rest
    if first.judgement.verdict in ("known", "ambiguous") and not posed.bench:
        rest = wandering(posed, first.judgement.chosen)
    random = random_cause(posed, rest) if rest else ""
    if rest is None or not random or random in without:
        return first
    progress(f"counting {random} as noise")
    noisy = Engine(posed, counted(first.engine, random, rest))
    second = _searched(noisy, [each for each in offered if each.effect != random], effects, progress)
    if second.judgement.verdict == "unknown":
        return first
    judgement, where = joined(second.judgement, _placed(second, progress).where, random)
    rest = rest._replace(block=random.partition(".")[0])
    return second._replace(judgement=judgement, where=where, rest=rest, random=random)


def _past_chatter(
    first: Solution, shaken: Mapping[str, Array] | None, offered: Sequence[Candidate], effects: list[str],
    progress: Callable[[str], None],
) -> Solution:  # fmt: skip
    """Search again where most of what the best set leaves is broadband, and return what explains the gap beside it."""
    posed, best = first.engine.problem, first.found.sets[-1][0]
    errors, weights = broadband(posed, best.residual), first.engine.white.weights
    chatter = sum(float(np.sum(power * weights[run] ** 2)) for run, power in errors.items())
    if chatter < CHATTER * first.found.excess(best) * first.found.rows:
        return first
    progress("counting chatter as noise")
    second = _searched(Engine(posed, whitening(posed, shaken, errors)), offered, effects, progress)
    return second if second.judgement.verdict in ("known", "ambiguous") else first


def _searched(
    engine: Engine, offered: Sequence[Candidate], effects: list[str], progress: Callable[[str], None]
) -> Solution:
    found = search(engine, offered, progress)
    return Solution(engine, found, judged(engine, found, effects))


def _supported(first: Solution, offered: Sequence[Candidate], progress: Callable[[str], None]) -> Solution:
    """Return what is unexplained, beside the effects that runs left out support where only the gap counts."""
    progress("weighing the gap alone")
    posed = first.engine.problem
    engine = Engine(posed, plain(posed, first.found.calibrated))
    plainest = {each.form: each for each in reversed(offered)}
    found = search(engine, list(plainest.values()), progress, PLAIN)
    chosen, alike = supported(engine, found)
    judgement = beside_unknown(first.judgement, first.engine.refitted(chosen.point), alike)
    placed = _placed(first._replace(judgement=judgement), progress)
    if placed.judgement is not judgement:
        return placed
    judgement = dataclasses.replace(judgement, chosen=chosen)
    return placed._replace(engine=engine, found=found, judgement=judgement)


def _placed(solution: Solution, progress: Callable[[str], None]) -> Solution:
    """Return the solution with the blocks that the gap lies in, and the course of what is unexplained."""
    engine, found, judgement = solution.engine, solution.found, solution.judgement
    if judgement.verdict == "none":
        return solution
    if judgement.verdict != "unknown":
        return solution._replace(where=places(engine, judgement.chosen, None))
    if engine.problem.bench:
        return solution._replace(where=[Share("damper", 1.0)])
    progress("asking which block could hold the rest")
    held, state = unexplained(engine, found, judgement.chosen)
    rest = latent(engine.problem, state.point, held.block, held.suspects[held.block])
    if state is not judgement.chosen:
        judgement = beside_unknown(judgement, state)
    return solution._replace(judgement=judgement, where=places(engine, state, held), rest=rest)


def _stated(recording: Recording, solution: Solution, notes: list[str], progress: Callable[[str], None]) -> Diagnosis:
    """State what a solution amounts to on a held-out run; what fails there beside an unknown cause is given up."""
    engine, judgement, posed = solution.engine, solution.judgement, solution.engine.problem
    chosen = judgement.chosen
    progress("holding out a run")
    shrink = shrinks(posed, solution.found.nominal, chosen)
    run = held_out(engine, chosen, shrink)
    calibrated, augmented = trained(engine, chosen, run)
    if judgement.verdict == "unknown" and not chosen.point.terms:
        augmented = solution.found.nominal
    nominal = single(recording.nominal)
    points = (Point(posed.rest), calibrated.point, augmented.point)
    scenarios = [scenario_at(posed, nominal, point) for point in points]
    spread = float(np.std(shrink, ddof=min(1, len(shrink) - 1)))
    found = gaps(posed, scenarios, [run], spread)
    if judgement.verdict == "unknown" and chosen.point.terms and found.shrink < 0.0:
        helpless = beside_unknown(judgement, solution.found.calibrated)
        return _stated(recording, solution._replace(judgement=helpless), notes, progress)
    listed = causes(engine, solution.found, judgement, calibrated, augmented, nominal, run)
    if solution.rest is not None:
        listed = [with_strength(c, solution.rest) if c.effect == solution.random else c for c in listed]
    group = judgement.groups[0] if judgement.groups else []
    asked = experiment(engine, chosen, group) if judgement.verdict == "ambiguous" and not posed.bench else None
    scenario = asked.pop("scenario", None) if asked else None
    relevant = [cause.effect for cause in listed[:10] if cause.probability > 0.003]
    at_work = {solution.random, *(term.effect for term in chosen.point.terms)}
    diagnosis = Diagnosis(
        name=recording.folder.name, verdict=judgement.verdict, sentence="", where=list(solution.where), causes=listed,
        probability_none=judgement.none, probability_unknown=judgement.unknown,
        selected=[name for name in judgement.probabilities if name in at_work], random=solution.random,
        indistinguishable=judgement.groups, experiment=asked, held_out=[run],
        isolable=isolable(recording.header.rig, recording.channels), gap=found,
        notes=[*notes, *losses(recording.header.rig, recording.channels), *measure_coverage(recording).missing],
        augmented=content(posed, augmented.point), experiment_scenario=scenario,
        evidence=collected(posed, points, run, solution.rest, alikeness(engine, chosen, relevant)),
    )  # fmt: skip
    return dataclasses.replace(diagnosis, sentence=answer(diagnosis))
