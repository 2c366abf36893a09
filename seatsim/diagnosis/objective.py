"""What a fit minimises, its evaluations, and its linearisation, as immutable values.

The rig is driven by the measured floor and command alone, so no measured motion enters a regressor: measured signals
fed into a closed loop would produce spurious causes (endogeneity). The cost is

    sum |whitened residual|^2 + sum (deviation / PRIOR_STD)^2,   -1 <= deviation <= 1,

over the deviations of the nuisance parameters and the free parameters of the effects.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import islice
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from seatsim.diagnosis.candidates import Candidate
from seatsim.diagnosis.noise import NoiseWeights
from seatsim.diagnosis.problem import NEVER, DiagnosisProblem, OutOfTimeError
from seatsim.diagnosis.settings import DiagnosisSettings
from seatsim.schema.arrays import Array
from seatsim.schema.registry import Record

_T = TypeVar("_T", bound=np.generic)


@dataclass(frozen=True)
class Parameters:
    """Deviations of the nuisance parameters, shape (nuisances,), and effects (`terms`) with their free values."""

    deviations: Array
    terms: tuple[Candidate, ...] = ()
    values: tuple[Array, ...] = ()

    @property
    def effects(self) -> list[Record]:
        """Records of the effects."""
        return [term.record(values) for term, values in zip(self.terms, self.values, strict=True)]

    @property
    def names(self) -> frozenset[str]:
        """Names of the effects."""
        return frozenset(term.effect for term in self.terms)

    @property
    def vector(self) -> Array:
        """All parameters in natural sizes, shape (nuisances + free parameters,)."""
        return np.concatenate([self.deviations, *(v / t.scale for t, v in zip(self.terms, self.values, strict=True))])

    @property
    def limits(self) -> tuple[Array, Array]:
        """Bounds of `vector`."""
        ones = np.ones(len(self.deviations))
        low = [np.asarray(t.low) / t.scale for t in self.terms]
        high = [np.asarray(t.high) / t.scale for t in self.terms]
        return np.concatenate([-ones, *low]), np.concatenate([ones, *high])

    def find_at_bound(self, margin: float) -> NDArray[np.bool_]:
        """Return which components of `vector` lie within a margin of a bound, in natural sizes, unless off there."""
        (low, high), vector = self.limits, self.vector
        off = [np.array([t.off.get(name, 0.0) for name in t.free]) / t.scale for t in self.terms]
        is_off = vector == np.concatenate([np.full(len(self.deviations), np.nan), *off])
        return np.asarray((np.minimum(vector - low, high - vector) <= margin) & ~is_off)

    @property
    def nuisance_components(self) -> range:
        """Indices in `vector` of the nuisance parameters."""
        return range(len(self.deviations))

    @property
    def effect_components(self) -> range:
        """Indices in `vector` of the effects' free parameters."""
        return range(len(self.deviations), len(self.deviations) + sum(len(term.free) for term in self.terms))

    def add(self, term: Candidate, values: Array) -> Parameters:
        """Return the parameters with one more effect."""
        return Parameters(self.deviations, (*self.terms, term), (*self.values, values))

    def remove(self, *names: str) -> Parameters:
        """Return the parameters without the effects of these names."""
        kept = [k for k, term in enumerate(self.terms) if term.effect not in names]
        return Parameters(self.deviations, tuple(self.terms[k] for k in kept), tuple(self.values[k] for k in kept))

    def move_to(self, vector: Array) -> Parameters:
        """Return the parameters at another vector, clipped to the bounds, which no rounding exceeds."""
        low, high = self.limits
        vector = np.clip(vector, low, high)
        parts = zip(self.terms, self.split(vector), strict=True)
        # The product may be beyond a bound by a rounding, and no file with such a value would be read.
        values = tuple(np.clip(part * term.scale, term.low, term.high) for term, part in parts)
        return Parameters(vector[: len(self.deviations)], self.terms, values)

    def split(self, components: NDArray[_T]) -> list[NDArray[_T]]:
        """Return what something with the components of `vector` has of each effect, shape (len(free),) each."""
        ends = np.cumsum([len(self.deviations), *(len(term.free) for term in self.terms)])
        return np.split(components, ends)[1:-1]

    def shift(self, component: int) -> tuple[Parameters, float]:
        """Return the parameters with one component moved by a difference step, downwards near the upper bound."""
        vector, (_, high) = self.vector, self.limits
        signed = _STEP if vector[component] + _STEP <= high[component] else -_STEP
        moved = vector.copy()
        moved[component] += signed
        return self.move_to(moved), signed


_STEP = 0.02
"""Step of the finite differences, in natural sizes: a longer one sees curvature, a shorter one rounding."""
PRIOR_STD = 0.58
"""Standard deviation of a nuisance parameter, as a share of its tolerance: 1/sqrt(3), of a uniform distribution."""
AT_BOUND = 0.98
"""Deviation, in tolerances, from which a parameter is at its bound."""
AT_ONCE = 16
"""Rigs that are simulated between two looks at the clock: enough for all cores, few enough for a budget of seconds."""


@dataclass(frozen=True)
class Evaluation:
    """Parameters, residuals by run of shape (channels, samples), whitened residuals, and the cost with the prior."""

    parameters: Parameters
    residuals: dict[str, Array]
    whitened: dict[str, Array]
    cost: float
    independent: float = 1.0

    @property
    def rows(self) -> float:
        """Number of whitened numbers that are compared, of which a share may count as independent."""
        return self.independent * sum(values.size for values in self.whitened.values())

    @property
    def stacked(self) -> Array:
        """The whitened numbers of all runs as one vector."""
        return np.concatenate([values.ravel() for values in self.whitened.values()])

    @property
    def excess(self) -> float:
        """Reduced chi-square less 1, at least 0: what is left beyond noise, per number compared."""
        return max(self.cost / self.rows - 1.0, 0.0)


