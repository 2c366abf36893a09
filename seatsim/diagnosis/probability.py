"""Probabilities of effects, from tempered evidences of the sets that were fitted.

A set of n effects that leaves a mean square m has the weight

    w = prior_1 ... prior_n m^-power,

the evidence of a model whose noise is known but for its level, tempered: of the many numbers that are compared only
`2 power` count as independent, since what even a right set leaves is the error of an effect's form, which all of them
share. An effect's probability is the share of the weight that lies in sets with it, whatever else stays
unexplained.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from seatsim.diagnosis.settings.judging import DecisionSettings


def weigh_effects(
    settings: DecisionSettings, sets: Iterable[tuple[frozenset[str], float]], effects: Sequence[str], power: float
) -> dict[str, float]:
    """Return the probability of each effect, within the bounds that the settings permit.

    Args:
        settings: prior and bounds.
        sets: names of the effects of each set, with the mean square that it leaves, in any unit, above 0.
        effects: names of all effects.
        power: exponent of the mean square.
    """
    logs = [(names, weigh_set(settings, names, left, power)) for names, left in sets]
    largest = max((log for _, log in logs), default=0.0)
    weights = [(names, math.exp(log - largest)) for names, log in logs]
    total = sum(weight for _, weight in weights) or 1.0
    shares = {name: sum(weight for names, weight in weights if name in names) / total for name in effects}
    least, most = settings.effect_bounds
    return {name: min(max(share, least), most) for name, share in shares.items()}


def weigh_set(settings: DecisionSettings, names: frozenset[str], left: float, power: float) -> float:
    """Return the logarithm of the evidence of a set of effects that leaves a mean square, but for a constant."""
    priors = [settings.prior_of_sensor if name.startswith("sensor.") else settings.prior for name in names]
    return sum(math.log(prior) for prior in priors) - power * math.log(left)
