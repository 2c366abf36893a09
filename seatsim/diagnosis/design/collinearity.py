"""How collinear the sensitivities of effects are in a recording, with the nuisance parameters projected out.

The collinearity of two effects is |cos(p(a), p(b))| of their projected changes (see `projection`): 0 where they share
nothing, 1 where one could stand for the other.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from seatsim.diagnosis.candidates import Candidate, list_candidates
from seatsim.diagnosis.design.projection import measure_cosines, project
from seatsim.diagnosis.fit import fit
from seatsim.diagnosis.objective import Evaluation, Linearisation, Objective
from seatsim.diagnosis.parameters import Parameters
from seatsim.diagnosis.result import Collinearity
from seatsim.schema.arrays import Array


def measure_collinearity(objective: Objective, nuisances: Linearisation, names: Sequence[str]) -> Collinearity:
    """Return the effects that can act on this rig, and how collinear they are.

    Each change is that of the outputs when one effect is added to the rig without effects. A fitted effect has its
    fitted size. Any other is taken in the first structure of its candidate and made about as large as the largest
    fitted change, since the response to friction or play depends on its size. Where an effect may act on several
    channels, the largest collinearity counts.

    Args:
        objective: over all runs.
        nuisances: the rig found, with its sensitivities to the nuisance parameters.
        names: effects to compare.
    """
    rig = nuisances.evaluation.parameters
    base = rig.remove(*names)
    variants = {name: _list_variants(objective, rig, base, name) for name in dict.fromkeys(names)}
    known = [name for name, found in variants.items() if found]
    several = [parameters for name in known for parameters in variants[name]]
    fitted = [name in rig.names for name in known for _ in variants[name]]
    changes = _measure_changes(objective, base, several, fitted)
    sensitivities = stack_jacobian(objective, nuisances)
    deviations = np.full(len(sensitivities), objective.settings.fit.prior_std)
    cosines = np.abs(measure_cosines(project(changes, sensitivities, deviations), objective.settings.design.faint))
    last = np.cumsum([len(variants[name]) for name in known])
    spans = [slice(end - len(variants[name]), end) for name, end in zip(known, last, strict=True)]
    matrix = np.array([[cosines[a, b].max() for b in spans] for a in spans]).reshape(len(known), len(known))
    np.fill_diagonal(matrix, 1.0)
    return Collinearity(known, matrix)


def fit_member(objective: Objective, nuisances: Linearisation, name: str, group: Sequence[str]) -> Evaluation:
    """Return a rig with one member of a group in place of the chosen one, as its last term, fitted to the recording.

    `nuisances` is the rig with its member of the group, and its sensitivities to the nuisance parameters.
    """
    rig = nuisances.evaluation.parameters
    base = rig.remove(*group)
    own = [(t, v) for t, v in zip(rig.terms, rig.values, strict=True) if t.effect == name]
    starts = own or [(c, np.array(c.start)) for c in list_candidates(objective.problem) if c.effect == name]
    evaluations = sorted(objective.evaluate([base.add(*start) for start in starts]), key=lambda found: found.cost)
    begun = evaluations[: objective.settings.design.structures]
    return min((fit(objective, start, nuisances) for start in begun), key=lambda found: found.cost)


def stack_whitened(objective: Objective, whitened: dict[str, Array]) -> Array:
    """Return the whitened numbers of all runs, shape (channels, rows) each, as one vector."""
    return np.concatenate([whitened[run].ravel() for run in objective.problem.runs])


def stack_jacobian(objective: Objective, linearisation: Linearisation) -> Array:
    """Return the Jacobians of all runs, shape (components, channels x rows) each, joined along the rows."""
    return np.concatenate([linearisation.jacobian[run] for run in objective.problem.runs], axis=1)


def _measure_changes(
    objective: Objective, base: Parameters, several: Sequence[Parameters], fitted: Sequence[bool]
) -> Array:
    """Return the whitened changes from a base to rigs, shape (rigs, rows); those not `fitted` are scaled alike."""
    origin, *evaluations = objective.evaluate([base, *several])
    changes = _subtract(objective, origin, evaluations)
    sizes = np.linalg.norm(changes, axis=1)
    if any(fitted):
        largest = max(sizes[k] for k, kept in enumerate(fitted) if kept)
        factors = largest / np.maximum(sizes, objective.settings.design.faint)
        stretch = objective.settings.design.stretch
        moved = [p if kept else _enlarge(p, f, stretch) for p, kept, f in zip(several, fitted, factors, strict=True)]
        changes = _subtract(objective, origin, objective.evaluate(moved))
    return changes


def _subtract(objective: Objective, origin: Evaluation, evaluations: Sequence[Evaluation]) -> Array:
    start = stack_whitened(objective, origin.whitened)
    changes = np.array([stack_whitened(objective, moved.whitened) - start for moved in evaluations])
    changes = changes.reshape(len(evaluations), start.size)
    changes[~np.all(np.isfinite(changes), axis=1)] = 0.0
    return changes


def _enlarge(parameters: Parameters, factor: float, stretch: float) -> Parameters:
    """Return the rig with the first parameter of its last effect scaled by a limited factor, within its bounds."""
    term, values = parameters.terms[-1], parameters.values[-1].copy()
    values[0] = np.clip(values[0] * np.clip(factor, 1.0 / stretch, stretch), term.low[0], term.high[0])
    return Parameters(parameters.deviations, parameters.terms, (*parameters.values[:-1], values))


def _list_variants(objective: Objective, rig: Parameters, base: Parameters, name: str) -> list[Parameters]:
    """Return the base with one effect, as the rig has it or as a candidate starts, once for each of its channels."""
    for term, values in zip(rig.terms, rig.values, strict=True):
        if term.effect == name:
            return [base.add(term, values)]
    first: dict[str, Candidate] = {}
    for candidate in list_candidates(objective.problem):
        if candidate.effect == name:
            first.setdefault(str(candidate.fixed.get("channel")), candidate)
    return [base.add(candidate, np.array(candidate.start)) for candidate in first.values()]
