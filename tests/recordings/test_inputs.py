"""What drove a rig is read off its table: linear between rows, commands held, steps that divide the rows."""

from pathlib import Path

import numpy as np
import pytest

from seatsim.recordings.recording import BENCH_CHANNELS, SEAT_CHANNELS, ChannelEntry, Header, Recording, RunEntry
from seatsim.recordings.replay import recorded_inputs
from seatsim.simulation.inputs import BenchInputs


def recording_of(rig, table, rate, gain=None):
    units = SEAT_CHANNELS if rig == "seat" else BENCH_CHANNELS
    channels = {name: ChannelEntry(units[name], 0.5) for name in table}
    return Recording(Path("nowhere"), Header(rig, rate, "nominal.yaml"), {"a": RunEntry("a", "a.csv")}, channels, gain)


CHANNELS = ("floor_acceleration", "current_command", "coil_current", "damper_temperature")
ROWS = np.array([[0.0, 4.0, -2.0], [0.2, 0.6, 0.9], [0.1, 0.5, 0.3], [20.0, 24.0, 26.0]])
TABLE = dict(zip(CHANNELS, ROWS, strict=True))


def test_a_seat_is_driven_linearly_between_rows_with_commands_held():
    inputs = recorded_inputs(recording_of("seat", TABLE, 250.0), TABLE, 0.002)
    floor = inputs.floor
    assert floor.acceleration == pytest.approx([0.0, 2.0, 4.0, 1.0, -2.0])
    assert floor.command == pytest.approx([0.2, 0.2, 0.6, 0.6, 0.9])
    assert floor.coil_current == pytest.approx([0.1, 0.3, 0.5, 0.4, 0.3])
    assert floor.temperature == pytest.approx([20.0, 22.0, 24.0, 25.0, 26.0])
    assert all(force.size == 0 for force in inputs.forces)


def test_a_bench_is_driven_row_by_row():
    names = ("displacement", "velocity", "command_voltage", "coil_current", "damper_temperature", "damper_force")
    table = {name: np.arange(4.0) + 10 * k for k, name in enumerate(names)}
    inputs = recorded_inputs(recording_of("damper_bench", table, 500.0, gain=0.4), table, 0.001)
    assert isinstance(inputs, BenchInputs)
    assert (inputs.interval, inputs.displacement_noise, inputs.voltage_gain) == (0.002, 0.5, 0.4)
    assert inputs.current_command is None
    for name in names[:-1]:
        assert getattr(inputs, name) is table[name]
