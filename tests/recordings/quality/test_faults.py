"""Faults of data are listed for the channels there are, and each is corrected by its own inverse."""

import numpy as np
import pytest

from seatsim.recordings.quality.consistency import list_faults

RATE = 250.0
SIGNAL = np.random.default_rng(2).standard_normal(6000).cumsum()
SIGNAL = SIGNAL - np.convolve(SIGNAL, np.ones(250) / 250, mode="same")
"""A motion between about 1 Hz and the noise."""


def table_of(*channels):
    return {channel: SIGNAL + k for k, channel in enumerate(channels)}


@pytest.mark.parametrize(
    ("channel", "unit", "per_si"),
    [("frame_acceleration", "g", 1 / 9.80665), ("frame_acceleration", "mm/s^2", 1000.0),
     ("suspension_displacement", "mm", 1000.0), ("suspension_displacement", "inch", 1 / 0.0254),
     ("damper_force", "kN", 1e-3)],
)  # fmt: skip
def test_another_unit_is_converted_back(under_test, channel, unit, per_si):
    run = under_test(table_of(channel))
    (fault,) = [f for f in list_faults(run, None) if f.says == f"reads as if in {unit}"]
    faulty = {channel: per_si * SIGNAL}
    assert (fault.kind, fault.channels) == ("unit", (channel,))
    assert fault.correct(faulty)[channel] == pytest.approx(SIGNAL)


def test_signs_are_turned_of_motion_force_and_coil_current_only(under_test):
    run = under_test(
        table_of("floor_acceleration", "damper_force", "coil_current", "current_command", "damper_temperature")
    )
    signs = {fault.channels[0]: fault for fault in list_faults(run, None) if fault.kind == "sign"}
    assert set(signs) == {"floor_acceleration", "damper_force", "coil_current"}
    corrected = signs["damper_force"].correct(run.table)
    assert np.array_equal(corrected["damper_force"], -run.table["damper_force"])
    assert corrected["coil_current"] is run.table["coil_current"]


@pytest.mark.parametrize(("rows", "word"), [(25, "late"), (-25, "early")])
def test_a_delay_against_the_simulation_is_taken_back(under_test, rows, word):
    late = {"driver_acceleration": np.roll(SIGNAL, rows), "floor_acceleration": SIGNAL}
    run = under_test(late)
    delays = [f for f in list_faults(run, {"driver_acceleration": SIGNAL[250:]}) if f.kind == "late"]
    assert [fault.channels for fault in delays] == [("driver_acceleration",), ("floor_acceleration",)]
    assert delays[0].says == f"is 0.1 s {word}"
    inner = slice(300, -300)
    assert delays[0].correct(late)["driver_acceleration"][inner] == pytest.approx(SIGNAL[inner])
    # The other explanation: the floor, against which all outputs are late, is early by as much.
    assert delays[1].correct(late)["floor_acceleration"][inner] == pytest.approx(np.roll(SIGNAL, rows)[inner])


def test_a_delay_that_a_sensor_or_clock_may_have_is_no_fault(under_test):
    run = under_test({"driver_acceleration": np.roll(SIGNAL, 12)})
    assert not [f for f in list_faults(run, {"driver_acceleration": SIGNAL[250:]}) if f.kind == "late"]
    coil = under_test({"coil_current": np.roll(SIGNAL, 24)})
    assert not [f for f in list_faults(coil, {"coil_current": SIGNAL[250:]}) if f.kind == "late"]
