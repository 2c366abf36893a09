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
from collections.abc import Sequence
from typing import NamedTuple

SENSORS = "sensor."
"""How the names of effects begin by which a sensor errs."""


class Evidence(NamedTuple):
    """What a set of effects is worth: prior odds of an effect of the rig and of a sensor, and the power above."""

    prior: float
    prior_of_sensor: float
    power: float

    def weigh(self, names: frozenset[str], left: float) -> float:
        """Return the logarithm of the weight of a set of effects that leaves a mean square."""
        priors = [self.prior_of_sensor if name.startswith(SENSORS) else self.prior for name in names]
        return sum(math.log(prior) for prior in priors) - self.power * math.log(left)


def weigh_effects(
    sets: Sequence[tuple[frozenset[str], float]], effects: Sequence[str], bounds: tuple[float, float]
) -> dict[str, float]:
    """Return the probability of each effect, within the bounds that are permitted.

    Args:
        sets: names of the effects of each set, with the logarithm of its weight.
        effects: names of all effects.
        bounds: least and greatest probability.
    """
    largest = max((log for _, log in sets), default=0.0)
    weights = [(names, math.exp(log - largest)) for names, log in sets]
    total = sum(weight for _, weight in weights) or 1.0
    shares = {name: sum(weight for names, weight in weights if name in names) / total for name in effects}
    least, most = bounds
    return {name: min(max(share, least), most) for name, share in shares.items()}
