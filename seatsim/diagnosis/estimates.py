"""Evidence of a diagnosis: every effect's own shrink, its parameters with their errors, and the report's signals."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from seatsim.diagnosis.objective import AT_BOUND, Evaluation, Linearisation, Objective
from seatsim.diagnosis.problem import DiagnosisProblem, normalise_rms_errors
from seatsim.diagnosis.result import Cause, ComfortFigure, Estimate, Trace
from seatsim.diagnosis.solution import Solution
from seatsim.diagnosis.uncertainty import estimate_standard_deviations
from seatsim.diagnosis.validate import ReplayedRun
from seatsim.metrics.motion import rms
from seatsim.schema.arrays import Array
from seatsim.schema.fields import describe

_QUOTED = ("driver_acceleration", "frame_acceleration", "suspension_displacement")
"""Channels whose RMS the report states."""
_STATED_DIGITS = 2
"""Significant digits to which a probability is known."""
_LEAST_TIME = 0.03
"""Least standard deviation of a time, in intervals between rows: a tenth of what rounding to whole rows makes."""
_SMOOTHED_ROWS = 5
"""Rows over which a displacement is averaged before its slope is drawn."""


def estimate_causes(solution: Solution, calibrated: Evaluation, augmented: Linearisation, run: str) -> list[Cause]:
    """Return every effect, ranked by probability, with its own shrink on a held-out run and its parameters.

    Args:
        solution: its objective is over all runs, its fitted sets of one effect give each effect's own shrink and
            parameters, and its decision the probabilities.
        calibrated: the rig with refitted parameters, fitted without the run.
        augmented: the rig with the effects chosen, fitted without the run, which gives their parameters.
        run: held out of the fits.
    """
    objective, selection = solution.objective, solution.selection
    held_out = objective.on_runs([run])
    base = normalise_rms_errors(held_out.problem, held_out.evaluate([calibrated.parameters])[0].residuals)
    # Single effects share one linearisation of the nuisances, about the calibrated rig: one each would take longer than
    # the fits. The chosen effects, whose figures the user acts on, have their own.
    fitted = augmented.evaluation
    chosen = _estimate_parameters(objective.on_runs(list(fitted.whitened)), fitted, augmented)
    causes = []
    for effect, probability in solution.decision.probabilities.items():
        shrink, found = 0.0, chosen.get(effect, _FoundEffect({}, False))
        single = selection.singles.get(effect)
        if single is not None:
            shrink = 1.0 - float(normalise_rms_errors(held_out.problem, single.residuals)[0] / base[0])
            if effect not in chosen:
                found = _estimate_parameters(objective, single, selection.nuisances)[effect]
        # Effects of one set differ in probability by what no evidence can tell; the larger shrink then comes first.
        stated = float(f"{probability:.{_STATED_DIGITS}g}")
        causes.append(Cause(effect, stated, shrink, *found))
    return sorted(causes, key=lambda cause: (-cause.probability, -cause.shrink))


class _FoundEffect(NamedTuple):
    """The fitted parameters of an effect, with the channel it acts on, and whether all of its size is at a bound."""

    parameters: dict[str, Estimate | str]
    at_bound: bool


def _estimate_parameters(
    objective: Objective, evaluation: Evaluation, nuisances: Linearisation
) -> dict[str, _FoundEffect]:
    """Return what was found of each effect."""
    parameters, found = evaluation.parameters, {}
    shortest = _LEAST_TIME / objective.problem.rate
    ends = parameters.split(parameters.find_at_bound(1.0 - AT_BOUND))
    deviations = parameters.split(estimate_standard_deviations(objective, evaluation, nuisances))
    for term, values, deviation, at_end in zip(parameters.terms, parameters.values, deviations, ends, strict=True):
        units = {field.name: field.unit for field in describe(term.cls)}
        estimates: dict[str, Estimate | str] = {}
        if "channel" in term.fixed:
            estimates["channel"] = str(term.fixed["channel"])
        for k, (name, value) in enumerate(zip(term.free, values, strict=True)):
            std = max(float(deviation[k] * term.scale[k]), shortest if units[name] == "s" else 0.0)
            bound = float(term.low[k]), float(term.high[k])
            estimates[name] = Estimate(float(value), std, units[name], bound, bool(at_end[k]))
        found[term.effect] = _FoundEffect(estimates, bool(np.all(at_end[: term.sizes])))
    return found


def trace_replayed(problem: DiagnosisProblem, runs: Sequence[ReplayedRun]) -> list[Trace]:
    """Return the compared rows and channels of runs, each beside those of nominal, calibrated and augmented rig."""
    noise, traces = dict(zip(problem.channels, problem.noise.tolist(), strict=True)), []
    for run in runs:
        samples = problem.measured[run.name].shape[1]
        time = (problem.skip + np.arange(samples)) / problem.rate
        for name in problem.channels:
            several = [each[name][:samples] for each in (run.measured, *run.simulated)]
            unit = problem.recording.channels[name].unit
            traces.append(Trace(run.name, name, unit, noise[name], time, *several))
    return traces


def trace_motion(problem: DiagnosisProblem, run: str) -> dict[str, Array]:
    """Return what a run visited: displacement and velocity of the suspension, coil current and temperature if known."""
    samples = problem.measured[run].shape[1]
    table = {k: v[problem.skip : problem.skip + samples] for k, v in problem.recording.table(run).items()}
    position = table.get("suspension_displacement", table.get("displacement"))
    motion: dict[str, Array] = {name: table[name] for name in ("coil_current", "damper_temperature") if name in table}
    if position is None:
        return motion
    smooth = np.convolve(position, np.ones(_SMOOTHED_ROWS) / _SMOOTHED_ROWS, mode="same")
    return motion | {"displacement": position, "velocity": np.gradient(smooth, 1.0 / problem.rate)}


def compare_comfort(traces: Sequence[Trace]) -> list[ComfortFigure]:
    """Return the RMS of the channels in `_QUOTED`: measured, of the nominal and of the augmented rig."""
    return [
        ComfortFigure("RMS " + name.replace("_", " "), t.unit, rms(t.measured), rms(t.nominal), rms(t.after))
        for name in _QUOTED
        for t in traces
        if t.channel == name
    ]
