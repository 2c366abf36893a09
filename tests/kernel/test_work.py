"""A run that needs far shorter steps than were asked for is given up, on the seat as on the bench."""

from dataclasses import replace

import numpy as np
import pytest

import seatsim
from seatsim.dampers.bouc_wen import BoucWen
from seatsim.kernel.hooks import MOST_DEBT, MOST_WORK, owe
from seatsim.schema.errors import RunError
from seatsim.simulation.damper_bench import bench_force


def test_parts_beyond_the_mean_are_owed_and_those_below_it_pay_back():
    assert owe(0.0, 1.0) == 0.0
    assert owe(0.0, MOST_WORK + 30.0) == 30.0
    assert owe(30.0, 1.0) == 0.0
    assert owe(500.0, 60.0) == 500.0 + 60.0 - MOST_WORK


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
