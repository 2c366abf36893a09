"""The gain that follows the measured temperature or the level of the travel."""

import numpy as np
import pytest

from controllers.laws.scheduled_output_feedback import ScheduledOutputFeedback
from controllers.laws.static_output_feedback import StaticOutputFeedback
from controllers.seat_plant import Weights
from seatsim.rig.coil import Coil
from seatsim.rig.control import Measurement, no_floors, prepare_law
from seatsim.rig.plant import Plant
from seatsim.schema.errors import InputError

SEAT = Plant(20.0, 80.0, 4600.0, 200.0, 60000.0, 1500.0)


COIL = Coil(130.0, 1.0)
REST = Measurement(*[0.0] * len(Measurement._fields))


def compile_law(**keys):
    return prepare_law(ScheduledOutputFeedback(**keys), SEAT, COIL, 0.005)


@pytest.mark.parametrize(
    ("point", "k2"), [(0.0, 1000.0), (20.0, 1000.0), (35.0, 1500.0), (50.0, 2000.0), (99.0, 3000.0)]
)
def test_gain_is_interpolated_and_held(point, k2):
    gains = ((0.0, 1000.0), (30.0, 2000.0), (60.0, 3000.0))
    by_temperature = compile_law(temperatures=(20.0, 50.0, 80.0), gains=gains)
    by_travel = compile_law(travels=(0.020, 0.050, 0.080), gains=gains)
    for y, force in ((REST._replace(velocity=1.0), k2), (REST._replace(displacement=1.0), 0.03 * (k2 - 1000.0))):
        assert by_temperature.wanted_force(y._replace(temperature=point), (0.0,)) == pytest.approx(force)
        assert by_travel.wanted_force(y, (0.001 * point,)) == pytest.approx(force)


def test_level_of_the_travel_rises_quickly_and_falls_slowly():
    law = compile_law(travels=(0.0, 0.05), gains=((0.0, 1.0), (0.0, 2.0)), rise=0.3, fall=2.0)
    state = (0.0,)
    for _ in range(60):
        state = law.update(REST._replace(displacement=-0.04), state)
    assert state[0] == pytest.approx(0.04 * (1 - np.exp(-1)))
    for _ in range(400):
        state = law.update(REST, state)
    assert state[0] == pytest.approx(0.04 * (1 - np.exp(-1)) * np.exp(-1))


def test_every_measure_has_its_gain():
    measures = ("frame_velocity", "velocity", "driver_acceleration")
    law = compile_law(travels=(0.0, 0.05), gains=((1.0, 2.0, 3.0), (5.0, 6.0, 7.0)), measures=measures)
    y = REST._replace(frame_velocity=1.0, velocity=10.0, driver_acceleration=100.0, displacement=9.0)
    assert law.wanted_force(y, (0.025,)) == pytest.approx(3.0 + 40.0 + 500.0)


def test_synthesis_makes_up_for_a_weaker_damper():
    law = compile_law(temperatures=(20.0, 80.0), weights=Weights(30.0), force_factors=(1.0, 0.67))
    np.testing.assert_allclose(np.array(law.velocity)[1] * 0.67, law.velocity[0], rtol=1e-3)


def test_synthesis_at_each_level_is_that_of_its_weight():
    law = compile_law(travels=(0.01, 0.03), weights_at_travels=(Weights(10.0), Weights(50.0)))
    for place, weight in enumerate((10.0, 50.0)):
        single = prepare_law(StaticOutputFeedback(weights=Weights(weight)), SEAT, COIL, 0.005)
        assert (law.displacement[place], law.velocity[place]) == (single.displacement, single.velocity)


def test_lists_serve_as_tuples():
    given = StaticOutputFeedback(weights=Weights(), masses=[50.0, 80.0], force_factors=[1.0])
    stated = StaticOutputFeedback(weights=Weights(), masses=(50.0, 80.0), force_factors=(1.0,))
    assert prepare_law(given, SEAT, COIL, 0.005) == prepare_law(stated, SEAT, COIL, 0.005)
    assert given.describe(SEAT, COIL, no_floors) == stated.describe(SEAT, COIL, no_floors)


GAINS = ((1.0, 1.0), (1.0, 1.0))


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"temperatures": (20.0, 80.0)}, "exactly one of 'gains'"),
        ({"gains": GAINS}, "exactly one of 'temperatures'"),
        ({"temperatures": (20.0, 80.0), "travels": (0.0, 0.1), "gains": GAINS}, "exactly one of 'temperatures'"),
        ({"temperatures": (80.0, 20.0), "gains": GAINS}, "must rise"),
        ({"travels": (0.02,), "gains": GAINS[:1]}, "two or more"),
        ({"temperatures": (20.0, 80.0), "gains": GAINS[:1]}, "gains has 1 entries"),
        ({"travels": (0.0, 0.1), "gains": ((1.0,), (1.0,))}, "one entry each"),
        ({"temperatures": (20.0, 80.0), "weights": Weights()}, "force_factors has 0 entries"),
        ({"travels": (0.0, 0.1), "weights_at_travels": (Weights(),)}, "weights_at_travels has 1 entries"),
        ({"travels": (0.0, 0.1), "gains": GAINS, "weights": Weights()}, "weights_at_travels to 'travels'"),
    ],
)
def test_wrong_schedules(keys, words):
    with pytest.raises(InputError, match=words):
        compile_law(**keys)
