"""False position with the Illinois step, wherever it is used: to the root, in no more evaluations than it takes.

Without the step, or with another one, a curved function is either not solved or asked for more often.
"""

import math
from typing import NamedTuple

import numpy as np
import pytest

from seatsim.kernel.augmented import SETTLING, _piston_speed
from seatsim.kernel.inverse import CELLS, _bracket, invert
from seatsim.kernel.rig import Rig
from seatsim.kernel.step import StepInputs, _end_of_phase, disturbance_at, start, take_substep
from seatsim.rig.coil import Coil
from seatsim.rig.plant import Plant
from seatsim.rig.state import MECHANICAL
from seatsim.rig.temperature import TemperatureScaling
from seatsim.simulation.coupled import _agree

from .dampers import Parabola
from .test_augmented import Mount

NONE = TemperatureScaling()


class Curved(NamedTuple):
    """`F = v (exp(bend i) - 1)`, which notes the currents that it is asked for."""

    asked: list
    bend: float

    def force(self, x, v, i, scaling, z):
        self.asked.append(i)
        return v * math.expm1(self.bend * i)


class Braking(NamedTuple):
    """`F = c v` with a set-valued friction, which notes the speeds that it is asked for."""

    asked: list
    c: float = 2e4
    friction: float = 20.0

    def force(self, x, v, i, scaling, z):
        self.asked.append(v)
        return self.c * v

    def coulomb(self, i, scaling):
        return self.friction


class Cubic(NamedTuple):
    """`F = 1e4 u^3 + 50 u`, which notes the speeds that it is asked for."""

    asked: list

    def force(self, x, v, i, scaling, z):
        self.asked.append(v)
        return (1e4 * v**3 + 50.0 * v) * scaling.viscous


@pytest.mark.parametrize(
    "bend, root, most", [(-8.0, 0.1, 11), (-8.0, 0.9, 17), (2.0, 0.5, 9), (8.0, 0.1, 17), (8.0, 0.9, 12)]
)
def test_a_curved_map_of_the_inverse_is_solved_to_rounding(bend, root, most):
    damper, wanted = Curved([], bend), math.expm1(bend * root)
    found = _bracket(damper, wanted, 0.0, 1.0, NONE, (), 0.0, -wanted, 1.0, math.expm1(bend) - wanted)
    assert found == pytest.approx(root, abs=2e-14) and len(damper.asked) <= most


@pytest.mark.parametrize("v, most", [(1e-5, 4), (1e-4, 5), (5e-4, 7)])
def test_a_block_that_is_braked_comes_to_rest_at_its_time(v, most):
    damper, plant = Braking([]), Plant(20.0, 80.0, 0.0, 0.0, 1e-9, 0.0)
    rig, coil = Rig(plant, damper), Coil(rate=150.0)
    inputs = StepInputs(1e-3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, False, (1.0, 1.0))
    now = start(rig, (0.0, v, *(0.0,) * (MECHANICAL - 2)), disturbance_at(inputs, 0.0), 0.0, NONE, 1e-3)
    state, _, forces, _, _ = take_substep(rig, coil, inputs, NONE, now, 0.0, 1e-3)
    damper.asked.clear()
    h, state, _, _ = _end_of_phase(rig, coil, inputs, NONE, now, 0.0, 1e-3, state, forces)
    # `20 v' = -c v - friction`; a sub-step asks for four forces.
    assert h == pytest.approx(math.log1p(damper.c * v / damper.friction) * 20.0 / damper.c, rel=5e-4)
    assert abs(state[1]) <= 1e-10 and len(damper.asked) <= 4 * most


def test_a_block_on_a_floor_that_gathers_speed_comes_to_rest_at_its_time():
    plant = Plant(20.0, 80.0, 0.0, 0.0, 1e-9, 0.0)
    damper, coil, v = Braking([], 0.0, 1e-3), Coil(rate=150.0), 1e-4
    rig, inputs = Rig(plant, damper), StepInputs(1e-3, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, False, (1.0, 1.0))
    now = start(rig, (0.0, v, *(0.0,) * (MECHANICAL - 2)), disturbance_at(inputs, 0.0), 0.0, NONE, 1e-3)
    state, _, forces, _, _ = take_substep(rig, coil, inputs, NONE, now, 0.0, 1e-3)
    damper.asked.clear()
    h, state, _, _ = _end_of_phase(rig, coil, inputs, NONE, now, 0.0, 1e-3, state, forces)
    # `v - friction t / 20 - 1000 t^2 / 2 = 0`.
    assert h == pytest.approx(math.sqrt(2.0 * v / 1000.0), rel=1e-3)
    assert abs(state[1]) <= 1e-10 and len(damper.asked) <= 4 * 7


@pytest.mark.parametrize("elongation, most", [(0.002, 12), (-0.004, 22), (0.0001, 18)])
def test_a_curved_damper_behind_a_mount_is_solved(elongation, most):
    damper, v = Cubic([]), 0.3
    own = damper.force(0.0, v, 0.0, NONE, ())
    u = _piston_speed(damper, (Mount(),), 0.0, v, 0.0, NONE, (), (elongation,), own)
    borne = damper.force(0.0, u, 0.0, NONE, ()) + (u - v) * 1e5 / SETTLING
    assert borne == pytest.approx(1e5 * elongation, abs=0.011) and len(damper.asked) <= 2 * most


@pytest.mark.parametrize(
    "answer, slope, most", [(np.tanh, 2.0, 6), (np.tanh, 20.0, 10), (np.expm1, 2.0, 8), (np.expm1, 20.0, 21)]
)
def test_rig_and_unit_agree_on_a_force_in_few_trials(answer, slope, most):
    asked = []

    def miss(trial):
        asked.append(trial)
        return 100.0 * answer(-slope * (trial - 30.0) / 100.0) + 30.0 - trial

    _agree(miss, 5.0, lambda: None)
    assert asked[-1] == pytest.approx(30.0, abs=1e-5) and len(asked) <= most


class Ulps(NamedTuple):
    """`F = v (1 + i)` with a current in units of the last place of 1, or three: a line, but for its rounding."""

    rise: float

    def force(self, x, v, i, scaling, z):
        return v * (1.0 + self.rise * i)


def test_a_line_whose_middle_is_rounded_is_solved_as_a_line():
    # 3 units in the last place from end to end: the middle rounds to 2 of them, which a parabola through it would meet
    # a sixth of the range before the line does.
    unit = np.spacing(1.0)
    found = invert(Ulps(3.0 * unit), 2, 1.0 + 2.0 * unit, 0.0, 1.0, NONE, (), 1.0, np.empty(CELLS + 1))
    assert found.current == pytest.approx(2.0 / 3.0, rel=1e-12)


@pytest.mark.parametrize("curvature", [3e-10, -3e-10, 1e-8])
def test_a_map_that_is_hardly_curved_is_solved_as_a_parabola(curvature):
    damper = Parabola(200.0, 200.0, curvature * 600.0)
    for root in (0.25, 0.5, 0.75):
        wanted = damper.force(0.0, 1.0, root, NONE, ())
        found = invert(damper, 2, wanted, 0.0, 1.0, NONE, (), 1.0, np.empty(CELLS + 1))
        assert found.current == pytest.approx(root, abs=1e-14)
