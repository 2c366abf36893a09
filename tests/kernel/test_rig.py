"""The derivative of the rig's state: linear matrices, set-valued friction, effects, and the balance of energy."""

from typing import NamedTuple

import pytest

from seatsim.kernel.rig import Disturbance, Rig, derivative
from seatsim.rig.plant import Plant
from seatsim.rig.state import MECHANICAL, SUSPENSION_WORK
from seatsim.rig.temperature import TemperatureScaling

from .uncompiled import Linear, plugged

PLANT = Plant(20.0, 80.0, 4600.0, 150.0, 60000.0, 1500.0, damper_ratio=0.7)
HOT = TemperatureScaling(0.8, 0.9, 0.7)
STATE = (0.011, 0.23, -0.004, 0.17, 0.0, 0.0, 0.0, 0.0)
DISTURBANCE = Disturbance(1.3, 25.0, -40.0)


@plugged("seat effect", initial=(0.3,))
class SeatEffect(NamedTuple):
    """An effect that answers to every hook of the seat."""

    inner: float = 12.0

    def suspension_force(self, plant, x, v, z):
        return 0.1 * plant.suspension_stiffness * x + 7.0 * v + z[0]

    def linkage_friction(self, z):
        return 30.0

    def cushion_force(self, force, plant, xc, vc, z):
        return 1.5 * force

    def inner_mass(self, plant, z):
        return self.inner

    def inner_force(self, plant, z):
        return 11.0

    def rates(self, plant, motion, z):
        return (motion.driver - motion.frame + motion.xc + motion.vc + motion.x + motion.v,)


def test_effects_add_to_the_seat():
    plant = PLANT._replace(damper_ratio=1.0)
    rates, forces = derivative(Rig(plant, Linear(), (SeatEffect(),)), (*STATE, 0.3), DISTURBANCE, 0.5, HOT, 1.0)
    x, v, xc, vc = STATE[:4]
    damper = 950.0 * 0.8 * v + 900.0 * x
    cushion = 1.5 * (60000.0 * xc + 1500.0 * vc)
    resistance = 150.0 * v + 460.0 * x + 7.0 * v + 0.3
    frame = (cushion - 4600.0 * x - resistance - damper - 30.0 + 25.0) / 20.0
    driver = (11.0 - cushion - 40.0) / (80.0 - 12.0)
    assert rates[:4] == pytest.approx((v, frame - 1.3, vc, driver - frame), rel=1e-12)
    assert rates[MECHANICAL:] == pytest.approx((driver - frame + xc + vc + x + v,), rel=1e-12)
    assert forces == pytest.approx((damper, 30.0, 30.0), rel=1e-12)


@pytest.mark.parametrize("slip", [1.0, -1.0])
def test_damper_and_linkage_share_the_friction(slip):
    plant = PLANT._replace(damper_ratio=0.5)
    damper = Linear(friction=100.0)
    smooth = derivative(Rig(plant, Linear(), (SeatEffect(),)), (*STATE, 0.3), DISTURBANCE, 0.5, HOT, slip)
    rough = derivative(Rig(plant, damper, (SeatEffect(),)), (*STATE, 0.3), DISTURBANCE, 0.5, HOT, slip)
    limit = 0.5 * 100.0 * 0.7
    assert rough[1].friction_limit == pytest.approx(limit + 30.0)
    assert rough[1].friction == pytest.approx(slip * (limit + 30.0))
    assert rough[1].damper_force - smooth[1].damper_force == pytest.approx(slip * 70.0)
    assert rough[0][1] - smooth[0][1] == pytest.approx(-slip * limit / 20.0)
    x, v = STATE[:2]
    resistance = 150.0 * v + 460.0 * x + 7.0 * v + 0.3
    assert rough[0][SUSPENSION_WORK] == pytest.approx((resistance + slip * 30.0) * v)
    assert smooth[0][SUSPENSION_WORK] == pytest.approx((resistance + slip * 30.0) * v)
