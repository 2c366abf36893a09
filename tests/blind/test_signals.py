"""Excitations, forces on the frame and sensor faults: spectra, sizes and delays."""

import numpy as np
import pytest
from scipy.signal import welch

from seatsim.blind.truth import experiment
from seatsim.blind.truth.excitation import coloured_noise
from seatsim.blind.truth.faults import SensorFault
from seatsim.blind.truth.rig import SAMPLE_RATE, RigMotion


def test_coloured_noise_has_unit_variance_and_its_slope():
    noise = coloured_noise(np.random.default_rng(0), 200_000, 0.5, 200.0, -1.0, 500.0)
    f, power = welch(noise, 500.0, nperseg=4096)
    assert np.std(noise) == pytest.approx(1.0)
    assert np.sqrt(power[f.searchsorted(4.0)] / power[f.searchsorted(16.0)]) == pytest.approx(4.0, rel=0.2)
    assert power[f > 61.0].max() < 1e-6 * power.max()
    half = coloured_noise(np.random.default_rng(0), 200_000, 0.5, 10.0, 0.0, 500.0)
    f, power = welch(half, 500.0, nperseg=4096)
    at = {
        hertz: np.mean(power[f.searchsorted(hertz - 0.3) : f.searchsorted(hertz + 0.3)]) for hertz in (3.0, 10.0, 20.0)
    }
    assert at[10.0] / at[3.0] == pytest.approx(0.5, rel=0.3)
    assert at[20.0] / at[3.0] == pytest.approx(1.0 / 257.0, rel=0.4)


def faulty(kind, u, size, **other: float):
    fault = SensorFault(kind, "damper_force", size, **other)
    return experiment.apply_fault(u, 10.0 + 0.0 * u, fault, 0)


@pytest.mark.parametrize("kind", ["lag_second", "lag_average"])
@pytest.mark.parametrize("delay", [0.003, 0.02])
def test_lagging_sensors_delay_a_ramp_by_their_size(kind, delay):
    ramp = 5.0 * np.arange(1000) / SAMPLE_RATE
    np.testing.assert_allclose((ramp - faulty(kind, ramp, delay))[500:], 5.0 * delay, rtol=1e-6)


def motion(rows=500):
    flat, fine = np.zeros(rows), np.arange(rows * 20) / (20.0 * SAMPLE_RATE)
    return RigMotion(flat, flat + 1.0, flat, flat + 2.0, np.arange(rows) * 1.0, fine[::20], flat + 3.0, fine)


def test_a_late_log_is_late_by_its_size():
    late = SensorFault("skew", "log", 0.01)
    read = experiment.read_sensors(motion(), np.arange(2000.0), [late], 0)
    np.testing.assert_allclose(read["coil_current"][50:], motion().current[50:] - 0.01)
    np.testing.assert_allclose(read["current_command"][50:], motion().command[50:] - 5.0)
    np.testing.assert_array_equal(read["floor_acceleration"], np.arange(0.0, 2000.0, 4.0))
    drifting = late._replace(detail=0.5)
    assert late.on_input and not SensorFault("gain", "damper_force", 0.1).on_input
    for run, left in ((0, 1.0 - 0.5 * 0.6), (1, 0.5)):
        read = experiment.read_sensors(motion(), np.arange(2000.0), [drifting], run)
        assert motion().current[-1] - read["coil_current"][-1] == pytest.approx(0.01 * left)
