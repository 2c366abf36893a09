"""What acts on the rig between two samples, out of the inputs of a run and the commands so far."""

import numpy as np
import pytest

from seatsim.kernel.generic import TrueModel
from seatsim.kernel.loop_data import CHANNELS, CURRENT_COMMAND, LoopInputs, LoopSetup, Timing, step_inputs
from seatsim.kernel.rig import Rig
from seatsim.rig.coil import Coil
from seatsim.rig.plant import Plant
from seatsim.rig.temperature import TemperatureFactors, Thermal

from .uncompiled import Commanded, Linear

NONE = np.zeros(0)
FLOOR, FRAME, DRIVER = np.array([1.0, 3.0, 2.0, 7.0]), np.array([10.0, 40.0, 20.0, 0.0]), np.array([5.0, 4.0, 1.0, 9.0])
INPUTS = LoopInputs(FLOOR, np.zeros(4), np.full(4, 20.0), NONE, NONE, FRAME, DRIVER, start_current=0.25)
COMMANDS = np.array([0.1, 0.2, 0.9, 0.4])


def between(k, inputs=INPUTS, late=0, split=0.0, most=0.8, first=0.33):
    """The inputs of the step after sample k; commands of later samples are not written yet."""
    out = np.full((4, len(CHANNELS)), np.nan)
    out[: k + 1, CURRENT_COMMAND] = COMMANDS[: k + 1]
    coil = Coil(max_current=most)
    timing = Timing(1e-3, 1, 1e-4, False)
    law, model = Commanded(), TrueModel(Linear(), 1)
    setup = LoopSetup(
        Rig(Plant(*range(1, 7)), Linear()), coil, TemperatureFactors(), Thermal(), law, model, timing, 1.0
    )
    return step_inputs(setup, inputs, out, k, first, late, split, (0.5, 0.6))


def test_floor_and_forces_run_from_sample_to_sample():
    found = between(1)
    assert (found.floor, found.floor_rise) == (3.0, -1.0)
    assert (found.frame_force, found.frame_force_rise) == (40.0, -20.0)
    assert (found.driver_force, found.driver_force_rise) == (4.0, -3.0)
    assert (found.length, found.current, found.kept) == (1e-3, 0.33, (0.5, 0.6))


@pytest.mark.parametrize(
    ("k", "late", "before", "after"),
    [(0, 0, 0.25, 0.1), (1, 0, 0.1, 0.2), (2, 0, 0.2, 0.8), (0, 1, 0.25, 0.25), (1, 1, 0.25, 0.1), (2, 1, 0.1, 0.2),
     (2, 2, 0.25, 0.1), (1, 3, 0.25, 0.25)],
)  # fmt: skip
def test_commands_act_late_and_no_more_than_the_driver_can_give(k, late, before, after):
    found = between(k, late=late, split=2e-4)
    assert (found.before, found.after, found.split) == (before, after, 2e-4)
    assert not found.prescribed


def test_a_prescribed_current_goes_to_its_next_sample():
    found = between(1, INPUTS._replace(prescribed=np.array([0.5, 0.6, 0.7, 0.9])), late=1)
    assert found.prescribed and found.after == 0.7
