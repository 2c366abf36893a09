"""The answer: in one sentence, the refitted parameters, and both with the effects found as a scenario file."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.special import stdtrit

from seatsim.diagnosis.objective import AT_BOUND, Parameters
from seatsim.diagnosis.problem import LEAST_REMOVABLE, DiagnosisProblem
from seatsim.diagnosis.result import CalibratedParameter, Cause, Diagnosis, Estimate, Gaps, RunGaps
from seatsim.effects.base import EFFECTS, same_place
from seatsim.recordings.nuisance import SECTIONS, Nuisance
from seatsim.recordings.prediction import QUANTILE
from seatsim.scenario.sections import FILES
from seatsim.schema.arrays import Array
from seatsim.schema.text import join_names

_BETWEEN_EXCITATIONS = 0.03
"""Standard deviation by which the share differs between excitations beyond that between runs, on simulated rigs."""


def write_answer(diagnosis: Diagnosis) -> str:
    """Return the result of a diagnosis in one sentence."""
    gap = diagnosis.gap
    size = f"{gap.before.overall:.3f}"
    if diagnosis.verdict == "none":
        return (
            f"There is no gap that matters beyond noise and the stated tolerance of the parameters: {size} nominal,"
            f" {gap.calibrated.overall:.3f} refitted, {_noise(gap)} (in standard deviations)."
        )
    if diagnosis.verdict == "unknown" and not diagnosis.selected:
        where = f"Something in the {_unexplained(diagnosis)} that no effect of the library explains makes the gap"
        return f"{where}: {size} nominal, {_noise(gap)} (in standard deviations)."
    # What was found stands first, also where something stays unexplained: it is what the reader can act on.
    named = "; ".join(_cause(diagnosis, name) for name in diagnosis.selected)
    sentence = f"{named}: {_taken(gap)}"
    if diagnosis.stochastic:
        sentence += "; its random signal cannot be predicted, so that its share of the gap stays"
    sentence += _alike(diagnosis) + "."
    if diagnosis.verdict == "unknown":
        rest = f" What remains, {gap.after.overall:.3f}, no effect of the library explains; it lies in the"
        sentence += f"{rest} {_unexplained(diagnosis)}."
    return sentence


def _taken(gap: Gaps) -> str:
    """Return a clause on how much of the gap the effects and the refitted parameters take off, here and elsewhere."""
    figures, share = f"{gap.before.overall:.3f} to {gap.after.overall:.3f}, {_noise(gap)}", share_taken(gap)
    if not share > 0.0:
        return f"that takes nothing off the gap of the run held out ({figures})"
    return f"that takes {share:.0%} of the gap that can be removed ({figures}, in standard deviations){_elsewhere(gap)}"


def share_taken(gap: Gaps | RunGaps) -> float:
    """Return the share that is taken of a gap less that of noise; 0 where noise alone makes it, or it grows."""
    removable = gap.before.overall - gap.floor.overall
    return max(0.0, min((gap.before.overall - gap.after.overall) / removable, 1.0)) if removable > 0.0 else 0.0


def _elsewhere(gap: Gaps) -> str:
    """Return a clause on the share to be expected under another excitation, by how runs with a gap to remove differ.

    It is the 90 % prediction interval of one more run, by Student's t, as the standard deviation is that of few runs.
    """
    shares = [share_taken(run) for run in gap.by_run if run.before.overall - run.floor.overall > LEAST_REMOVABLE]
    if len(shares) < 2:
        return ""
    between_runs = float(np.std(shares, ddof=1)) * math.sqrt(1.0 + 1.0 / len(shares))
    half = math.hypot(stdtrit(len(shares) - 1, 0.95) * between_runs, QUANTILE * _BETWEEN_EXCITATIONS)
    low, high = np.clip(float(np.median(shares)) + np.array([-half, half]), 0.0, 1.0)
    return f"; under another excitation {low:.0%} to {high:.0%} are expected"


def _noise(gap: Gaps) -> str:
    return f"noise {gap.floor.overall:.3f}" if gap.floor.overall else "noise not stated"


def _alike(diagnosis: Diagnosis) -> str:
    """Return a clause on the effects that explain the recording as well as the selected ones."""
    return "".join(
        f"; these data cannot tell {first if len(diagnosis.selected) > 1 else 'it'} from {join_names(others)}"
        for first, *others in diagnosis.indistinguishable
    )


def _unexplained(diagnosis: Diagnosis) -> str:
    """Return the block of the unexplained remainder, with the blocks that these channels cannot distinguish from it."""
    first = diagnosis.where[0].block
    together = next((group for group in diagnosis.isolable if first in group), [first])
    return " or the ".join([first, *(block for block in together if block != first)])


def _cause(diagnosis: Diagnosis, name: str) -> str:
    cause = next(cause for cause in diagnosis.causes if cause.effect == name)
    meaning = (EFFECTS.find(name).__doc__ or name).split("\n")[0].split(":")[0].rstrip(".")
    values = _values(cause)
    if cause.at_bound:
        values += "; all of its size lies at the end of its range, so that it may stand for another cause"
    return f"{name} ({meaning[0].lower()}{meaning[1:]}{'; ' + values if values else ''})"


def _values(cause: Cause) -> str:
    parts = []
    for name, found in cause.parameters.items():
        if isinstance(found, Estimate):
            end = ", the end of its range" if found.at_bound else ""
            parts.append(f"{name} {found.value:.3g} {found.unit}".rstrip(" -") + end)
        else:
            parts.append(str(found))
    return ", ".join(parts)


def list_calibrated(parameters: Sequence[Nuisance], deviations: Array) -> list[CalibratedParameter]:
    """List the refitted parameters, of deviations of shape (parameters,)."""
    calibrated = []
    for each, deviation in zip(parameters, deviations.tolist(), strict=True):
        bound, at_bound = (each.at(-1.0), each.at(1.0)), abs(deviation) >= AT_BOUND
        calibrated.append(CalibratedParameter(each.key, each.nominal, each.at(deviation), bound, at_bound, each.unit))
    return calibrated


def describe_bounds(parameters: Sequence[CalibratedParameter]) -> list[str]:
    """Return a sentence on the parameters that would be refitted beyond their tolerance, none where there is none."""
    held = [f"{each.name} {each.nominal:.4g} (fitted {each.value:.4g})" for each in parameters if each.at_bound]
    advice = "check these nominal values, or state a wider tolerance"
    return [f"at the bound of their tolerance: {', '.join(held)}; {advice}"] if held else []


def write_augmented(problem: DiagnosisProblem, parameters: Parameters) -> dict[str, object]:
    """Return the content of `augmented.yaml`."""
    source = problem.scenario.source
    assert source is not None
    content = {str(key): _copy_plain(part) for key, part in source.data.items()}
    for parameter, deviation in zip(problem.parameters, parameters.deviations, strict=True):
        section = content
        for key in SECTIONS[parameter.section].split("."):
            inner = section.setdefault(key, {})
            assert isinstance(inner, dict)
            section = inner
        section[parameter.name] = parameter.at(deviation)
    for name, key in FILES:
        stated = content.get(name)
        if isinstance(stated, dict) and isinstance(stated.get(key), str):
            # A file is named from the folder of the nominal scenario, while this content goes to another one.
            stated[key] = str((source.path.parent / stated[key]).resolve())
    present = content.get("effects", [])
    assert isinstance(present, list)
    # An effect found replaces the one that the nominal scenario has at its place, as in the rig that was fitted.
    kept = [
        entry
        for entry, effect in zip(present, problem.scenario.effects, strict=True)
        if not any(same_place(effect, found) for found in parameters.effects)
    ]
    # A YAML file can hold Python floats only; strings stay strings.
    added = [
        {name: float(value) if isinstance(value, int | float) else value for name, value in found._asdict().items()}
        for found in parameters.effects
    ]
    pairs = zip(parameters.terms, added, strict=True)
    content["effects"] = [*kept, *({"effect": term.effect, "parameters": values} for term, values in pairs)]
    return content


def _copy_plain(value: object) -> object:
    """Return the content of a YAML file as plain lists and mappings, without the line numbers that its reader keeps."""
    if isinstance(value, dict):
        return {str(key): _copy_plain(part) for key, part in value.items()}
    if isinstance(value, list):
        return [_copy_plain(part) for part in value]
    return value
