"""The sensors' effects by what they say and what is told back."""

import numpy as np
import pytest

from seatsim.schema.registry import find

from .rigs import record

STEP = 0.001
TIME = STEP * np.arange(4001)
WAVE = 3.0 * np.sin(2 * np.pi * 1.5 * TIME) + np.sin(2 * np.pi * 4.0 * TIME + 1.0) + 0.3
BY_CHANNEL = {"sensor.gain": {"error": 0.2}, "sensor.bias": {"share": 0.3, "drift": 0.02}, "sensor.lag": {"time": 0.01}}


@pytest.mark.parametrize("name", BY_CHANNEL)
def test_what_a_sensor_says_is_told_back_and_only_of_its_channel(name):
    effect = find("effect", name)(channel="damper_force", **BY_CHANNEL[name])
    read = effect.reading("damper_force", STEP, WAVE)
    assert np.max(np.abs(read - WAVE)) > 0.05
    inner = slice(100, -5)
    assert effect.truth("damper_force", STEP, read)[inner] == pytest.approx(WAVE[inner], abs=2e-3)
    for other in ("driver_acceleration", "current_command"):
        assert effect.reading(other, STEP, WAVE) is WAVE and effect.truth(other, STEP, WAVE) is WAVE


@pytest.mark.parametrize("time", [0.0004, 0.05])
def test_a_lagging_sensor_answers_a_step_as_a_first_order_low_pass(time):
    lag = find("effect", "sensor.lag")(channel="displacement", time=time)
    read = lag.reading("displacement", STEP, np.where(np.arange(300) >= 100, 1.0, 0.0))
    # The truth is taken as linear between its rows, so that the step is a ramp over one row.
    ratio = STEP / time
    after = np.arange(200) * STEP
    assert read[:100] == pytest.approx(np.zeros(100), abs=1e-12)
    assert read[100:] == pytest.approx(1.0 - (1.0 - np.exp(-ratio)) / ratio * np.exp(-after / time), abs=1e-12)
    # It starts at rest.
    assert lag.reading("displacement", STEP, np.full(50, 7.0)) == pytest.approx(np.full(50, 7.0))


@pytest.mark.parametrize("shift", [0.0063, -0.0063])
def test_a_skewed_log_says_late_what_was(shift):
    skew = record("sensor.clock_skew", shift=shift, drift=1e-4)
    read = skew.reading("coil_current", STEP, WAVE)
    inner = slice(50, -50)
    late = TIME - shift - 1e-4 * TIME
    assert read[inner] == pytest.approx(np.interp(late, TIME, WAVE)[inner], abs=1e-9)
    assert skew.truth("coil_current", STEP, read)[inner] == pytest.approx(WAVE[inner], abs=1e-3)
    assert skew.reading("damper_force", STEP, WAVE) is WAVE


@pytest.mark.parametrize("channel", ["current_command", "command_voltage"])
def test_a_held_command_moves_by_whole_rows(channel):
    command = np.repeat([0.0, 1.0, 0.3, 0.8], 50)
    skew = record("sensor.clock_skew", shift=0.003, hold=STEP)
    progress = skew.truth(channel, STEP, command)
    assert progress[:-3] == pytest.approx(command[3:])
    assert set(progress) <= set(command)


def test_a_held_command_moves_by_the_same_time_at_any_step():
    command = np.repeat([0.0, 1.0, 0.3, 0.8], 50)
    skew = record("sensor.clock_skew", shift=-0.0026, drift=2e-5, hold=STEP)
    fine = skew.truth("current_command", STEP / 4, np.repeat(command, 4))
    assert np.array_equal(fine[::4], skew.truth("current_command", STEP, command))
