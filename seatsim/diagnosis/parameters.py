"""The parameters of one rig: deviations of the nuisance parameters, and effects with their values."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from seatsim.diagnosis.candidates import Candidate
from seatsim.schema.arrays import Array
from seatsim.schema.registry import Record


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
    def further(self) -> int:
        """How many parameters the structures of the effects choose beyond their sizes."""
        return sum(term.further for term in self.terms)

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
        values, start = [], len(self.deviations)
        for term in self.terms:
            # The product may be beyond a bound by a rounding, and no file with such a value would be read.
            values.append(np.clip(vector[start : start + len(term.free)] * term.scale, term.low, term.high))
            start += len(term.free)
        return Parameters(vector[: len(self.deviations)], self.terms, tuple(values))

    def shift(self, component: int, step: float) -> tuple[Parameters, float]:
        """Return the parameters with one component moved by a difference step, downwards near the upper bound."""
        vector, (_, high) = self.vector, self.limits
        signed = step if vector[component] + step <= high[component] else -step
        moved = vector.copy()
        moved[component] += signed
        return self.move_to(moved), signed
