"""Steps of current: found where they are, and response times of known coils."""

import math

import numpy as np
import pytest

from seatsim.characterisation.model_tests import DamperSpecimen, step_response
from seatsim.characterisation.steps import find_steps, measure_responses
from seatsim.dampers.bouc_wen import BoucWen
from seatsim.rig.coil import Coil
from seatsim.rig.temperature import TemperatureFactors


def square(on, off, period):
    return lambda t: np.where(t % period < 0.5 * period, off, on)


def triangle(speed, period):
    """Constant speed out and back; reversals fall between the steps of a current of half the period."""
    return lambda t: speed * (0.25 * period - np.abs((t + 0.125 * period) % period - 0.5 * period))


def test_steps_are_found_where_they_are():
    t = np.arange(4000) / 1000.0
    current = square(1.0, 0.2, 1.0)(t) + 0.005 * np.random.default_rng(0).standard_normal(len(t))
    steps = find_steps(current, 1000.0, True)
    assert [round(step.row) for step in steps] == [500, 1000, 1500, 2000, 2500, 3000, 3500]
    assert [step.after.level > step.before.level for step in steps] == [True, False] * 3 + [True]
    assert steps[0].after.level == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize("wave", [lambda t: 0.0 * t + 0.7, lambda t: 0.5 + 0.5 * np.sin(6.0 * t), lambda t: 0.2 * t])
def test_what_does_not_step_has_no_steps(wave):
    t = np.arange(4000) / 1000.0
    assert find_steps(wave(t), 1000.0, False) == []


@pytest.mark.parametrize("noise", [0.0, 3.0])
def test_rise_and_fall_of_a_known_coil_at_constant_speed(record, noise):
    made = record(triangle(0.08, 4.0), 12.0, square(0.9, 0.1, 2.0), lag=(150.0, 70.0), noise=noise)
    rise, fall = sorted(measure_responses(made), key=lambda answer: not answer.rises)
    assert rise.method == fall.method == "constant speed" and rise.steps >= 4
    for answer, rate in ((rise, 150.0), (fall, 70.0)):
        assert answer.t95 == pytest.approx(math.log(20.0) / rate, rel=0.03 + 0.05 * (noise > 0), abs=5e-4)
        assert answer.rate_95 == pytest.approx(rate, rel=0.05 + 0.05 * (noise > 0))
        assert answer.t90 == pytest.approx(math.log(10.0) / rate, rel=0.06, abs=5e-4)
    assert math.isnan(rise.current_t95)


def test_a_varying_speed_is_demodulated(record):
    def motion(t):
        return 0.004 * np.sin(2 * math.pi * 3.1 * t) + 0.002 * np.sin(2 * math.pi * 7.3 * t + 1.0)

    rises, falls = sorted(
        measure_responses(record(motion, 30.0, square(1.0, 0.0, 0.4), lag=(130.0, 60.0), noise=2.0)),
        key=lambda a: not a.rises,
    )
    assert rises.method == falls.method == "demodulated" and rises.steps > 50
    assert rises.rate_95 == pytest.approx(130.0, rel=0.15) and falls.rate_95 == pytest.approx(60.0, rel=0.1)
    assert 0.0 < rises.t95_sd < 0.005


def test_what_cannot_be_determined_says_why(record):
    still = record(lambda t: 0.0 * t, 4.0, square(1.0, 0.0, 1.0), lag=(130.0,), noise=1.0)
    fast = record(lambda t: 0.005 * np.sin(20.0 * t), 4.0, square(1.0, 0.0, 0.04), lag=(130.0,))
    for made in (still, fast):
        assert all(not answer.method and answer.note and math.isnan(answer.t95) for answer in measure_responses(made))


def test_a_model_answers_with_the_rates_of_its_coil():
    # force linear in the current: it follows the coil exactly, behind the coil's delay
    tested = DamperSpecimen(BoucWen(k0=500.0), TemperatureFactors(), Coil(rate=176.0, rate_fall=70.0, delay=0.004))
    rise, fall = step_response(tested, 0.0, 1.0, 0.05, 20.0), step_response(tested, 1.0, 0.0, 0.05, 20.0)
    for answer, rate in ((rise, 176.0), (fall, 70.0)):
        assert answer.rate == pytest.approx(rate, rel=0.01) and answer.delay == pytest.approx(0.004, abs=2e-4)
        assert answer.t95 == pytest.approx(0.004 + math.log(20.0) / rate, rel=0.01)
        assert answer.current_t95 == pytest.approx(answer.t95, rel=0.01)