@dataclass(frozen=True)
class Linearisation:
    """An evaluation with the whitened Jacobian about it, d(simulated)/d(vector), of some components.

    `jacobian[run]` has shape (components, channels x rows).
    """

    evaluation: Evaluation
    jacobian: dict[str, Array]

    @cached_property
    def normal_matrices(self) -> dict[str, Array]:
        """`J J'` of each run, shape (components, components)."""
        return {run: jacobian @ jacobian.T for run, jacobian in self.jacobian.items()}

    @property
    def stacked(self) -> Array:
        """The Jacobians of all runs, joined along the rows."""
        return np.hstack(list(self.jacobian.values()))

    def normal_equations(self, run: str, own: Array, whitened: Array) -> tuple[Array, Array]:
        """Return normal matrix and right-hand side of a run, for these components and then for those of `own`."""
        mixed, flat = self.jacobian[run] @ own.T, whitened.ravel()
        matrix = np.block([[self.normal_matrices[run], mixed], [mixed.T, own @ own.T]])
        return matrix, np.concatenate([self.jacobian[run] @ flat, own @ flat])


@dataclass(frozen=True)
class Objective:
    """A problem with the weights that make its residuals comparable."""

    problem: DiagnosisProblem
    weights: NoiseWeights

    @property
    def settings(self) -> DiagnosisSettings:
        """Thresholds of the diagnosis."""
        return self.problem.settings

    def on_runs(self, runs: Sequence[str]) -> Objective:
        """Return the objective over some of the runs, under the same weights."""
        return Objective(self.problem.on_runs(runs), self.weights)

    @property
    def unhurried(self) -> Objective:
        """The objective without a deadline, for what has to be stated whatever the time."""
        return self if self.problem.deadline == NEVER else Objective(self.problem.until(NEVER), self.weights)

    def evaluate(self, several: Sequence[Parameters]) -> list[Evaluation]:
        """Simulate and weigh several rigs at once.

        Raises:
            OutOfTimeError: the deadline of the problem is past; it is asked before every `AT_ONCE` rigs.
        """
        evaluations: list[Evaluation] = []
        for first in range(0, len(several), AT_ONCE):
            if self.problem.deadline.is_past:
                raise OutOfTimeError
            part = several[first : first + AT_ONCE]
            residuals = self.problem.residuals([(each.deviations, each.effects) for each in part])
            evaluations += self.problem.pool.map(self.weigh, part, residuals)
        return evaluations

    def evaluate_best(self, groups: Sequence[Sequence[Parameters]]) -> list[Evaluation]:
        """Simulate groups of rigs at once, and return the rig of each group that costs least."""
        evaluations = iter(self.evaluate([each for group in groups for each in group]))
        return [min(islice(evaluations, len(group)), key=lambda each: each.cost) for group in groups]

    def weigh(self, parameters: Parameters, residuals: dict[str, Array]) -> Evaluation:
        """Return the evaluation of a rig whose residuals are known."""
        finite = all(np.all(np.isfinite(values)) for values in residuals.values())
        whitened = {
            run: self.weights(values if finite else np.zeros_like(values), run) for run, values in residuals.items()
        }
        cost = sum(float(np.sum(values**2)) for values in whitened.values()) if finite else np.inf
        cost += self.measure_prior(parameters)
        return Evaluation(parameters, residuals, whitened, cost, self.weights.independent)

    def weigh_again(self, evaluation: Evaluation) -> Evaluation:
        """Return an evaluation over more runs, or under other weights, on the runs of this objective."""
        return self.weigh(evaluation.parameters, {run: evaluation.residuals[run] for run in self.problem.runs})

    def measure_prior(self, parameters: Parameters) -> float:
        """Return the sum of squares of the nuisance parameters' deviations, in their standard deviations."""
        return float(np.sum((parameters.deviations / PRIOR_STD) ** 2))

    def linearise(self, evaluation: Evaluation, components: Sequence[int]) -> Linearisation:
        """Return the sensitivities of the whitened outputs to some components of the vector, by finite differences.

        A rig that cannot be simulated a difference step away has a sensitivity of 0: the fit leaves that component.
        """
        shifts = [evaluation.parameters.shift(k) for k in components]
        moved = self.evaluate([parameters for parameters, _ in shifts])
        jacobian = {}
        for run, base in evaluation.whitened.items():
            slopes = [
                (base - m.whitened[run]).ravel() / step if np.isfinite(m.cost) else np.zeros(base.size)
                for m, (_, step) in zip(moved, shifts, strict=True)
            ]
            jacobian[run] = np.array(slopes).reshape(len(shifts), base.size)
        return Linearisation(evaluation, jacobian)

    def linearise_nuisances(self, evaluation: Evaluation) -> Linearisation:
        """Return the sensitivities to the nuisance parameters."""
        return self.linearise(evaluation, evaluation.parameters.nuisance_components)

    def linearise_effects(self, evaluation: Evaluation) -> Linearisation:
        """Return the sensitivities to the effects' free parameters."""
        return self.linearise(evaluation, evaluation.parameters.effect_components)


def scale(whitened: dict[str, Array], old: Objective, new: Objective) -> dict[str, Array]:
    """Return numbers by run that were whitened by one objective as another whitens them.

    Their last axis, or the last two, hold channels and both parts of each frequency, as residuals do.
    """
    channels = len(new.problem.channels)
    converted = {}
    for run, values in whitened.items():
        apart = values.reshape(-1, channels, 2 * new.weights.bins[run])
        converted[run] = new.weights.convert(apart, run, old.weights).reshape(values.shape)
    return converted
