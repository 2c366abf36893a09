"""How well effects are told apart by a recording, or by a further experiment.

With whitened changes a of the outputs, sensitivities S of parameters u and their prior standard deviations d, all
components without unit, the nuisance parameters are projected out of each change,

    p(a) = [a - S' u, -u / d],   u = (S S' + diag(d)^-2)^-1 S a,

so that `|p(a)|^2` is the cost of a that remains after the best refit of the parameters under their prior. The
collinearity of two effects is |cos(p(a), p(b))|: 0 where they share nothing, 1 where one could stand for the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations
from typing import NamedTuple

import numpy as np

from seatsim.diagnosis.candidates import Candidate, list_candidates
from seatsim.diagnosis.fit import fit
from seatsim.diagnosis.objective import Evaluation, Linearisation, Objective, Parameters
from seatsim.diagnosis.result import Collinearity
from seatsim.schema.arrays import Array


def project(changes: Array, sensitivities: Array, deviations: Array) -> Array:
    """Return p(a) of changes, shape (changes, rows + parameters).

    Args:
        changes: whitened changes of the outputs, shape (changes, rows).
        sensitivities: of the parameters, shape (parameters, rows).
        deviations: prior standard deviations of the parameters, shape (parameters,).
    """
    if not len(sensitivities):
        return changes
    precision = np.diag(deviations**-2.0)
    shares = np.linalg.solve(sensitivities @ sensitivities.T + precision, sensitivities @ changes.T).T
    return np.concatenate([changes - shares @ sensitivities, -shares / deviations], axis=1)


def measure_cosines(vectors: Array, faint: float) -> Array:
    """Return the cosine between each pair of rows, shape (rows, rows); 0 where one of them is shorter than `faint`."""
    size = np.linalg.norm(vectors, axis=1)
    unit = vectors / np.where(size > faint, size, np.inf)[:, None]
    return np.clip(unit @ unit.T, -1.0, 1.0)


def measure_likeness(projected: Array) -> float:
    """Return the largest `2 |p(a) p(b)| / (|p(a)|^2 + |p(b)|^2)` over all pairs: a collinearity that sees sizes too.

    Two changes that are both small compared with the noise, whose power is 1, count as the same.
    """
    power = projected @ projected.T
    own = np.diag(power)
    pairs = [(2.0 * abs(power[a, b]) + 1.0) / (own[a] + own[b] + 1.0) for a, b in permutations(range(len(own)), 2)]
    return float(min(max(pairs), 1.0))


class PredictedExperiment(NamedTuple):
    """Outputs of rigs in noise units, shape (rigs, rows); Jacobians of the nuisances and of each rig's own effects."""

    outputs: Array
    nuisances: Array
    own: list[Array]


def measure_separability(
    old: PredictedExperiment, new: PredictedExperiment, nuisance_std: float, effect_std: float
) -> float:
    """Return what a new experiment adds to the distance of the nearest pair of rigs, in noise units.

        d(a, b) = min over u, b of |y_a - y_b(u, b)|,    sqrt(d(old and new)^2 - d(old)^2),

    with the nuisances u under their prior and the rig's own parameters b under a wide one, both linearised.

    Args:
        old: the recording at hand.
        new: the experiment, simulated.
        nuisance_std: prior standard deviation of the nuisances, as a share of their tolerance.
        effect_std: prior standard deviation of the effects' parameters, in their natural sizes.
    """
    gains = []
    for a, b in permutations(range(len(old.outputs)), 2):
        bases = [np.vstack([side.nuisances, side.own[b]]) for side in (old, new)]
        gaps = [(side.outputs[b] - side.outputs[a])[None] for side in (old, new)]
        count = len(old.own[b])
        deviations = np.concatenate([np.full(len(bases[0]) - count, nuisance_std), np.full(count, effect_std)])
        both = project(np.hstack(gaps), np.hstack(bases), deviations)
        gains.append(float(np.sum(both**2) - np.sum(project(gaps[0], bases[0], deviations) ** 2)))
    return float(np.sqrt(max(min(gains), 0.0)))


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
