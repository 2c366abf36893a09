"""Steps of current: found where they are, and response times of known coils."""

import numpy as np
import pytest

from seatsim.characterisation.steps import find_steps, measure_responses


def square(on, off, period):
    return lambda t: np.where(t % period < 0.5 * period, off, on)


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


def test_what_cannot_be_determined_says_why(record):
    still = record(lambda t: 0.0 * t, 4.0, square(1.0, 0.0, 1.0), lag=(130.0,), noise=1.0)
    fast = record(lambda t: 0.005 * np.sin(20.0 * t), 4.0, square(1.0, 0.0, 0.04), lag=(130.0,))
    for made in (still, fast):
        assert all(answer.share is None and answer.note for answer in measure_responses(made))
