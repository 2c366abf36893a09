"""Effects are put where they act, in order, and leave everything else as it was."""

from typing import NamedTuple

import numpy as np
import pytest

from seatsim.effects.seat import Friction
from seatsim.rig.coil import Coil
from seatsim.rig.plant import Plant
from seatsim.rig.temperature import TemperatureFactors
from seatsim.simulation.augment import (
    augment_coil,
    augment_factors,
    augment_plant,
    augment_temperature,
    read_sensors,
    select_in_loop,
    undo_reading,
)

PLANT_80 = Plant(20.0, 80.0, 4600.0, 150.0, 60000.0, 1500.0)
COIL = Coil(rate=130.0, max_current=1.0)


class Doubled(NamedTuple):
    """An effect that doubles whatever it may change."""

    def plant(self, plant):
        return plant._replace(driver_mass=2.0 * plant.driver_mass)

    def coil(self, coil):
        return coil._replace(rate=2.0 * coil.rate)

    def factors(self, factors):
        return factors._replace(viscous=2.0 * factors.viscous)

    def temperature(self, step, values):
        return 2.0 * values + step

    def frame_force(self, time, seed):
        return time + seed

    def reading(self, channel, step, values):
        return 2.0 * values if channel == "damper_force" else values

    def truth(self, channel, step, values):
        return 0.5 * values if channel == "damper_force" else values


class Raised(Doubled):
    """One that adds one to readings."""

    def reading(self, channel, step, values):
        return values + 1.0

    def truth(self, channel, step, values):
        return values - 1.0


TWICE = (Doubled(), Doubled())


def test_parts_are_changed_by_each_effect_in_turn():
    assert augment_plant(TWICE, PLANT_80) == PLANT_80._replace(driver_mass=320.0)
    assert augment_coil(TWICE, COIL) == COIL._replace(rate=520.0)
    assert augment_factors(TWICE, TemperatureFactors(viscous=-0.01)).viscous == -0.04
    assert augment_temperature(TWICE, 0.5, np.array([1.0])) == pytest.approx([2.0 * 2.5 + 0.5])


def test_readings_are_made_in_order_and_undone_in_the_opposite_one():
    effects, values = (Doubled(), Raised()), np.array([1.0, 4.0])
    both = read_sensors(effects, 0.1, {"damper_force": values, "coil_current": values})
    assert both["damper_force"] == pytest.approx([3.0, 9.0])
    assert undo_reading(effects, both["damper_force"], "damper_force", 0.1) == pytest.approx(values)
    assert both["coil_current"] == pytest.approx(values + 1.0)


def test_a_second_effect_of_a_kind_is_carried_beside_the_first():
    one, two = (Friction(force) for force in (20.0, 30.0))
    carried, alone = select_in_loop([one, two])[1], select_in_loop([one])[1]
    assert len(carried) == len(alone) + 1 and {one, two} <= set(carried) and carried[-1] is two
