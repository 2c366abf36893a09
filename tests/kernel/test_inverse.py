"""The inverse damper against a dense search, and what it says where no current serves."""

import numpy as np
import pytest

from seatsim.dampers.bingham import Bingham
from seatsim.dampers.bouc_wen import BoucWen, ModifiedBoucWen
from seatsim.kernel.inverse import CELLS, Demand, invert, total_force
from seatsim.rig.temperature import TemperatureScaling

from .dampers import Bump, Parabola, Steep, Wavy

HEAT = TemperatureScaling(0.9, 1.0, 0.8)
TOP = 1.2
GRID = np.linspace(0.0, TOP, 5_001)
CASES = {
    "bouc_wen": (BoucWen(), ((-1.0, 1.0),)),
    "bingham": (Bingham(), ()),
    "sharp_bingham": (Bingham(v_ref=0.0), ()),
    "modified_bouc_wen": (ModifiedBoucWen(), ((-0.01, 0.01), (-0.002, 0.002))),
    "parabola": (Parabola(), ()),
    "falling_parabola": (Parabola(200.0, -600.0, 900.0), ()),
    "parabola_that_turns_beyond": (Parabola(200.0, 600.0, -200.0), ()),
    "bingham_whose_friction_vanishes": (Bingham(v_ref=0.0, c_b=100.0, fc_a=60.0, fc_b=-90.0), ()),
    "wavy": (Wavy(), ()),
}


def draw(bounds, count):
    """Wanted force, displacement, velocity and state at random."""
    rng = np.random.default_rng(11)
    for _ in range(count):
        v = rng.uniform(-0.3, 0.3)
        yield rng.uniform(-1.0, 3.0) * 800.0 * v, rng.uniform(-0.02, 0.02), v, tuple(rng.uniform(*b) for b in bounds)


def ask(damper, wanted, x, v, z):
    return invert(Demand(damper, wanted, x, v, HEAT, z, TOP), np.empty(CELLS + 1))


def on_grid(damper, x, v, z):
    """Force over the dense grid of currents, by the damper's own method in Python."""
    friction = damper.coulomb(0.0, HEAT) if hasattr(damper, "coulomb") else 0.0
    if friction:
        return np.array([damper.force(x, v, i, HEAT, z) + np.sign(v) * damper.coulomb(i, HEAT) for i in GRID])
    if isinstance(damper, Bingham | BoucWen | Parabola):
        return damper.force(x, v, GRID, HEAT, z)
    return np.array([damper.force(x, v, i, HEAT, z) for i in GRID])


@pytest.mark.parametrize("name", CASES)
def test_the_least_current_that_serves(name, conform):
    damper, bounds = CASES[name]
    served, count, missed, short = 0, 60, 0.0, 0.0
    for wanted, x, v, z in draw(bounds, count):
        answer = ask(damper, wanted, x, v, z)
        assert 0.0 <= answer.current <= TOP
        assert answer.force == pytest.approx(total_force(damper, x, v, answer.current, HEAT, z), rel=1e-12, abs=1e-9)
        if wanted * v <= 0.0:
            assert answer.current == 0.0
            continue
        forces = on_grid(damper, x, v, z)
        crossings = np.flatnonzero((forces[1:] - wanted) * (forces[:-1] - wanted) <= 0.0)
        if len(crossings):
            served += 1
            assert answer.served == 1.0
            assert GRID[crossings[0]] - 1e-6 <= answer.current <= GRID[crossings[0] + 1] + 1e-6
            missed = max(missed, abs(answer.force - wanted) / abs(wanted))
        else:
            closest = np.min(np.abs(forces - wanted))
            assert answer.served == 0.0
            short = max(short, (abs(answer.force - wanted) - closest) / np.ptp(forces))
    assert 5 < served < count - 5
    claim = f"inverse of {name}: relative miss of a force that a current serves"
    conform(claim, "the force that was asked for", missed, tolerance=1e-6)
    claim = f"inverse of {name}: farther from a force that none serves than the best current, over the range of forces"
    conform(claim, "dense search, 5 001 currents", max(short, 0.0), tolerance=1e-6)


