"""Every value of a sample stands in the column of its name."""

import numpy as np

from seatsim.kernel.channels import CHANNELS, CURRENT_COMMAND, Sample, write_row
from seatsim.kernel.rig import RigForces
from seatsim.kernel.step import IntegratorState


def test_a_row_has_every_value_in_the_column_of_its_name():
    state, rates = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0), (2.0, 20.0, 4.0, 40.0, 0.0, 0.0, 0.0, 0.0)
    now = IntegratorState(state, rates, RigForces(9.0, 0.0, 0.0), 0.0, 1e-3, 0.0)
    row = np.full(len(CHANNELS), np.nan)
    write_row(row, now, Sample(100.0, 10.0, 11.0, 12.0, 13.0, 14.0))
    assert dict(zip(CHANNELS, row, strict=True)) == {
        "floor_acceleration": 100.0, "frame_acceleration": 120.0, "driver_acceleration": 160.0,
        "suspension_displacement": 1.0, "suspension_velocity": 2.0, "cushion_displacement": 3.0,
        "cushion_velocity": 4.0, "damper_force": 9.0, "wanted_force": 10.0, "force_served": 11.0, "coil_current": 12.0,
        "current_command": 13.0, "damper_temperature": 14.0, "energy_floor": 5.0, "energy_damper": 6.0,
        "energy_suspension": 7.0, "energy_cushion": 8.0,
    }  # fmt: skip
    assert row[CURRENT_COMMAND] == 13.0
