"""Statement of a solution: its gaps on a held-out run, with the evidence for it."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from itertools import chain

from seatsim.diagnosis.alternatives import are_forms_due, compare_damper_forms, describe_forms, describe_obstacle
from seatsim.diagnosis.answer import describe_bounds, list_calibrated, write_answer, write_augmented
from seatsim.diagnosis.decide import Decision
from seatsim.diagnosis.design.experiment import propose_experiment
from seatsim.diagnosis.design.isolability import describe_missing_sensors, find_isolable_groups
from seatsim.diagnosis.design.separability import measure_collinearity
from seatsim.diagnosis.estimates import compare_comfort, estimate_causes, trace_motion, trace_replayed
from seatsim.diagnosis.localise.discrepancy import show_discrepancy
from seatsim.diagnosis.localise.disturbance import add_strength
from seatsim.diagnosis.objective import Linearisation, Objective
from seatsim.diagnosis.result import Cause, DamperForm, Diagnosis, Evidence, ProposedExperiment
from seatsim.diagnosis.select import Selection
from seatsim.diagnosis.solution import Solution
from seatsim.diagnosis.validate import Validation, state_model_error, validate_on_held_out
from seatsim.recordings.quality.coverage import list_unvisited
from seatsim.recordings.validation import budget_errors

_MOST_LISTED, _LEAST_PROBABILITY = 10, 0.003
"""Most effects of the collinearity table, and the least probability of one."""


def state_diagnosis(
    solution: Solution, notes: Sequence[str], progress: Callable[[str], object], damper_forms: bool = False
) -> Diagnosis:
    """Return the diagnosis that states a solution; `notes` are sentences on the quality of the data.

    Other models of the damper are tried where the damper force stays open, with `damper_forms` in every case.
    """
    progress("holding out a run")
    validation = validate_on_held_out(solution)
    solution, causes, runs = validation.solution, _list_causes(validation), validation.runs
    objective, problem = solution.objective, solution.objective.problem
    recording = problem.recording
    rig, channels = recording.header.rig, recording.channels
    decision = solution.decision
    forms = _list_alternatives(validation, damper_forms, progress)
    none = describe_obstacle(problem) or "No other form of the damper was found to fit its force better."
    asked = [none] if damper_forms and not forms else []
    at_work = {solution.stochastic, *decision.chosen.parameters.names}
    parameters = list_calibrated(problem.parameters, validation.fitted.deviations)
    diagnosis = Diagnosis(
        name=recording.folder.name, verdict=decision.verdict, sentence="", where=list(solution.where), causes=causes,
        probability_none=decision.none, probability_unknown=decision.unknown,
        selected=[name for name in decision.probabilities if name in at_work], stochastic=solution.stochastic,
        indistinguishable=decision.groups,
        experiment=_propose_experiment(objective, solution.selection, decision, validation.found),
        held_out=[validation.run], isolable=find_isolable_groups(rig, channels), gap=validation.gaps,
        notes=[
            *notes, *describe_bounds(parameters), *solution.selection.notes,
            *describe_missing_sensors(rig, channels), *asked, *list_unvisited(recording),
        ],
        augmented=write_augmented(problem, validation.augmented.parameters),
        evidence=_collect_evidence(validation, causes), alternatives=forms,
        parameters=parameters,
        model_error=state_model_error(problem, runs),
        error_budget=budget_errors(validation.scenarios[2], recording, validation.run, problem.channels),
    )  # fmt: skip
    said = describe_forms(forms, diagnosis.gap, problem.settings.damper_forms.better)
    return dataclasses.replace(diagnosis, sentence=" ".join(filter(None, (write_answer(diagnosis), said))))


def _list_causes(validation: Validation) -> list[Cause]:
    """Return every effect with its probability, shrink and parameters; a stochastic one with its strength."""
    solution, found = validation.solution, validation.solution.discrepancy
    augmented = Linearisation(validation.augmented, validation.found.jacobian)
    causes = estimate_causes(solution, validation.calibrated, augmented, validation.run)
    if found is None:
        return causes
    return [add_strength(cause, found) if cause.effect == solution.stochastic else cause for cause in causes]


def _list_alternatives(validation: Validation, asked: bool, progress: Callable[[str], object]) -> list[DamperForm]:
    """Return other models of the damper, none where they are neither asked for nor due, or cannot be judged."""
    problem, verdict = validation.solution.objective.problem, validation.solution.decision.verdict
    due = not describe_obstacle(problem) if asked else are_forms_due(problem, validation.gaps, verdict)
    if not due:
        return []
    progress("trying other forms of the damper")
    _, calibrated, augmented = validation.scenarios
    return compare_damper_forms(problem, calibrated, augmented, validation.run)


def _propose_experiment(
    objective: Objective, selection: Selection, decision: Decision, found: Linearisation
) -> ProposedExperiment | None:
    """Return the experiment that separates the first group of equivalent effects, None where there is no group."""
    if decision.verdict != "ambiguous":
        return None
    # The members were mostly fitted in sets of the same size; the rig found is the first that holds one of them.
    of_size = selection.sets[len(found.evaluation.parameters.terms)]
    fitted = [found.evaluation, *of_size, *chain.from_iterable(selection.sets)]
    members = {name: next(each for each in fitted if name in each.parameters.names) for name in decision.groups[0]}
    return propose_experiment(objective, found, members)


def _collect_evidence(validation: Validation, causes: Sequence[Cause]) -> Evidence:
    """Return the content of the report's figures, on the held-out run."""
    solution, run = validation.solution, validation.run
    problem, found = solution.objective.problem, solution.discrepancy
    traces = trace_replayed(problem, validation.runs)
    held_out, others = ([each for each in traces if (each.run == run) is is_it] for is_it in (True, False))
    shown = None if found is None else show_discrepancy(problem, found, run)
    relevant = [c.effect for c in causes[:_MOST_LISTED] if c.probability > _LEAST_PROBABILITY]
    collinearity = measure_collinearity(solution.objective, solution.selection, relevant)
    motion = trace_motion(problem, run)
    return Evidence(held_out, motion, shown, collinearity, compare_comfort(held_out), others)
