"""The table of one run."""

import math

import numpy as np
import pytest

from seatsim.metrics.comfort import weighted_rms
from seatsim.metrics.motion import rms
from seatsim.metrics.table import summarise
from seatsim.metrics.weighting import weight

from ..text import parse

STEP = 0.001
STATED = parse("""
    {suspension_displacement_peak: 0.06, end_stop_hits: 20, force_tracking_error: 10.0, current_rms: 0.5,
     force_tracking_error_relative: 0.1, force_served_share: 0.25, electrical_energy: 10.0, damper_energy: 60.0,
     energy_residual: 0.01, temperature_final: 30.0}
""")


def history(seconds=10.0, seed=0):
    """Run-like channels, not a solution of any rig."""
    n = round(seconds / STEP) + 1
    rng = np.random.default_rng(seed)
    t = np.arange(n) * STEP
    floor, frame, driver = rng.normal(size=(3, n))
    channels = {"time": t, "floor_acceleration": floor, "frame_acceleration": frame, "driver_acceleration": driver / 2}
    channels |= {"suspension_displacement": 0.06 * np.sin(2 * np.pi * t), "damper_temperature": 20 + t}
    channels |= {"force_served": (t < seconds / 4).astype(float), "coil_current": np.full(n, 0.5)}
    channels |= {"damper_force": np.full(n, 90.0), "wanted_force": np.full(n, 100.0)}
    energies = {"floor": 10 * t, "damper": 6 * t, "suspension": 2 * t, "cushion": t, "stored": 3 + 0.9 * t}
    return channels | {f"energy_{part}": values for part, values in energies.items()}


def test_values():
    channels = history()
    table = summarise(channels, STEP, travel=(-0.05, 0.05), coil_resistance=4.0)
    floor, driver = channels["floor_acceleration"], channels["driver_acceleration"]
    weighted = weighted_rms(driver, 1 / STEP)
    expected = STATED | {"driver_acceleration_rms": rms(driver)}
    expected |= {"seat_factor": weighted / weighted_rms(floor, 1 / STEP)}
    expected |= {"driver_acceleration_weighted": rms(weight(driver, 1 / STEP))}
    assert {name: table[name].value for name in expected} == pytest.approx(expected, rel=1e-3)


def test_what_is_absent_is_left_out():
    channels = {"suspension_displacement": np.ones(5), "mystery": np.ones(5)}
    assert list(summarise(channels, STEP)) == ["suspension_displacement_rms", "suspension_displacement_peak"]
    assert summarise({}, STEP) == {}


def test_law_that_commands_a_current_has_no_force_metrics():
    channels = history()
    channels["wanted_force"][:] = math.nan
    channels["force_served"][:] = math.nan
    assert not [name for name in summarise(channels, STEP) if name.startswith("force_")]


@pytest.mark.parametrize("step", [0.0005, 0.001, 0.005])
def test_the_jerk_of_a_tone_is_its_acceleration_times_its_angular_frequency(step):
    tone = np.sin(2 * np.pi * 4.0 * step * np.arange(round(5.0 / step) + 1))
    found = summarise({"driver_acceleration": tone}, step)["driver_jerk_rms"]
    assert found.unit == "m/s^3" and found.value == pytest.approx(2 * np.pi * 4.0 / math.sqrt(2.0), rel=1e-3)
    assert "driver_jerk_rms" not in summarise({"driver_acceleration": [1.0]}, step)
