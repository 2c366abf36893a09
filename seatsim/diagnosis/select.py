"""Subset selection: candidates are screened by linear models, fitted singly, then in sets while the cost falls."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import chain
from typing import NamedTuple

import numpy as np

from seatsim.diagnosis.candidates import Candidate
from seatsim.diagnosis.fit import fit
from seatsim.diagnosis.objective import Evaluation, Linearisation, Objective, Parameters, scale
from seatsim.diagnosis.problem import OutOfTimeError
from seatsim.diagnosis.screen import Sensitivities, measure_sensitivities, name_unstable, screen_candidates


class LinearisedRig(NamedTuple):
    """The nominal rig, the sensitivities to its nuisance parameters about the calibrated one, and to the candidates."""

    nominal: Evaluation
    nuisances: Linearisation
    sensitivities: Sensitivities

    @property
    def calibrated(self) -> Evaluation:
        """The rig with refitted nuisance parameters."""
        return self.nuisances.evaluation


@dataclass(frozen=True)
class Selection:
    """Fitted sets of effects by size, the best first; `sets[0]` holds the calibrated nominal scenario alone.

    `nuisances` holds the sensitivities of the calibrated rig to the nuisance parameters, `sensitivities` those to the
    candidates, `notes` a sentence on each effect that could not be simulated from some start, `proposed` the names of
    sets that another search proposed.
    """

    nominal: Evaluation
    sets: tuple[tuple[Evaluation, ...], ...]
    nuisances: Linearisation
    sensitivities: Sensitivities = field(default=Sensitivities((), {}), kw_only=True)
    notes: tuple[str, ...] = field(default=(), kw_only=True)
    proposed: frozenset[frozenset[str]] = field(default=frozenset(), kw_only=True)

    @property
    def calibrated(self) -> Evaluation:
        """The nominal scenario with its nuisance parameters refitted."""
        return self.sets[0][0]

    @property
    def singles(self) -> dict[str, Evaluation]:
        """The fitted sets of one effect by its name, the best first."""
        return {each.parameters.terms[0].effect: each for sets in self.sets[1:2] for each in sets}

    def linearise(self, evaluation: Evaluation) -> Linearisation:
        """Return a set with the sensitivities of the calibrated rig to the nuisance parameters, which hardly change."""
        return Linearisation(evaluation, self.nuisances.jacobian)

    def list_finalists(self, count: int) -> list[Evaluation]:
        """Return the best sets of each size, so many of a size, and all that were proposed."""
        return [
            each
            for sets in self.sets
            for rank, each in enumerate(sets)
            if rank < count or each.parameters.names in self.proposed
        ]

    def propose(self, evaluations: Sequence[Evaluation]) -> Selection:
        """Return the selection with more sets, of those with the same effects the one that costs less."""
        every = [*chain.from_iterable(self.sets), *evaluations]
        sizes = range(max(len(each.parameters.terms) for each in every) + 1)
        by_size = ([each for each in every if len(each.parameters.terms) == size] for size in sizes)
        sets = tuple(tuple(_best_of_each_set(each)) for each in by_size)
        return replace(self, sets=sets, proposed=frozenset(each.parameters.names for each in evaluations))

    def weigh_again(self, old: Objective, new: Objective) -> LinearisedRig:
        """Return the rig under other weights, its nuisance parameters refitted; nothing is linearised again."""
        nominal, calibrated = new.unhurried.evaluate([self.nominal.parameters, self.calibrated.parameters])
        jacobian = scale(self.nuisances.jacobian, old, new)
        nearest = min(nominal, calibrated, key=lambda each: each.cost)
        refitted = fit(new.unhurried, nearest, Linearisation(calibrated, jacobian))
        sensitivities = self.sensitivities._replace(changes=scale(self.sensitivities.changes, old, new))
        return LinearisedRig(nominal, Linearisation(refitted, jacobian), sensitivities)


def select_effects(
    objective: Objective,
    candidates: Sequence[Candidate],
    progress: Callable[[str], object],
    largest: int = 3,
    rig: LinearisedRig | None = None,
) -> Selection:
    """Fit the nuisance parameters alone, then single effects, then larger sets as long as the cost falls enough.

    Args:
        objective: what is minimised.
        candidates: effects with the starts of their fits.
        progress: called with what is being done.
        largest: most effects of a set; more take time, and explain anything.
        rig: the rig with its sensitivities to the candidates, where they are known.
    """
    settings = objective.settings.selection
    rig = _linearise_rig(objective, candidates) if rig is None else rig
    nuisances, sensitivities = rig.nuisances, rig.sensitivities
    sets: list[list[Evaluation]] = [[rig.calibrated]]
    notes = () if objective.problem.deadline.is_past else name_unstable(candidates, sensitivities.candidates)
    # At the deadline the sets so far are the answer.
    with suppress(OutOfTimeError):
        for size in range(1, largest + 1):
            progress(f"fitting sets of {size}")
            larger = _extend(objective, sets, sensitivities, nuisances)
            if not larger:
                break
            sets.append(larger)
            bases = larger[: settings.beam // size]
            changed = [_fit_variants(objective, each, candidates, nuisances) for each in bases]
            larger[:] = _best_of_each_set([*larger, *chain.from_iterable(changed)])
            if not _gains(objective, sets):
                break
    fitted = tuple(tuple(each) for each in sets)
    return Selection(rig.nominal, fitted, nuisances, sensitivities=sensitivities, notes=notes)


def _linearise_rig(objective: Objective, candidates: Sequence[Candidate]) -> LinearisedRig:
    """Return the rig with refitted nuisance parameters, and its sensitivities to them and to the candidates.

    The refitted rig is what every answer starts from, so that no deadline ends that fit.
    """
    unhurried = objective.unhurried
    nominal = unhurried.evaluate([Parameters(objective.problem.nominal)])[0]
    nuisances = unhurried.linearise_nuisances(nominal)
    calibrated = fit(unhurried, nominal, nuisances)
    sensitivities = measure_sensitivities(objective, calibrated, candidates)
    return LinearisedRig(nominal, Linearisation(calibrated, nuisances.jacobian), sensitivities)


def _gains(objective: Objective, sets: Sequence[Sequence[Evaluation]]) -> bool:
    """Whether the last enlargement lowered the cost enough, and left enough to explain, for a further one."""
    settings = objective.settings.selection
    last, before = sets[-1][0].excess, sets[-2][0].excess
    return last > settings.nothing_left and last < settings.worthwhile * before


def _extend(
    objective: Objective,
    sets: Sequence[Sequence[Evaluation]],
    sensitivities: Sensitivities,
    nuisances: Linearisation,
) -> list[Evaluation]:
    """Return the fitted enlargements of the best sets by one effect, best first, one structure of each set."""
    settings = objective.settings.selection
    bases: Sequence[Evaluation] = sets[-1][: settings.beam]
    starts = list[Evaluation]()
    for base in bases:
        taken = base.parameters.names
        # A first effect of a gap is always tried; others only where a linear model predicts that they help.
        if taken:
            bound = base.rows * (1.0 + bases[0].excess)
        elif base.excess < settings.nothing_left:
            bound = base.cost - objective.settings.decision.least_lowered * base.rows
        else:
            bound = float("inf")
        starts += screen_candidates(objective, base, sensitivities, nuisances, bound, settings.shortlist)
    # Forms of one effect start alike, so that only the best of them is fitted.
    ranked, finalists = _best_of_each_set(starts), settings.finalists
    return _best_of_each_set([*(fit(objective, each, nuisances) for each in ranked[:finalists]), *ranked[finalists:]])


def _fit_variants(
    objective: Objective, best: Evaluation, candidates: Sequence[Candidate], nuisances: Linearisation
) -> list[Evaluation]:
    """Return fits of a set with another form of one effect, or with its form elsewhere, as friction in another part.

    Another form is tried of the effect that was added last, where the set leaves something. Each begins where it costs
    least: at one of its own starts, or where the fit so far ends in the parameters that both have.
    """
    rig, is_open = best.parameters, best.excess > objective.settings.selection.nothing_left
    starts: dict[Hashable, dict[tuple[float, ...], Parameters]] = {}
    for term, values in zip(rig.terms, rig.values, strict=True):
        fitted, others = dict(zip(term.free, values.tolist(), strict=True)), rig.remove(term.effect)
        for each in candidates:
            is_elsewhere = each.is_twin(term) and each.effect not in rig.names
            if is_elsewhere or (is_open and term is rig.terms[-1] and each.is_other_form(term)):
                carried = [fitted.get(name, start) for name, start in zip(each.free, each.start, strict=True)]
                for own in (each.start, tuple(np.clip(carried, each.low, each.high).tolist())):
                    starts.setdefault((term.effect, each.structure), {})[own] = others.add(each, np.array(own))
    begun = objective.evaluate_best([[*form.values()] for form in starts.values()])
    return [fit(objective, each, nuisances) for each in begun if np.isfinite(each.cost)]


def _best_of_each_set(evaluations: Sequence[Evaluation]) -> list[Evaluation]:
    """Return the best evaluation of each set of effects, the best first."""
    best: dict[frozenset[str], Evaluation] = {}
    for evaluation in sorted(evaluations, key=lambda evaluation: evaluation.cost):
        best.setdefault(evaluation.parameters.names, evaluation)
    return list(best.values())
