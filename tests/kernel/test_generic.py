"""What the loop asks of damper, law and sensors, where these answer and where they do not."""

import numpy as np
import pytest

from seatsim.kernel import generic
from seatsim.rig.control import Measurement
from seatsim.rig.sensors import Sensors, at_rest
from seatsim.rig.temperature import TemperatureScaling

from .uncompiled import Commanded, Feedback, Hysteretic, Linear

HOT = TemperatureScaling(0.8, 0.9, 0.7)
Y = Measurement(*range(1, 13))


def test_a_damper_answers_for_itself():
    assert generic.force(Linear(800.0, 300.0, 1000.0), 0.01, 0.2, 0.5, HOT, ()) == pytest.approx(950 * 0.8 * 0.2 + 9.0)
    assert generic.rates(Hysteretic(), 0.01, 0.2, 0.5, HOT, (0.1, 0.0)) == pytest.approx((5.0, 0.01))
    assert generic.coulomb(Linear(friction=40.0), 0.5, HOT) == pytest.approx(28.0)


def test_laws_want_a_force_or_a_current():
    assert generic.wants_force(Feedback()) and not generic.wants_force(Commanded())
    assert generic.evaluate_law(Feedback(10.0), Y, (0.0,)) == 10.0 * Y.velocity
    assert generic.evaluate_law(Commanded(0.7), Y, ()) == 0.7
    assert generic.update(Feedback(), Y, (4.0,)) == (5.0,)
    assert generic.update(Commanded(), Y, (4.0,)) == (4.0,)


def test_instruments_answer_for_themselves():
    made, state = Sensors().instruments(1e-3, 5e-3), at_rest(0.01)
    moved = generic.advance_filters(made, 0.3, 0.02, (0.0, 0.1, 0.0, 0.2), state)
    assert moved == made.advance_filters(0.3, 0.02, (0.0, 0.1, 0.0, 0.2), state) != state
    seen, after = generic.read(made, Y, np.zeros((1, 4)), 0, moved)
    assert seen.displacement == moved[1] and after[8] == moved[1]
