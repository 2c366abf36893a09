"""Statement of a solution: its gaps on a held-out run, with the evidence for it."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence

import numpy as np

from seatsim.diagnosis.alternatives import are_forms_due, compare_damper_forms, describe_forms, describe_obstacle
from seatsim.diagnosis.answer import list_calibrated, write_answer, write_augmented
from seatsim.diagnosis.decide import Decision
from seatsim.diagnosis.design.experiment import propose_experiment
from seatsim.diagnosis.design.isolability import describe_missing_sensors, find_isolable_groups
from seatsim.diagnosis.design.separability import measure_collinearity
from seatsim.diagnosis.estimates import compare_comfort, estimate_causes, trace_motion, trace_replayed, trace_run
from seatsim.diagnosis.fit import fit
from seatsim.diagnosis.localise.discrepancy import show_discrepancy
from seatsim.diagnosis.localise.disturbance import add_strength
from seatsim.diagnosis.movement import name_immaterial, share_removable
from seatsim.diagnosis.objective import Evaluation, Linearisation, Objective, Parameters
from seatsim.diagnosis.result import Cause, DamperForm, Diagnosis, Evidence, Gaps, ProposedExperiment
from seatsim.diagnosis.select import Selection
from seatsim.diagnosis.solution import Solution, call_unknown, decide_without
from seatsim.diagnosis.validate import (
    ReplayedRun,
    choose_held_out_run,
    choose_typical_run,
    list_gaps,
    make_scenario,
    measure_gaps,
    refit_without,
    replay_runs,
    shrink_by_run,
    state_model_error,
)
from seatsim.recordings.quality.coverage import list_unvisited
from seatsim.recordings.validation import budget_errors
from seatsim.scenario.scenario import Scenario
from seatsim.schema.errors import RunError


@dataclasses.dataclass(frozen=True)
class _Validation:
    """A solution on a run held out of its fits: the rigs fitted without the run, and the gaps that they leave on it.

    `runs` holds every run, replayed with the nominal, the calibrated and the augmented scenario, the three `scenarios`.
    `found` is the rig of the solution, fitted to all runs, with its sensitivities to the nuisance parameters.
    """

    solution: Solution
    found: Linearisation
    run: str
    calibrated: Evaluation
    augmented: Evaluation
    scenarios: tuple[Scenario, Scenario, Scenario]
    runs: Sequence[ReplayedRun]
    gaps: Gaps

    @property
    def fitted(self) -> Parameters:
        """Parameters of the augmented rig, of the calibrated one where no effect is stated."""
        return (self.augmented if self.augmented.parameters.terms else self.calibrated).parameters

    @property
    def rigs(self) -> tuple[Parameters, Parameters, Parameters]:
        """Parameters of the nominal, the calibrated and the augmented rig."""
        nominal = Parameters(self.solution.objective.problem.nominal)
        return nominal, self.calibrated.parameters, self.augmented.parameters


def validate_on_held_out(solution: Solution) -> _Validation:
    """Return a solution assessed on a held-out run; effects that fail there beside an unknown cause are dropped."""
    objective, decision, selection = solution.objective, solution.decision, solution.selection
    problem, chosen = objective.problem, decision.chosen
    shrink = shrink_by_run(problem, selection.nominal, chosen)
    if decision.verdict == "unknown":
        # Runs differ in how much of the gap is the unknown cause's own.
        run = choose_typical_run(problem, selection.nominal, chosen)
    else:
        run = choose_held_out_run(problem, chosen, shrink, problem.settings.validation.quantile)
    found = objective.linearise_nuisances(chosen) if chosen.parameters.terms else selection.nuisances
    calibrated, augmented = refit_without(objective, selection.nuisances, found, run)
    if decision.verdict == "unknown" and not chosen.parameters.terms:
        augmented = selection.nominal
    nominal = problem.recording.nominal
    rigs = Parameters(problem.nominal), calibrated.parameters, augmented.parameters
    first, second, third = (make_scenario(problem, nominal, rig) for rig in rigs)
    try:
        runs = replay_runs(problem, (first, second, third))
    except RunError:
        if not chosen.parameters.terms:
            raise
        return validate_on_held_out(_give_up(solution, f"cannot be simulated as fitted without {run}"))
    if weak := name_immaterial(problem, objective.evaluate([augmented.parameters])[0]):
        reason = f"moves no channel by a material size as fitted without {run}"
        return validate_on_held_out(_give_up(solution, reason, weak))
    # A single run has no spread: its standard deviation with n - 1 degrees of freedom would be NaN.
    spread = float(np.std(shrink, ddof=min(1, len(shrink) - 1)))
    gaps = measure_gaps(problem, next(each for each in runs if each.name == run), spread)
    gaps = dataclasses.replace(gaps, by_run=list_gaps(problem, runs))
    raised = _name_raised_gap(gaps, run)
    if decision.verdict == "unknown" and chosen.parameters.terms and raised:
        return validate_on_held_out(_give_up(solution, f"raises {raised} as fitted without {run}"))
    if not solution.stochastic and decision.verdict in ("known", "ambiguous"):
        taken = share_removable(objective.on_runs([run]), gaps.before.overall, gaps.after.overall)
        if taken < problem.settings.decision.least_taken:
            solution = solution._replace(decision=call_unknown(problem.settings.decision, decision))
    return _Validation(solution, found, run, calibrated, augmented, (first, second, third), runs, gaps)


def _name_raised_gap(gaps: Gaps, held_out: str) -> str:
    """Return which gap the augmented scenario raises above the nominal's, in words; an empty word for none."""
    if gaps.after.overall >= gaps.before.overall:
        return f"the gap of {held_out}"
    raised = sum(run.after.overall**2 for run in gaps.by_run) > sum(run.before.overall**2 for run in gaps.by_run)
    return "the gap of all runs" if raised else ""


