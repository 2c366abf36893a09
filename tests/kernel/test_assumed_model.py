"""What the inverse works with, and the state of an assumed damper that it follows."""

import math
from typing import NamedTuple

import pytest

from seatsim.kernel.generic import AssumedModel, Motion, follow_state, model_scaling, model_state
from seatsim.rig.temperature import TemperatureFactors, TemperatureScaling

from .uncompiled import Linear

NONE, HOT = TemperatureScaling(), TemperatureScaling(0.8, 0.9, 0.7)
FACTORS = TemperatureFactors(-0.01, 0.0, -0.02, 20.0)


class Cubes(NamedTuple):
    """Rates that are cubes of what drives them, which Simpson's rule integrates exactly along straight lines."""

    def rates(self, x, v, i, scaling, z):
        return (x**3, v**3, i + scaling.yield_force)


@pytest.mark.parametrize(("own", "measured", "felt"), [(math.nan, 60.0, 60.0), (35.0, 60.0, 35.0)])
def test_an_assumed_model_has_a_state_and_a_temperature_of_its_own(own, measured, felt):
    model = AssumedModel(Linear(), FACTORS, own)
    assert model_state(model, (1.0,), (2.0,)) == (2.0,)
    expected = (math.exp(-0.01 * (felt - 20.0)), 1.0, math.exp(-0.02 * (felt - 20.0)))
    assert model_scaling(model, HOT, measured) == pytest.approx(expected, rel=1e-14)


def test_motion_runs_along_straight_lines_between_samples():
    x0, x1, v0, v1, length = 0.2, 0.9, -0.5, 0.7, 0.4
    found = follow_state(Cubes(), (1.0, 2.0, 3.0), Motion(x0, v0, 0.6), Motion(x1, v1, 0.6), HOT, length)
    quartic = [length * (b**4 - a**4) / (4.0 * (b - a)) for a, b in ((x0, x1), (v0, v1))]
    expected = (1.0 + quartic[0], 2.0 + quartic[1], 3.0 + length * (0.6 + 0.7))
    assert found == pytest.approx(expected, rel=1e-13)
