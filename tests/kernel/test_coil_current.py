"""The current that follows a known command, against exponentials written out."""

import numpy as np
import pytest

from seatsim.kernel.bench import follow_command
from seatsim.rig.coil import Coil

STEP = 2e-3
COIL = Coil(rate=150.0, rate_fall=60.0)


@pytest.mark.parametrize("rows", [1, 3])
def test_a_delay_of_whole_steps_moves_the_rows(rows):
    command = np.random.default_rng(3).uniform(0.0, 1.0, 30)
    late = follow_command(COIL._replace(delay=rows * STEP), command, STEP, 0.4)
    assert late[: rows + 1].tolist() == [0.4] * (rows + 1)
    assert late[rows:].tolist() == follow_command(COIL, command, STEP, 0.4)[:-rows].tolist()


@pytest.mark.parametrize("quarters", [1, 3, 5, 10])
def test_a_delay_within_a_step_is_that_of_finer_steps(quarters):
    command = np.random.default_rng(4).uniform(0.0, 1.0, 30)
    coarse = follow_command(COIL._replace(delay=quarters * STEP / 4), command, STEP, 0.4)
    fine = follow_command(COIL._replace(delay=quarters * STEP / 4), np.repeat(command, 4), STEP / 4, 0.4)
    np.testing.assert_allclose(coarse, fine[::4], rtol=1e-10)
