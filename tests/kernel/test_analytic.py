"""Exact solutions: the linear seat, and a block that sticks and slides under Coulomb friction."""

import numpy as np
import pytest
from scipy.signal import StateSpace, lsim

from seatsim.dampers.bingham import Bingham
from seatsim.effects.seat import Friction
from seatsim.rig.plant import Plant, state_space

from .rigs import SEAT, STEP, driven, imbalance, rough

BLOCK = Plant(20.0, 80.0, 0.0, 0.0, 1e-9, 0.0)
DAMPER_SHARE = 100.0


def linear(damping):
    return Bingham(c_a=damping, c_b=0.0, fc_a=0.0, fc_b=0.0, v_ref=0.1)


@pytest.mark.parametrize(("damping", "ratio"), [(0.0, 1.0), (800.0, 1.0), (800.0, 0.6)])
def test_the_linear_seat(damping, ratio, conform):
    plant = SEAT._replace(damper_ratio=ratio)
    floor = rough(4.0, rms=2.0, seed=2)
    s = state_space(plant)
    A = s.A + s.B2 @ [[0.0, ratio * damping, 0.0, 0.0]]
    _, states, _ = lsim(StateSpace(A, s.B1, np.eye(4), np.zeros((4, 1))), floor, STEP * np.arange(len(floor)))
    h = driven(linear(damping), floor, 0.0, plant=plant)
    names = ("suspension_displacement", "suspension_velocity", "cushion_displacement")
    expected = dict(zip(names, states.T, strict=False)) | {"damper_force": damping * ratio * states[:, 1]}
    expected |= {"driver_acceleration": states @ s.C1[1], "frame_acceleration": states @ A[1]}
    for name, values in expected.items():
        deviation = np.max(np.abs(h[name] - values)) / max(1e-9, np.max(np.abs(values)))
        claim = f"linear seat, damper {damping:g} N s/m, ratio {ratio:g}: deviation of {name}, over its greatest value"
        conform(claim, "scipy.signal.lsim", deviation, tolerance=1e-6)
    assert imbalance(h, plant) < 1e-6


def block(floor, limit):
    """A block of 20 kg under friction, of which the damper contributes 100 N."""
    damper = Bingham(c_a=0.0, c_b=0.0, fc_a=DAMPER_SHARE, fc_b=0.0, v_ref=0.0)
    effects = (Friction(limit - DAMPER_SHARE),)
    return driven(damper, floor, 0.0, plant=BLOCK, effects=effects)


def test_a_block_is_held_below_the_limit(conform):
    floor = 7.4 * np.sin(2 * np.pi * 3.0 * STEP * np.arange(1001))
    h = block(floor, 150.0)
    assert np.all(h["suspension_displacement"] == 0.0) and np.all(h["suspension_velocity"] == 0.0)
    assert h["frame_acceleration"] == pytest.approx(floor)
    deviation = np.max(np.abs(h["damper_force"] + 20.0 * floor * DAMPER_SHARE / 150.0))
    conform("block that sticks, deviation of the damper's force, N", "closed form", deviation, tolerance=1e-6)


def test_a_block_breaks_away_when_the_limit_is_reached(conform):
    time = STEP * np.arange(301)
    h = block(-50.0 * time, 147.34)
    sliding = np.maximum(0.0, time - 147.34 / 20.0 / 50.0)
    errors = h["suspension_displacement"] - 50.0 / 6.0 * sliding**3, h["suspension_velocity"] - 25.0 * sliding**2
    for name, error, tolerance in zip(("displacement, m", "velocity, m/s"), errors, (1e-12, 1e-11), strict=True):
        claim = f"block that breaks away, deviation of the {name}"
        conform(claim, "closed form", np.max(np.abs(error)), tolerance=tolerance)
    assert h["damper_force"][-1] == pytest.approx(DAMPER_SHARE)
    assert imbalance(h, BLOCK) < 1e-9


def test_a_sliding_block_stops_at_the_analytic_time(conform):
    floor = np.where(np.arange(1001) <= 200, -20.0, 0.0)
    h = block(floor, 150.0)
    top = 12.5 * 0.2 + 1e-3 * (20.0 / 2 - 7.5)
    stop = 0.201 + top / 7.5
    way = 0.5 * 12.5 * 0.2**2 + 2.5e-3 + 1e-6 * (12.5 / 2 - 20.0 / 6) + top**2 / 15.0
    rest = np.flatnonzero((h["suspension_velocity"] == 0.0) & (np.arange(1001) > 0))
    assert rest[0] == np.ceil(stop / STEP) and len(rest) == 1001 - rest[0]
    before = stop - STEP * (rest[0] - 1)
    for claim, found, expected, tolerance in (
        ("velocity a row before it stops, m/s", h["suspension_velocity"][rest[0] - 1], 7.5 * before, 1e-10),
        ("way until it stops, m", h["suspension_displacement"][-1], way, 1e-11),
        ("energy dissipated in the damper, J", h["energy_damper"][-1], DAMPER_SHARE * way, 1e-8),
        ("energy dissipated in the linkage, J", h["energy_suspension"][-1], 50.0 * way, 1e-8),
    ):
        conform(f"sliding block, {claim}", "closed form", found, expected, tolerance=tolerance)
    assert imbalance(h, BLOCK) < 1e-9


def test_a_block_that_is_pushed_back_reverses_without_rest(conform):
    floor = np.where(np.arange(501) <= 200, -20.0, 20.0)
    h = block(floor, 150.0)
    middle = 0.2 + 1e-3 * (20.0 - 7.5) / 40.0
    speed, start = 2.5, h["suspension_displacement"][201]
    speed = speed + 1e-3 * (0.0 - 7.5)
    assert h["suspension_velocity"][201] == pytest.approx(speed, abs=1e-9) and middle < 0.201
    back = 0.299 - speed / 27.5
    way = start + speed**2 / 55.0 - 0.5 * 12.5 * back**2
    velocity, displacement = h["suspension_velocity"][-1], h["suspension_displacement"][-1]
    conform("block that reverses, velocity at the end, m/s", "closed form", velocity, -12.5 * back, tolerance=1e-9)
    conform("block that reverses, way at the end, m", "closed form", displacement, way, tolerance=1e-9)
    assert imbalance(h, BLOCK) < 1e-9
