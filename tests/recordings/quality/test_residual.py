"""Consistency residuals: 0 where channels agree, 1 where one is silent, 4/2 where it is turned; delays by rows."""

import numpy as np
import pytest

from seatsim.recordings.quality.consistency import simulate_nominal
from seatsim.recordings.quality.issue import RunUnderTest
from seatsim.recordings.quality.relations import consistency_residuals, filter_band, find_delay
from seatsim.recordings.recording import load_recording

RATE = 250.0
TIME = np.arange(5000) / RATE
OMEGA = 2 * np.pi * 2.0


def swinging(scale=1.0, lag=0.0):
    return scale * np.sin(OMEGA * (TIME - lag))


@pytest.mark.parametrize(("factor", "expected"), [(1.0, 0.0), (0.0, 1.0), (-1.0, 2.0), (2.0, 0.2), (1000.0, 0.998)])
def test_the_residual_of_a_scaled_channel(under_test, factor, expected):
    """(1 - f)^2 / (1 + f^2) for a recorded channel f times the simulated one."""
    table = {"driver_acceleration": factor * swinging()}
    outputs = {"driver_acceleration": swinging()[250:]}
    (found,) = consistency_residuals(under_test(table), table, outputs).values()
    assert found == pytest.approx(expected, abs=2e-3)


def balanced(run):
    """Channels of a seat that moves at one frequency as its equations of motion say."""
    plant, x = run.nominal.plant, swinging(0.01)
    speed, floor = 0.01 * OMEGA * np.cos(OMEGA * TIME), 0.5 * swinging(lag=0.1)
    frame, driver = floor - OMEGA**2 * x, swinging(0.8, 0.05)
    force = -(plant.frame_mass * frame + plant.driver_mass * driver + plant.suspension_stiffness * x
              + plant.suspension_damping * speed)  # fmt: skip
    return {"floor_acceleration": floor, "frame_acceleration": frame, "driver_acceleration": driver,
            "suspension_displacement": x, "damper_force": force}  # fmt: skip


def test_channels_that_obey_the_equations_of_motion_balance(under_test):
    run = under_test(dict.fromkeys(["floor_acceleration"], TIME))
    table = balanced(run)
    outputs = {name: values[250:] for name, values in table.items()}
    found = consistency_residuals(run, table, outputs)
    assert {"motion balance", "force balance"} <= set(found)
    assert max(found.values()) < 2e-3


@pytest.mark.parametrize(
    ("channel", "upset"), [("suspension_displacement", {"motion balance", "force balance"}),
                           ("damper_force", {"force balance"}), ("floor_acceleration", {"motion balance"})],
)  # fmt: skip
def test_a_flipped_sign_upsets_the_balances_that_the_channel_stands_in(under_test, channel, upset):
    run = under_test(dict.fromkeys(["floor_acceleration"], TIME))
    table = balanced(run)
    outputs = {name: values[250:] for name, values in table.items()}
    faulty = {**table, channel: -table[channel]}
    found = consistency_residuals(run, faulty, outputs)
    assert {name for name in ("motion balance", "force balance") if found[name] > 0.02} == upset
    if channel in outputs and channel != "floor_acceleration":
        assert found[channel] == pytest.approx(2.0, abs=1e-6)


def test_a_band_holds_2_hz_and_neither_drift_nor_noise(under_test):
    run = under_test({"floor_acceleration": TIME})
    middle = slice(1000, 4000)
    assert filter_band(run, swinging())[middle] == pytest.approx(swinging()[middle], abs=0.02)
    for values in (np.full(5000, 3.0), np.sin(2 * np.pi * 0.02 * TIME), np.sin(2 * np.pi * 60.0 * TIME)):
        assert np.max(np.abs(filter_band(run, values)[middle])) < 0.02


@pytest.mark.parametrize("rows", [-20, 0, 7, 30])
def test_a_delay_is_found_in_rows(rows):
    signal = np.random.default_rng(0).standard_normal(3000)
    late = np.roll(signal, rows)
    found, alike = find_delay(late[100:-100], signal[100:-100], 50)
    assert found == rows and alike > 0.97
    assert find_delay(-late[100:-100], signal[100:-100], 50)[1] < 0.5


def test_the_nominal_rig_is_driven_by_the_table_at_hand(sound):
    recording = load_recording(sound)
    run = RunUnderTest("run-1", recording.table("run-1"), recording, recording.nominal)
    outputs = simulate_nominal(run, run.table)
    found = consistency_residuals(run, run.table, outputs)
    assert max(found[name] for name in outputs) < 1e-3 and set(outputs) < set(found)
    still = simulate_nominal(run, {**run.table, "floor_acceleration": np.zeros(run.rows)})
    assert np.max(np.abs(still["driver_acceleration"])) < 1e-9
    assert still["coil_current"] == pytest.approx(outputs["coil_current"], abs=1e-9)