def _give_up(solution: Solution, reason: str, given_up: Sequence[str] = ()) -> Solution:
    """Return the solution without some of its effects, all where none is named; a note names them with the reason."""
    objective, decision, selection = solution.objective, solution.decision, solution.selection
    given_up = given_up or sorted(decision.chosen.parameters.names)
    noted = dataclasses.replace(
        selection, notes=(*selection.notes, f"{' with '.join(given_up)} was given up, since it {reason}")
    )
    kept = decision.chosen.parameters.remove(*given_up)
    rig = selection.calibrated
    if kept.terms:
        rig = fit(objective, objective.evaluate([kept])[0], selection.nuisances)
    left = decide_without(objective.problem, decision, rig, given_up)
    where = () if left.verdict == "none" else solution.where
    return solution._replace(selection=noted, decision=left, where=where)


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
    at_bound = problem.settings.widening.at_bound
    at_work = {solution.stochastic, *decision.chosen.parameters.names}
    diagnosis = Diagnosis(
        name=recording.folder.name, verdict=decision.verdict, sentence="", where=list(solution.where), causes=causes,
        probability_none=decision.none, probability_unknown=decision.unknown,
        selected=[name for name in decision.probabilities if name in at_work], stochastic=solution.stochastic,
        indistinguishable=decision.groups,
        experiment=_propose_experiment(objective, solution.selection, decision, validation.found),
        held_out=[validation.run], isolable=find_isolable_groups(rig, channels), gap=validation.gaps,
        notes=[
            *notes, *solution.selection.notes, *describe_missing_sensors(rig, channels), *asked,
            *list_unvisited(recording),
        ],
        augmented=write_augmented(problem, validation.augmented.parameters),
        evidence=_collect_evidence(validation, causes), alternatives=forms,
        parameters=list_calibrated(problem.parameters, validation.fitted.deviations, at_bound),
        model_error=state_model_error(problem, runs),
        error_budget=budget_errors(validation.scenarios[2], recording, validation.run, problem.channels),
    )  # fmt: skip
    said = describe_forms(forms, diagnosis.gap, problem.settings.damper_forms.better)
    return dataclasses.replace(diagnosis, sentence=" ".join(filter(None, (write_answer(diagnosis), said))))


def _list_causes(validation: _Validation) -> list[Cause]:
    """Return every effect with its probability, shrink and parameters; a stochastic one with its strength."""
    solution, found = validation.solution, validation.solution.discrepancy
    causes = estimate_causes(
        solution.objective,
        solution.selection,
        solution.decision,
        validation.calibrated,
        Linearisation(validation.augmented, validation.found.jacobian),
        validation.run,
    )
    if found is None:
        return causes
    return [add_strength(cause, found) if cause.effect == solution.stochastic else cause for cause in causes]


def _list_alternatives(validation: _Validation, asked: bool, progress: Callable[[str], object]) -> list[DamperForm]:
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
    # The members were fitted in sets of the same size; the rig found is the first that holds one of them.
    fitted = [found.evaluation, *selection.sets[len(found.evaluation.parameters.terms)]]
    members = {name: next(each for each in fitted if name in each.parameters.names) for name in decision.groups[0]}
    return propose_experiment(objective, found, members)


def _collect_evidence(validation: _Validation, causes: Sequence[Cause]) -> Evidence:
    """Return the content of the report's figures, on the held-out run."""
    solution, run = validation.solution, validation.run
    problem, settings = solution.objective.problem.as_recorded(), solution.objective.settings.design
    traces = trace_run(problem, validation.rigs, run)
    found = solution.discrepancy
    shown = None if found is None else show_discrepancy(problem, found, run)
    relevant = [c.effect for c in causes[: settings.listed] if c.probability > settings.listed_probability]
    collinearity = measure_collinearity(solution.objective, solution.selection, relevant)
    others = trace_replayed(problem, [each for each in validation.runs if each.name != run])
    motion = trace_motion(problem, run)
    return Evidence(traces, motion, shown, collinearity, compare_comfort(traces), others)
