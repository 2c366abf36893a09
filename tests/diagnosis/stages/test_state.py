"""The statement of a solution: what is held out, what is given up there, and what a diagnosis then says."""

import dataclasses

import numpy as np
import pytest

from seatsim.diagnosis.decide import Decision
from seatsim.diagnosis.select import Selection
from seatsim.diagnosis.solution import Solution
from seatsim.diagnosis.validate import validate_on_held_out

from ..builders import refit
from .toy import CHANNELS, Added, offer, place, pose, record, weigh_stated

RUNS = {"first": 300, "second": 240, "third": 360}
ONE, TWO = offer("damper.seal_friction", "one"), offer("suspension.friction", "two")


TRUTH = (Added("one", 0.8), Added("two", 0.3))


def make_objective(folder, runs=RUNS, truth=TRUTH):
    return weigh_stated(pose(record(folder, truth, runs, channels=CHANNELS[:4], seed=2)))


def make_solution(objective, verdict, *terms, **changed):
    """Return a solution whose set is the terms, fitted; `changed` are fields of the decision or of the solution."""
    problem = objective.problem
    nominal, calibrated = objective.evaluate([place(problem)])[0], refit(objective, place(problem))
    single_effects = tuple(refit(objective, place(problem, (term, 1.0))) for term in (ONE, TWO))
    chosen = refit(objective, place(problem, *((term, 1.0) for term in terms))) if terms else calibrated
    probabilities = dict.fromkeys(["driver.mass", TWO.effect, ONE.effect, "coil.lag"], 0.001)
    probabilities |= {term.effect: 0.9 for term in terms}
    decision = Decision(verdict, chosen, changed.pop("groups", []), probabilities, 0.02, 0.3)
    selection = Selection(nominal, ((calibrated,), single_effects), objective.linearise_nuisances(calibrated))
    return Solution(objective, selection, decision, **changed)


@pytest.fixture(scope="module")
def objective(folder):
    return make_objective(folder)


def harmful(objective, verdict):
    """Return a solution whose effect, as fitted, was of help in two runs, and is the wrong way round in the third."""
    problem, measured = objective.problem, {}
    for run in problem.runs:
        amount = -1.5 if run == "third" else 1.0
        measured[run] = problem.simulated(run, problem.nominal, (Added("one", amount),))
    other = dataclasses.replace(objective, problem=dataclasses.replace(problem, measured=measured))
    tables = {run: dict(table) for run, table in problem.recording.tables.items()}
    for run, values in measured.items():
        for name, row in zip(problem.channels, values, strict=True):
            whole = np.zeros(len(tables[run][name]))
            whole[200 : 200 + len(row)] = row
            tables[run][name] = whole
    recording = dataclasses.replace(problem.recording, tables=tables)
    problem = dataclasses.replace(other.problem, recording=recording)
    return make_solution(dataclasses.replace(other, problem=problem), verdict, ONE)


def test_a_known_effect_that_takes_too_little_off_the_held_out_run_stays_beside_an_unknown_cause(objective):
    solution = harmful(objective, "known")
    found = validate_on_held_out(solution)
    assert found.gaps.shrink < 0.0 and found.augmented.parameters.names == {ONE.effect}
    decision = found.solution.decision
    assert decision.verdict == "unknown" and decision.unknown == 0.55
    assert decision.chosen is solution.decision.chosen
    assert decision.probabilities == solution.decision.probabilities


def test_an_effect_beside_an_unknown_cause_that_raises_the_gap_is_given_up_with_a_note(objective):
    found = validate_on_held_out(harmful(objective, "unknown"))
    decision, (note,) = found.solution.decision, found.solution.selection.notes
    assert note.startswith(f"{ONE.effect} was given up, since it raises the gap of")
    assert decision.verdict == "unknown" and not decision.chosen.parameters.terms
    assert decision.probabilities[ONE.effect] == 0.0 and not found.augmented.parameters.terms