@pytest.mark.parametrize(("wanted", "turn"), [(0.1 * 950.0, 1.0 / 6.0), (0.1 * 50.0, 0.5)])
def test_a_turn_is_found_to_more_than_the_root_of_rounding(wanted, turn):
    # The forces are equal to rounding within 1e-8 A of the turn; what is left is the third power of the distance that
    # a parabola does not follow, and a force that differs by less than `CLOSE`.
    damper = Wavy()
    near = ask(damper, wanted, 0.0, 0.1, ()).current
    again = ask(damper, wanted * (1.0 + 1e-15), 0.0, 0.1 * (1.0 - 1e-15), ()).current
    assert near == pytest.approx(turn, abs=1e-6)
    assert again == pytest.approx(near, abs=1e-12)


@pytest.mark.parametrize(("power", "share"), [(9.0, 1e-6), (9.0, 1e-3), (0.1, 0.3), (0.1, 0.6)])
def test_a_root_is_found_to_rounding_however_far_the_map_is_from_its_chord(power, share):
    # Within one cell; without halving the end that stays, the search would end far away.
    answer = ask(Steep(5.0 * CELL, CELL, 1000.0, power), 0.1 * (500.0 + 1000.0 * share), 0.0, 0.1, ())
    assert answer.current == pytest.approx(CELL * (5.0 + share ** (1.0 / power)), abs=1e-11 * CELL)


@pytest.mark.parametrize("curvature", [0.01, -0.01, 1e-3])
def test_a_small_curvature_is_kept_however_large_the_force_that_does_not_depend_on_the_current(curvature):
    damper = Parabola(1e6, 1.0, curvature)
    for current in (0.2, 0.6, 1.0):
        wanted = total_force(damper, 0.0, 0.1, current, HEAT, ())
        assert ask(damper, wanted, 0.0, 0.1, ()).current == pytest.approx(current, abs=1e-8)


def test_beyond_the_current_from_which_the_force_stays_the_same_the_least_is_taken():
    damper, z = ModifiedBoucWen(law_end=0.93), (0.0, 0.002)
    most = total_force(damper, 0.0, 0.2, TOP, HEAT, z)
    for wanted, served in ((most, 1.0), (1.5 * most, 0.0)):
        answer = ask(damper, wanted, 0.0, 0.2, z)
        assert answer.served == served
        assert answer.current == pytest.approx(0.93, abs=1e-6)


CELL = TOP / CELLS


@pytest.mark.parametrize("height", [300.0, -300.0])
@pytest.mark.parametrize("slope", [0.0, 20.0, -20.0])
@pytest.mark.parametrize("centre", [0.3 * CELL, 0.9 * CELL, 3.4 * CELL, 8.0 * CELL, TOP - 0.7 * CELL, TOP - 0.3 * CELL])
def test_a_turn_is_found_wherever_it_lies(centre, slope, height):
    damper = Bump(centre, 1.5 * CELL, height, slope)
    forces = on_grid(damper, 0.0, 0.2, ())
    turn = np.argmax(np.sign(height) * forces)
    # Just short of the turn, at it, and beyond it.
    for wanted in (forces[turn] - 0.01 * height * 0.2, forces[turn], forces[turn] + 0.05 * height * 0.2):
        answer = ask(damper, wanted, 0.0, 0.2, ())
        met = np.flatnonzero((forces[1:] - wanted) * (forces[:-1] - wanted) <= 0.0)
        if len(met) and abs(forces[turn] - wanted) > 1e-9:
            assert answer.served == 1.0 and GRID[met[0]] - 1e-6 <= answer.current <= GRID[met[0] + 1] + 1e-6
        else:
            assert abs(answer.force - wanted) <= np.min(np.abs(forces - wanted)) + 2e-3


@pytest.mark.parametrize("size", [1.0, 0.01])
def test_a_corner_where_friction_vanishes_is_kept_to_however_small_the_friction_is(size):
    damper = Bingham(c_a=250.0 * size, c_b=100.0 * size, fc_a=60.0 * size, fc_b=-90.0 * size, v_ref=0.0)
    for current in np.linspace(0.0, 0.6, 7):
        wanted = total_force(damper, 0.0, 0.1, current, HEAT, ())
        answer = ask(damper, wanted, 0.0, 0.1, ())
        assert answer.served == 1.0 and answer.current == pytest.approx(current, abs=1e-5)
