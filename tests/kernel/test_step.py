"""One step of the rig, uncompiled: the current within it, the error estimate, sub-steps, and where sliding ends."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from seatsim.kernel import step as module
from seatsim.kernel.rig import STICKING, Rig
from seatsim.kernel.step import StepInputs, advance, current_at, disturbance_at, start
from seatsim.rig.coil import Coil
from seatsim.rig.plant import Plant, state_space
from seatsim.rig.state import MECHANICAL
from seatsim.rig.temperature import TemperatureScaling

from .uncompiled import Linear

pytestmark = pytest.mark.usefixtures("uncompiled")
COIL = Coil(rate=150.0, rate_fall=60.0)
PLANT = Plant(20.0, 80.0, 4600.0, 150.0, 60000.0, 1500.0)
BLOCK = Plant(20.0, 80.0, 0.0, 0.0, 1e-9, 0.0)
NONE, REST = TemperatureScaling(), (0.0,) * MECHANICAL
H = 1e-3
KEPT = (math.exp(-150.0 * 0.5 * H), math.exp(-60.0 * 0.5 * H))
STILL = StepInputs(H, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, False, KEPT)


def relaxation(start, command, rate, time):
    return command + (start - command) * math.exp(-rate * time)


@pytest.mark.parametrize("time", [0.0, 0.0002, 0.0004, 0.0007, 0.001])
def test_the_coil_turns_to_the_new_command_after_the_split(time):
    inputs = STILL._replace(current=0.5, before=1.0, after=0.2, split=0.0004)
    if time <= 0.0004:
        expected = relaxation(0.5, 1.0, 150.0, time)
    else:
        expected = relaxation(relaxation(0.5, 1.0, 150.0, 0.0004), 0.2, 60.0, time - 0.0004)
    assert current_at(COIL, inputs, time) == pytest.approx(expected, rel=1e-14)


def test_a_prescribed_current_runs_straight():
    inputs = STILL._replace(current=0.5, before=9.0, after=0.2, split=0.0004, prescribed=True)
    assert current_at(COIL, inputs, 0.0004) == pytest.approx(0.5 - 0.3 * 0.4, rel=1e-14)


@pytest.mark.parametrize("command", [1.0, 0.2])
@pytest.mark.parametrize("split", [0.0, 0.0006])
@pytest.mark.parametrize(("time", "h"), [(0.0, H), (0.0, 0.5 * H), (0.5 * H, 0.5 * H)])
def test_currents_in_the_middle_and_at_the_end_of_a_sub_step(command, split, time, h):
    inputs = STILL._replace(current=0.5, before=0.9, after=command, split=split)
    expected = [current_at(COIL, inputs, time + part * h) for part in (0.5, 1.0)]
    assert module._currents(COIL, inputs, time, h) == pytest.approx(expected, rel=1e-13)


def test_disturbances_run_straight():
    inputs = StepInputs(H, 1.0, 2.0, 0.0, 0.0, 0.0, 0.0, False, KEPT, 3.0, 4.0, 5.0, -6.0)
    assert disturbance_at(inputs, 0.25 * H) == pytest.approx((1.5, 4.0, 3.5))
    assert disturbance_at(inputs, H) == pytest.approx((3.0, 7.0, -1.0))


@pytest.mark.parametrize(
    ("h", "error", "longer"),
    [(1.0, 9.0, 1.0), (2.0, 0.0, 1.0), (0.1, 0.0, 0.4), (0.1, 1.0, 0.09), (0.1, 1e4, 0.02), (0.1, 16.0, 0.045),
     (0.5, 0.0, 1.0), (2.0**-19, 1e9, 2.0**-18), (0.1, 5e-4, 0.4), (0.1, 0.01, 0.09 / 0.01**0.25)],
)  # fmt: skip
def test_the_next_sub_step_follows_from_the_error(h, error, longer):
    assert module._longer(h, error, 1.0) == pytest.approx(longer, rel=1e-12)


def moved(damper, state, inputs, steps, tolerance=1e-4, plant=PLANT, substep=None):
    """Advance by some steps of the same kind; the floor goes on along its line."""
    rig = Rig(plant, damper)
    now = start(rig, state, disturbance_at(inputs, 0.0), inputs.current, NONE, substep or inputs.length)
    trace = [now]
    for _ in range(steps):
        now, current, good = advance(rig, COIL, inputs, NONE, now, tolerance)
        assert good
        inputs = inputs._replace(floor=inputs.floor + inputs.floor_rise, current=current)
        trace.append(now)
    return trace


def exact(damping, state, inputs, time):
    """The linear seat under a floor acceleration that runs straight, by the matrix exponential."""
    s = state_space(PLANT)
    A = s.A + s.B2 @ [[0.0, damping, 0.0, 0.0]]
    M = np.zeros((6, 6))
    M[:4, :4], M[:4, 4], M[4, 5] = A, s.B1[:, 0], inputs.floor_rise / inputs.length
    return (expm(M * time) @ [*state[:4], inputs.floor, 1.0])[:4]


SHAKEN = STILL._replace(floor=1.0, floor_rise=0.05)
MOVING = (0.01, 0.2, -0.002, 0.1, 0.0, 0.0, 0.0, 0.0)


def test_the_linear_seat_is_followed_to_the_fourth_order():
    errors = []
    for h in (4e-3, 2e-3, 1e-3):
        inputs = SHAKEN._replace(length=h, floor_rise=50.0 * h)
        now = moved(Linear(k=0.0), MOVING, inputs, round(0.04 / h), tolerance=1e9)[-1]
        errors.append(np.max(np.abs(now.state[:4] - exact(800.0, MOVING, inputs, 0.04))))
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(4.0, abs=0.3)


def test_a_step_in_sub_steps_is_closer_to_the_truth():
    inputs = SHAKEN._replace(length=8e-3, floor_rise=0.4)
    (_, one), (_, fine) = (moved(Linear(c=3000.0, k=0.0), MOVING, inputs, 1, t) for t in (1e9, 1e-9))
    truth = exact(3000.0, MOVING, inputs, 8e-3)
    assert fine.substep < 8e-3 == one.substep
    assert np.max(np.abs(fine.state[:4] - truth)) < 1e-8 < 1e-5 < np.max(np.abs(one.state[:4] - truth))


def test_a_solution_beyond_all_bounds_is_given_up():
    rig = Rig(PLANT, Linear(c=math.nan))
    now = start(rig, MOVING, disturbance_at(SHAKEN, 0.0), 0.0, NONE, H)
    stuck, current, good = advance(rig, COIL, SHAKEN._replace(current=0.3), NONE, now, 1e-4)
    assert not good and stuck is now and current == 0.3


@pytest.mark.parametrize("friction", [100.0, 0.5])
def test_a_block_that_slides_comes_to_rest(friction):
    # A block that is slowed by 5 m/s^2 from 0.01 m/s is at rest after 2 ms and 10 um.
    damper, block = Linear(c=0.0, b=0.0, k=0.0, friction=friction), BLOCK._replace(frame_mass=friction / 5.0)
    for sign in (1.0, -1.0):
        state = (0.0, sign * 0.01, *REST[2:])
        trace = moved(damper, state, STILL, 5, plant=block)
        assert trace[1].slip == sign and trace[1].state[1] == pytest.approx(sign * 0.005, rel=1e-9)
        assert trace[-1].slip == STICKING and trace[-1].state[1] == 0.0
        assert trace[-1].state[0] == pytest.approx(sign * 1e-5, rel=1e-9)
        assert trace[1].forces.damper_force == pytest.approx(sign * friction)


@pytest.mark.parametrize("friction", [100.0, 90.0])
def test_a_block_breaks_loose_where_the_reaction_exceeds_the_friction(friction):
    # The floor's acceleration grows by 1 m/s^2 per ms: the block of 20 kg slides backwards from 5 ms on, or from 4.5 ms
    # on, in the middle of a step.
    damper = Linear(c=0.0, b=0.0, k=0.0, friction=friction)
    trace = moved(damper, REST, STILL._replace(floor_rise=1.0), 9, plant=BLOCK)
    assert [now.slip for now in trace[:5]] == [STICKING] * 5
    assert [now.state[1] for now in trace[:5]] == pytest.approx([0.0] * 5, abs=1e-12)
    late = 0.009 - friction / 20.0 / 1000.0
    assert trace[-1].slip == -1.0 and trace[-1].forces.friction == pytest.approx(-friction)
    assert trace[-1].state[1] == pytest.approx(-0.5 * 1000.0 * late**2, rel=1e-7)
    assert trace[-1].state[0] == pytest.approx(-1000.0 * late**3 / 6.0, rel=1e-7)
    assert trace[3].forces.friction == pytest.approx(-20.0 * 3.0)


def test_a_block_may_turn_without_resting():
    # The floor pushes by 8 m/s^2 against 5 m/s^2 of friction: from 13 m/s^2 of slowing to 3 m/s^2 of speeding up.
    damper = Linear(c=0.0, b=0.0, k=0.0, friction=100.0)
    trace = moved(damper, (0.0, 0.0065, *REST[2:]), STILL._replace(floor=8.0), 2, plant=BLOCK)
    assert [now.slip for now in trace] == [1.0, -1.0, -1.0]
    assert trace[1].state[1] == pytest.approx(-3.0 * 0.0005, rel=1e-6)
    assert trace[2].state[1] == pytest.approx(-3.0 * 0.0015, rel=1e-6)
    assert trace[2].substep == H
