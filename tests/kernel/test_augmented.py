"""A damper with effects as plain Python: each hook changes its own part of force, rates and friction."""

import math
import sys
from typing import NamedTuple

import pytest

from seatsim.compilation.cached import digest
from seatsim.dampers.bingham import Bingham
from seatsim.kernel.augmented import SETTLING, AugmentedDamper, classes_of
from seatsim.rig.temperature import TemperatureScaling

from .uncompiled import Hysteretic, Linear, Yielding, plugged

WARM = TemperatureScaling(0.9, 0.8, 0.7)
X, V, AMPS = 0.01, 0.02, 0.5
DAMPER = Yielding()
VISCOUS, YIELD = 400.0 * 0.9 * V, 0.7 * 350.0 * math.tanh(2.0)


@plugged("half")
class Half(NamedTuple):
    """A gap that transmits a share, by the sign of what is demanded."""

    share: float = 0.5

    def transmitted_share(self, h, v, demanded, z):
        return h * (self.share if demanded > 0.0 else 0.25)


@plugged("scaled")
class Scaled(NamedTuple):
    """Other factors in rebound."""

    def part_scaling(self, scaling, v, z):
        rebound = 2.0 if v > 0.0 else 1.0
        return TemperatureScaling(scaling.viscous * rebound, scaling.stiffness, scaling.yield_force * 0.5)


@plugged("saturated")
class Saturated(NamedTuple):
    """A yield part that feels less current."""

    def yield_current(self, i, z):
        return 0.6 * i


@plugged("beside", initial=(0.2, 0.4))
class Beside(NamedTuple):
    """A force and a friction beside the damper's, and a state that notes what its rates are given."""

    def added_force(self, x, v, z):
        return 1000.0 * x + 10.0 * z[1]

    def stiction(self, z):
        return 25.0

    def rates(self, x, v, u, i, demanded, target, z):
        return (x + v + i + demanded, u + 100.0 * target)


@plugged("late", initial=(0.3,))
class Late(NamedTuple):
    """A yield part that is built out of the damper's own, of that at a late speed, and of a state."""

    def yield_speed(self, v, z):
        return 0.25 * v

    def yield_shape(self, shape, target, late, z):
        return 0.5 * target + 0.3 * late + 0.2 * z[0]

    def rates(self, x, v, u, i, demanded, target, z):
        return (target - z[0],)


@plugged("mount", initial=(0.001,))
class Mount(NamedTuple):
    """An elastic mount whose state is its elongation."""

    stiffness: float = 1e5

    def mount_force(self, force, z):
        return self.stiffness * z[0]

    def mount_stiffness(self, z):
        return self.stiffness

    def rates(self, x, v, u, i, demanded, target, z):
        return (v - u,)


def force(*effects, damper=DAMPER, v=V, z=()):
    return AugmentedDamper(damper, effects).force(X, v, AMPS, WARM, z)


def rates(*effects, damper=DAMPER, v=V, z=()):
    return AugmentedDamper(damper, effects).rates(X, v, AMPS, WARM, z)


def limit(*effects, damper=DAMPER, v=V, z=()):
    return AugmentedDamper(damper, effects).friction_limit(v, AMPS, WARM, z)


def test_a_gap_transmits_a_share_of_force_and_speed():
    assert force(Half()) == pytest.approx(0.5 * (VISCOUS + YIELD), rel=1e-12)
    assert force(Half(), v=-V) == pytest.approx(-0.25 * (VISCOUS + YIELD), rel=1e-12)
    found = rates(Half(), Beside(), damper=Hysteretic(), z=(0.1, 0.2, 0.2, 0.4))
    demanded = 300.0 * 0.9 * V + 2000.0 * 0.5 * 0.7 * 0.1 + 20.0
    assert found == pytest.approx((50.0 * (0.5 * V - 0.1), X, X + V + AMPS + demanded, 0.5 * V), rel=1e-12)
    assert limit(Half(), damper=Linear(friction=30.0), v=-V) == pytest.approx(0.25 * 21.0)


def test_factors_act_on_the_parts():
    assert force(Scaled()) == pytest.approx(2.0 * VISCOUS + 0.5 * YIELD, rel=1e-12)
    assert force(Scaled(), v=-V) == pytest.approx(-VISCOUS - 0.5 * YIELD, rel=1e-12)
    assert limit(Scaled(), damper=Linear(friction=30.0)) == pytest.approx(10.5)


def test_the_yield_part_alone_feels_another_current():
    expected = 0.7 * (50.0 + 600.0 * 0.3) * math.tanh(2.0)
    assert force(Saturated()) == pytest.approx(VISCOUS + expected, rel=1e-12)
    friction = Yielding(coulomb_force=20.0)
    assert limit(Saturated(), damper=friction) == pytest.approx(20.0 * 1.3 * 0.7, rel=1e-12)


def test_force_and_friction_beside_the_damper():
    assert force(Beside(), z=(0.2, 0.4)) == pytest.approx(VISCOUS + YIELD + 10.0 + 4.0, rel=1e-12)
    assert limit(Beside(), damper=Linear(friction=30.0), z=(0.2, 0.4)) == pytest.approx(46.0)


def test_a_yield_part_with_a_shape_of_its_own():
    damper = Yielding(offset=8.0, coulomb_force=20.0)
    size = 0.7 * (350.0 + 20.0 * 1.5)
    target = (0.7 * 350.0 * math.tanh(2.0) + 0.7 * 30.0) / size
    late = (0.7 * 350.0 * math.tanh(0.5) + 0.7 * 30.0) / size
    expected = VISCOUS + 0.7 * 8.0 + size * (0.5 * target + 0.3 * late + 0.2 * 0.3)
    assert force(Late(), damper=damper, z=(0.3,)) == pytest.approx(expected, rel=1e-9)
    assert rates(Late(), damper=damper, z=(0.3,)) == pytest.approx((target - 0.3,), rel=1e-9)
    assert limit(Late(), damper=damper, z=(0.3,)) == 0.0


@pytest.mark.parametrize("elongation", [0.0, -0.002])
@pytest.mark.parametrize("v", [0.02, -0.3])
def test_behind_a_mount_the_damper_bears_the_mounts_force(elongation, v):
    assert force(Mount(), v=v, z=(elongation,)) == pytest.approx(1e5 * elongation, rel=1e-12)
    (widening,) = rates(Mount(), v=v, z=(elongation,))
    u = v - widening
    borne = 400.0 * 0.9 * u + 0.7 * 350.0 * math.tanh(u / 0.01) - widening * 1e5 / SETTLING
    assert borne == pytest.approx(1e5 * elongation, abs=0.011)


def test_a_loop_is_compiled_of_the_damper_and_its_effects():
    assert classes_of(DAMPER) == [Yielding]
    assert classes_of(AugmentedDamper(DAMPER, (Half(), Beside()))) == [AugmentedDamper, Yielding, Half, Beside]


def test_what_is_compiled_for_effects_is_not_taken_from_before_a_change_of_their_kernel(monkeypatch):
    damper = AugmentedDamper(Bingham(), ())

    def key():
        return digest({sys.modules[part.__module__] for part in classes_of(damper)})

    before = key()
    monkeypatch.setattr("seatsim.kernel.augmented.SETTLING", 2.0 * SETTLING)
    assert key() != before
