"""The gain that follows the measured temperature or the level of the travel."""

import numpy as np
import pytest

from controllers.laws.scheduled_output_feedback import ScheduledOutputFeedback
from controllers.laws.static_output_feedback import StaticOutputFeedback
from controllers.seat_plant import Weights
from seatsim.rig.coil import Coil
from seatsim.rig.control import Measurement, prepare_law
from seatsim.rig.plant import Plant
from seatsim.schema.errors import InputError

SEAT = Plant(20.0, 80.0, 4600.0, 200.0, 60000.0, 1500.0)


COIL = Coil(130.0, 1.0)
REST = Measurement(*[0.0] * len(Measurement._fields))


def compile_law(**keys):
    return prepare_law(ScheduledOutputFeedback(**keys), SEAT, COIL, 0.005)


NATURAL = np.sqrt(4600.0 / 100.0)


def settle(law, amplitude, rate, seconds=20.0):
    """Return the state after a harmonic travel in m at an angular rate in rad/s."""
    state = (0.0, 0.0, 0.0)
    for t in np.arange(0.0, seconds, 0.005):
        y = REST._replace(displacement=amplitude * np.sin(rate * t), velocity=amplitude * rate * np.cos(rate * t))
        state = law.update(y, state)
    return state


@pytest.mark.parametrize(
    ("point", "k2"), [(0.0, 1000.0), (20.0, 1000.0), (35.0, 1500.0), (50.0, 2000.0), (99.0, 3000.0)]
)
def test_gain_is_interpolated_and_held(point, k2):
    gains = ((0.0, 1000.0), (30.0, 2000.0), (60.0, 3000.0))
    by_temperature = compile_law(temperatures=(20.0, 50.0, 80.0), gains=gains)
    by_travel = compile_law(travels=(0.020, 0.050, 0.080), gains=gains)
    for y, force in ((REST._replace(velocity=1.0), k2), (REST._replace(displacement=1.0), 0.03 * (k2 - 1000.0))):
        assert by_temperature.wanted_force(y._replace(temperature=point), (0.0, 0.0, 0.0)) == pytest.approx(force)
        assert by_travel.wanted_force(y, (0.001 * point, 0.0, 0.0)) == pytest.approx(force)


@pytest.mark.parametrize(("frequency", "k2"), [(0.5, 1.0), (1.0, 1.0), (1.5, 1.5), (2.0, 2.0), (4.0, 2.0)])
def test_gain_follows_the_frequency_of_the_travel(frequency, k2):
    law = compile_law(frequencies=(1.0, 2.0), gains=((0.0, 1.0), (0.0, 2.0)))
    state = settle(law, 0.01, 2 * np.pi * frequency)
    assert law.wanted_force(REST._replace(velocity=1.0), state) == pytest.approx(k2, rel=0.02)


def test_every_combination_of_points_has_its_gain():
    gains = tuple((0.0, float(number)) for number in range(8))
    axes = {"temperatures": (20.0, 80.0), "frequencies": (1.0, 2.0), "travels": (0.01, 0.03)}
    law = compile_law(**axes, gains=gains)
    y = REST._replace(velocity=1.0, temperature=80.0)
    at = {travel: (travel, 1.0, (2 * np.pi) ** 2) for travel in axes["travels"]}
    assert law.wanted_force(y, at[0.01]) == pytest.approx(4.0)
    assert law.wanted_force(y, at[0.03]) == pytest.approx(5.0)
    assert law.wanted_force(y._replace(temperature=50.0), (0.02, 1.0, (3 * np.pi) ** 2)) == pytest.approx(3.5)


def test_amplitude_is_that_of_a_harmonic_travel_and_is_forgotten():
    law = compile_law(travels=(0.0, 0.05), gains=((0.0, 1.0), (0.0, 2.0)), memory=2.0)
    state = settle(law, 0.04, NATURAL)
    assert state[0] == pytest.approx(0.04, rel=1e-3)
    for _ in range(400):
        state = law.update(REST, state)
    assert state[0] == pytest.approx(0.04 * np.exp(-1), rel=1e-2)


def test_synthesis_makes_up_for_a_weaker_damper():
    law = compile_law(temperatures=(20.0, 80.0), weights=Weights(30.0), force_factors=(1.0, 0.67))
    np.testing.assert_allclose(np.array(law.velocity)[1] * 0.67, law.velocity[0], rtol=1e-3)


def test_synthesis_at_each_point_is_that_of_its_weight():
    law = compile_law(travels=(0.01, 0.03), weights_at_points=(Weights(10.0), Weights(50.0)))
    for place, weight in enumerate((10.0, 50.0)):
        single = prepare_law(StaticOutputFeedback(weights=Weights(weight)), SEAT, COIL, 0.005)
        assert (law.displacement[place], law.velocity[place]) == (single.displacement, single.velocity)


GAINS = ((1.0, 1.0), (1.0, 1.0))


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"temperatures": (20.0, 80.0)}, "exactly one of 'gains'"),
        ({"gains": GAINS}, "at least one of temperatures"),
        ({"temperatures": (80.0, 20.0), "gains": GAINS}, "must rise"),
        ({"travels": (0.02,), "gains": GAINS[:1]}, "two or more"),
        ({"temperatures": (20.0, 80.0), "gains": GAINS[:1]}, "gains has 1 entries"),
        ({"temperatures": (20.0, 80.0), "travels": (0.0, 0.1), "gains": GAINS}, "each of the 4 points"),
        ({"travels": (0.0, 0.1), "gains": ((1.0,), (1.0,))}, "one entry each"),
        ({"temperatures": (20.0, 80.0), "weights": Weights()}, "force_factors has 0 entries"),
        ({"travels": (0.0, 0.1), "weights_at_points": (Weights(),)}, "weights_at_points has 1 entries"),
        ({"travels": (0.0, 0.1), "gains": GAINS, "weights": Weights()}, "exactly one of 'gains'"),
        ({"travels": (0.0, 0.1), "weights": Weights()}, "every gain the same"),
    ],
)
def test_wrong_schedules(keys, words):
    with pytest.raises(InputError, match=words):
        compile_law(**keys)
