"""The report of a diagnosis: what is the matter, what to do, how far the gap shrinks, and the evidence."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from seatsim.dampers.base import DAMPERS
from seatsim.diagnosis.result import Cause, Diagnosis
from seatsim.plots.diagnosis.draw import plot_diagnosis
from seatsim.recordings.header import NOT_STATED
from seatsim.report import diagnosis_sections
from seatsim.report.blocks import Block, Report, show_pictures
from seatsim.report.composing import Closing, compose
from seatsim.report.credibility import Factor, count_variations, state_intervals, trace_inputs, validate, verify
from seatsim.report.formatting import format_sentence, read_words, say_noise
from seatsim.schema.fields import UNUSUAL
from seatsim.schema.printing import format_percent
from seatsim.schema.text import join_names

_NEARLY_ALL = 0.98


def report_diagnosis(diagnosis: Diagnosis) -> Report:
    """Return the report of a diagnosis; without a gap it has no evidence for causes."""
    figures = plot_diagnosis(diagnosis)
    sections: dict[str, Sequence[Block]] = {
        "causes": diagnosis_sections.show_causes(diagnosis, figures),
        "gaps": diagnosis_sections.show_gaps(diagnosis, figures),
        "signals": diagnosis_sections.show_signals(diagnosis, figures),
        "missing": diagnosis_sections.show_discrepancy(diagnosis, figures),
        "forms": diagnosis_sections.show_forms(diagnosis),
        "confusions": diagnosis_sections.show_confusions(diagnosis),
        "maps": show_pictures(figures, "maps"),
        "budget": diagnosis_sections.show_budget(diagnosis),
        "comfort": diagnosis_sections.show_comfort(diagnosis),
    }
    if diagnosis.verdict == "none":
        sections |= {anchor: [] for anchor in ("causes", "missing", "confusions", "maps")}
    answer = [say_diagnosis(diagnosis), format_sentence(diagnosis.sentence)]
    closing = Closing(
        diagnosis_sections.list_notes(diagnosis), judge_diagnosis(diagnosis), f"seatsim diagnose {diagnosis.name}"
    )
    report = compose("diagnosis", f"Diagnosis: {diagnosis.name}", answer, advise(diagnosis), sections, closing)
    badge = (diagnosis.verdict, *read_words().verdicts[diagnosis.verdict])
    return report._replace(badge=badge, doubt=f"{_say_probabilities(diagnosis)} {report.doubt}".strip())


def judge_diagnosis(diagnosis: Diagnosis) -> list[Factor]:
    """Return how far a diagnosis may be trusted, on the runs that it held out."""
    gap, runs, held_out = diagnosis.gap, len(diagnosis.gap.by_run), len(diagnosis.held_out)
    spreads = {trace.channel: float(np.std(trace.measured)) for trace in diagnosis.evidence.traces}
    steps = [each.u_num / spreads[each.channel] for each in diagnosis.error_budget if spreads.get(each.channel, 0) > 0]
    model = diagnosis.augmented.get("damper", {})
    name = model.get("model") if isinstance(model, Mapping) else None
    fitted = any(cause.effect in diagnosis.selected and cause.parameters for cause in diagnosis.causes)
    has_interval = all(map(math.isfinite, gap.shrink_interval))
    intervals = [*["the parameters of the effects"] * fitted, *["the shrink of the gap"] * has_interval]
    return [
        verify("half the step changes an output by up to {}", steps),
        validate(max(runs, held_out), held_out, gap.after.overall, gap.floor.overall),
        trace_inputs(
            [note for note in diagnosis.notes if UNUSUAL in note],
            [DAMPERS.find(name)] if name in DAMPERS.names() else [],
            bool(diagnosis.parameters) and not any(NOT_STATED in note for note in diagnosis.notes),
            [each.name for each in diagnosis.parameters if each.at_bound],
        ),
        state_intervals(intervals, fitted, has_interval, bool(diagnosis.error_budget)),
        count_variations(runs, [each.name for each in diagnosis.parameters]),
    ]


def say_diagnosis(diagnosis: Diagnosis) -> str:
    """Return the answer as an engineer says it: what is the matter, and how much of the gap that explains."""
    gap = diagnosis.gap
    size, noise = format_percent(gap.before.overall), say_noise(gap.floor.overall)
    if diagnosis.verdict == "none":
        return (
            f"The simulation fits the recording: it is off by {size} of the signals' spread; {noise}, and the tolerance"
            " of the parameters allows the rest."
        )
    causes = _select(diagnosis)
    if not causes:
        where = f", in the {diagnosis.where[0].block}" if diagnosis.where else ""
        return f"Something that no known effect explains makes the gap of {size}{where}; {noise}."
    clauses = join_names([diagnosis_sections.say_cause(cause) for cause in causes])
    if diagnosis.verdict == "ambiguous":
        others = [name for group in diagnosis.indistinguishable for name in group if name not in diagnosis.selected]
        if others:
            clauses = f"either {clauses}, or it is {join_names(others, 'or')}, which look the same here"
    return f"{clauses[0].upper()}{clauses[1:]}. {_say_share(diagnosis)}"


def advise(diagnosis: Diagnosis) -> list[str]:
    """Return what to do next: look at the rig, decide between equals, use the scenario."""
    if diagnosis.verdict == "none":
        return ["Use the nominal scenario as it is; test it on a recording of another road or driver."]
    found = [diagnosis_sections.say_action(name) for name in diagnosis.selected]
    experiment = diagnosis.experiment
    if experiment is not None:
        file = "; its scenario is experiment.yaml beside this report" if experiment.scenario is not None else ""
        what = f"to tell the likely causes apart: {experiment.name.replace('_', ' ')}{file}. {experiment.reason}"
        found.append(format_sentence(what))
    if diagnosis.verdict == "unknown":
        found.append(
            "Read the section on the missing signal: it shows over which motion or current the simulation lacks"
            " something. Measure that, or write it as an effect of your own."
        )
        if diagnosis.where:
            found.append(f"Begin with the {diagnosis.where[0].block} of the rig: most of what is unexplained is there.")
    at_bound = [each.name for each in diagnosis.parameters if each.at_bound]
    if at_bound:
        found.append(f"Measure {join_names(at_bound)}: the refit stops at the bound of its tolerance.")
    at_bound = [cause.effect for cause in _select(diagnosis) if cause.at_bound]
    if at_bound:
        found.append(f"Confirm {join_names(at_bound)} first: all of its size lies at the end of its range.")
    what = "the refitted parameters and the effects found" if diagnosis.selected else "the refitted parameters"
    command = "seatsim gap augmented.yaml OTHER_RECORDING"
    found.append(f"Check the result on another recording: {command} (the nominal scenario with {what}).")
    return found


def _say_probabilities(diagnosis: Diagnosis) -> str:
    """Return how sure the diagnosis is of its causes."""
    rest = [cause for cause in diagnosis.causes if cause.effect not in diagnosis.selected]
    named = [f"{cause.effect} {format_percent(cause.probability)}" for cause in _select(diagnosis) if cause.probability]
    following = [f"{'next ' * bool(named)}{cause.effect} {format_percent(cause.probability)}" for cause in rest[:1]]
    another = [f"another cause {format_percent(diagnosis.probability_unknown)}"]
    return f"Probability of being at work: {', '.join([*named, *following, *another])}."


def _select(diagnosis: Diagnosis) -> list[Cause]:
    by_name = {cause.effect: cause for cause in diagnosis.causes}
    return [by_name.get(name, Cause(name, 1.0, 0.0, {})) for name in diagnosis.selected]


def _say_share(diagnosis: Diagnosis) -> str:
    """Return how much of the gap that can be removed is gone, on the run held out."""
    gap = diagnosis.gap
    removable = gap.before.overall - gap.floor.overall
    if not removable > 0 or gap.after.overall >= gap.before.overall:
        return "That takes nothing off the gap of the run held out."
    share = min(1.0, (gap.before.overall - gap.after.overall) / removable)
    subject = "That explains" if len(diagnosis.selected) == 1 else "Together that explains"
    if diagnosis.verdict == "unknown":
        return f"{subject} {format_percent(share)} of the gap; no known effect explains the rest."
    left = f"; what is left is {format_percent(gap.after.overall)} of the signals' spread"
    rest = "" if share > _NEARLY_ALL else left
    return f"{subject} {format_percent(share)} of the gap beyond noise{rest}."
