"""The true rig against closed forms, energy and scipy; `test_scenarios` pins what each of its equations does."""

import numpy as np
from scipy.signal import lsim

from seatsim.blind.make.draw_experiment import RIGS
from seatsim.blind.truth.rig import EXCITATION_RATE, INTEGRATION_STEP, SAMPLE_RATE, Inputs, simulate
from seatsim.blind.truth.state import parameter_record


def test_a_linear_rig_moves_as_its_transfer_function():
    linear = RIGS.plant | RIGS.coil | {"is_bingham": 1.0, "v_ref": 1.0, "c_a": 400.0}
    rows = round(2.0 * SAMPLE_RATE)
    rng = np.random.default_rng(0)
    samples = round(2.0 * EXCITATION_RATE) + 1
    time = np.arange(samples) / EXCITATION_RATE
    floor = np.convolve(rng.standard_normal(samples), np.ones(40) / 40.0, "same")
    force = 30.0 * np.sin(2.0 * np.pi * 3.0 * time)
    motion = simulate(parameter_record(linear), Inputs(floor, EXCITATION_RATE, force, np.zeros(6), np.zeros(rows)))
    ms, m, kf, cf, kc, cc = RIGS.plant.values()
    c = cf + 400.0
    frame = [-kf / ms, -c / ms, kc / ms, cc / ms]
    driver = [0.0, 0.0, -kc / m, -cc / m]
    A = np.array([[0, 1, 0, 0], frame, [0, 0, 0, 1], [b - a for a, b in zip(frame, driver, strict=True)]])
    B = np.array([[0, 0, 0], [-1, 1 / ms, 0], [0, 0, 0], [0, -1 / ms, 0]])
    C = np.array([frame, driver, [1, 0, 0, 0], [0, 400.0, 0, 0]])
    D = np.array([[0, 0, 1 / ms], [0, 0, 0], [0, 0, 0], [0, 0, 0]])
    # the rig holds the frame force over a step of 0.1 ms, so its motion is half a step late on average
    late = 30.0 * np.sin(2.0 * np.pi * 3.0 * (time - 0.5 * INTEGRATION_STEP))
    _, expected, _ = lsim((A, B, C, D), np.column_stack([floor, late, force]), time)
    step = round(EXCITATION_RATE / SAMPLE_RATE)
    found = (motion.frame, motion.driver, motion.displacement, motion.force)
    for values, exact in zip(found, expected.T, strict=True):
        np.testing.assert_allclose(values[5:], exact[::step][5:rows], atol=2e-4 * np.std(exact))
