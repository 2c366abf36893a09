"""Every effect on every damper of the library: force and rates stay finite, called as plain Python.

Python raises where compiled code would go on with inf or NaN, so that these points are a strict test.
"""

import math

import pytest

from seatsim.effects.base import ON_DAMPER, acts_on
from seatsim.kernel.augmented import AugmentedDamper
from seatsim.kernel.hooks import state_at_rest
from seatsim.rig.temperature import TemperatureScaling
from seatsim.schema.registry import find, names, specification_of

from .rigs import NAMES, starts

EFFECTS = [effect for name in NAMES if acts_on(find("effect", name), ON_DAMPER) for effect in starts(name)]
STRUCTURES = {(type(effect), *(value != 0.0 for value in effect)): effect for effect in EFFECTS}
POINTS = ((0.0, 0.0, 0.0, 0.0), (0.004, 0.2, 0.6, 0.0), (-0.004, -0.05, 0.6, 1e-4))
"""x in m, v in m/s, i in A, and what is added to every state at rest."""
WARM = TemperatureScaling(0.9, 0.9, 0.8)


@pytest.mark.parametrize("model", names("damper"))
def test_every_effect_leaves_every_damper_finite(model):
    damper = find("damper", model)()
    for effect in STRUCTURES.values():
        if specification_of(type(effect)).suits(damper):
            rig = AugmentedDamper(damper, (effect,))
            rest = specification_of(type(damper)).initial + state_at_rest([type(effect)])
            for x, v, i, moved in POINTS:
                z = tuple(value + moved for value in rest)
                found = (rig.force(x, v, i, WARM, z), *rig.rates(x, v, i, WARM, z))
                assert all(map(math.isfinite, found)), (effect, x, v, i, found)
