"""The severity at which a fault has a drawn materiality."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.random import Generator

LOG_TOLERANCE = 0.2
"""Of the logarithm of a materiality; closer would only cost simulations, as the target is drawn."""
EVALUATIONS = 9
MATERIAL = 1.03
"""A little above the limit, as sizes are measured with a coarse step."""
_WEAKEST_TARGET, _STRONGEST_TARGET = 1.1, 8.0
TINY = 1e-9
"""In place of a materiality of zero, where its logarithm is taken."""
_UNSTABLE_FACTOR = 0.6
"""Of a severity at which the rig was unstable: the new upper bound."""

Known = list[tuple[float, float]]
"""Severities and their materialities."""


def draw_target(rng: Generator, top: float = _STRONGEST_TARGET, bottom: float = _WEAKEST_TARGET) -> float:
    """Draw a materiality, log-uniform from the material limit to strong."""
    return float(np.exp(rng.uniform(math.log(bottom), math.log(max(top, bottom * 1.01)))))


def find_severity(
    size_of: Callable[[float], float], span: tuple[float, float], rng: Generator
) -> tuple[float, float] | None:
    """Return severity and materiality near a drawn target, or None where nothing plausible is material.

    Secant steps in the logarithms between bounds that close in; a fault too weak for the target gets a new, lower one.
    `size_of` returns the materiality of a severity, infinite where the rig is unstable.
    """
    target = draw_target(rng)
    low, high = span
    known: Known = []
    s = min(max(1.0, low), high)
    for _ in range(EVALUATIONS):
        size = size_of(s)
        if not math.isfinite(size):
            high = _UNSTABLE_FACTOR * s
            s = math.sqrt(max(low, s / 8.0) * high)
            if high <= low:
                return None
            continue
        known.append((s, size))
        if abs(math.log(max(size, TINY) / target)) < LOG_TOLERANCE:
            break
        if size < target and s >= high * 0.999:
            if size < 1.15:
                return None
            target = draw_target(rng, size)
            s = min(max(s * (target / size), low), high)
            if s >= high * 0.999:
                break
            continue
        s = _next_severity(known, target, low, high)
    return _closest_material(known, target)


def _closest_material(known: Known, target: float) -> tuple[float, float] | None:
    material = [pair for pair in known if pair[1] >= MATERIAL]
    return min(material, key=lambda pair: abs(math.log(pair[1] / target)), default=None)


def _next_severity(known: Known, target: float, low: float, high: float) -> float:
    """Return the next severity: between the closest below and above, else on from the closest.

    The secant keeps a tenth away from both ends, and an extrapolation to a factor of 0.1 to 6, as materiality is not
    quite a power of the severity.
    """
    below = [pair for pair in known if pair[1] < target]
    above = [pair for pair in known if pair[1] >= target]
    if below and above:
        (s0, m0), (s1, m1) = max(below, key=lambda pair: pair[1]), min(above, key=lambda pair: pair[1])
        share = math.log(target / max(m0, TINY)) / math.log(m1 / max(m0, TINY))
        return float(math.exp(math.log(s0) + min(max(share, 0.1), 0.9) * math.log(s1 / s0)))
    s, size = (below or above)[-1]
    return float(min(max(s * min(max(target / max(size, TINY), 0.1), 6.0), low), high))
