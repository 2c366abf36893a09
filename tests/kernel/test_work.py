"""A run that needs far shorter steps than were asked for is given up, on the seat as on the bench."""

from dataclasses import replace

import numpy as np
import pytest

import seatsim
from seatsim.dampers.bouc_wen import BoucWen
from seatsim.kernel.hooks import MOST_DEBT, MOST_WORK
from seatsim.schema.errors import RunError
from seatsim.simulation.damper_bench import bench_force


def test_a_bench_that_is_too_stiff_is_given_up():
    v = np.full(2001, 0.1)
    with pytest.raises(RunError, match="too stiff"):
        bench_force(BoucWen(A=2e8, beta=1e8, gamma=1e8, n=1.0), np.zeros(2001), v, 0.5, 20.0, 1e-3)
    assert 2001 * MOST_WORK > MOST_DEBT


def test_a_seat_that_is_too_stiff_is_given_up(seat_file):
    scenario = seatsim.load(seat_file)[0]
    light = replace(scenario, plant=scenario.plant._replace(driver_mass=1e-9))
    with pytest.raises(RunError, match="too stiff"):
        seatsim.run(light)
