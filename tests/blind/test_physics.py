"""The true rig against closed forms, energy and scipy; `test_scenarios` pins what each of its equations does."""

import numpy as np
import pytest
from scipy.signal import lsim

from seatsim.blind.make.draw_experiment import BINGHAM, COIL, PLANT
from seatsim.blind.truth import coil, damper, state
from seatsim.blind.truth.rig import EXCITATION_RATE, INTEGRATION_STEP, SAMPLE_RATE, Inputs, simulate
from seatsim.blind.truth.state import parameter_record

BINGHAM_SEAT = PLANT | BINGHAM | COIL


def at(**values: float):
    y = np.zeros(state.STATES)
    for name, value in values.items():
        y[getattr(state, name)] = value
    return y


def test_temperatures_keep_the_energy():
    rates = np.zeros(state.STATES)
    y = at(T_FLUID=50.0, T_HOUSING=30.0, T_THERMOMETER=25.0)
    coil.write_heat_rates(y, rates, -70.0, parameter_record(BINGHAM_SEAT))
    stored, lost = 60.0 * rates[state.T_FLUID] + 700.0 * rates[state.T_HOUSING], 1.5 * (30.0 - 20.0)
    assert stored == pytest.approx(70.0 - lost)


def test_a_loose_damper_bears_what_its_mount_transmits():
    p = parameter_record(BINGHAM_SEAT | {"play_gap": 0.001, "mount_stiffness": 4e6})
    for wanted in (-300.0, 5.0, 900.0):
        memory = np.zeros(state.MEMORIES)
        v = damper.piston_speed(at(CURRENT=0.4), memory, 0.0, wanted, p)
        assert damper.main_force(at(CURRENT=0.4), memory, 0.0, v, p) == pytest.approx(wanted, abs=0.05)
        assert memory[state.V_PISTON] == v
        bracketed = damper.bracketed_speed(at(CURRENT=0.4), memory, 0.0, wanted, 0.0, p)
        assert damper.main_force(at(CURRENT=0.4), memory, 0.0, bracketed, p) == pytest.approx(wanted, abs=0.05)


def test_dropouts_begin_at_the_same_times_whatever_the_step():
    p = parameter_record({"dropout_interval": 0.3, "dropout_duration": 0.05})

    def begins(h):
        memory = np.zeros(6)
        off = np.array([coil.drops_out(n * h, h, memory, p) for n in range(round(5.0 / h))])
        return list(np.round(np.flatnonzero(np.diff(off.astype(int)) > 0) * h, 2))

    assert begins(1e-4) == begins(2.5e-4) != []


def test_a_linear_rig_moves_as_its_transfer_function():
    linear = PLANT | COIL | {"is_bingham": 1.0, "v_ref": 1.0, "c_a": 400.0}
    rows = round(2.0 * SAMPLE_RATE)
    rng = np.random.default_rng(0)
    samples = round(2.0 * EXCITATION_RATE) + 1
    time = np.arange(samples) / EXCITATION_RATE
    floor = np.convolve(rng.standard_normal(samples), np.ones(40) / 40.0, "same")
    force = 30.0 * np.sin(2.0 * np.pi * 3.0 * time)
    motion = simulate(parameter_record(linear), Inputs(floor, EXCITATION_RATE, force, np.zeros(6), np.zeros(rows)))
    ms, m, kf, cf, kc, cc = PLANT.values()
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
