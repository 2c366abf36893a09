"""What laws of dampers come to at their ends: no regularisation, rest, no limit."""

import pytest

from seatsim.rig.temperature import TemperatureScaling
from seatsim.schema.registry import find, names

SCALING = TemperatureScaling(0.9, 0.8, 0.7)
REGULARISED = [name for name in names("damper") if {"coulomb", "v_ref"} <= set(dir(find("damper", name)))]


@pytest.mark.parametrize("current", [0.0, 0.6])
@pytest.mark.parametrize("name", REGULARISED)
def test_a_set_valued_friction_is_what_the_regularised_one_tends_to(name, current):
    cls = find("damper", name)
    sharp, smooth = cls()._replace(v_ref=0.0), cls()._replace(v_ref=1e-5)
    friction = sharp.coulomb(current, SCALING)
    for v, sign in ((0.02, 1.0), (-0.02, -1.0)):
        rest = sharp.force(0.0, v, current, SCALING, ())
        assert smooth.force(0.0, v, current, SCALING, ()) == pytest.approx(rest + sign * friction, rel=1e-12)
    assert friction > 0.0 and smooth.coulomb(current, SCALING) == 0.0
    assert sharp._replace(fc_a=-1.0, fc_b=0.0).coulomb(current, SCALING) == 0.0
