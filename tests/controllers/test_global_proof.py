"""Proofs that no gain in a box is better: checked in fractions by code that shares nothing with the search."""

import json

import numpy as np
import pytest

from controllers import GeneralisedPlant, synthesise
from controllers.seat_plant import Weights, build_generalised_plant
from controllers.synthesis.global_proof import prove_no_better
from controllers.synthesis.norm import hinf_norm
from seatsim.rig.plant import Plant
from seatsim.schema.errors import InputError

SEAT = build_generalised_plant(Plant(20.0, 80.0, 4600.0, 150.0, 60000.0, 1500.0), Weights())
LOW, HIGH = np.array([-5000.0, 0.0]), np.array([5000.0, 8000.0])
GRID = np.array(np.meshgrid(np.linspace(-5000, 5000, 40), np.linspace(0, 8000, 40))).reshape(2, -1).T


def norm(plant, values):
    return hinf_norm(plant.close(np.reshape(values, plant.free.shape))).value


@pytest.fixture(scope="module")
def least():
    """The least norm of the seat on the grid."""
    return min(norm(SEAT, values) for values in GRID)


@pytest.fixture
def check(benchmark):
    """Check the file of a proof in fractions."""
    return benchmark("exact_global_proofs").check


def test_no_gain_of_a_seat_is_better_than_the_least_norm_on_a_grid_but_for_a_percent(check, tmp_path, least):
    proof = prove_no_better([SEAT], 0.99 * least, LOW, HIGH)
    assert proof.is_proven
    proof.save(tmp_path / "global.json")
    assert check(tmp_path / "global.json") == f"proven in {proof.boxes} boxes"


@pytest.mark.parametrize("fault", ["level", "box", "step", "weight"])
def test_a_proof_of_too_much_is_refuted(check, tmp_path, fault, least):
    proof = prove_no_better([SEAT], 0.99 * least, LOW, HIGH)
    path = tmp_path / "global.json"
    proof.save(path)
    plain = json.loads(path.read_text())
    if fault == "level":
        plain["level"] *= 1.03
    elif fault == "box":
        plain["low"][1] = -3000.0
    elif fault == "step":
        plain["steps"].pop()
    else:
        step = next(step for step in plain["steps"] if "inequalities" in step)
        step["inequalities"][0]["weight"] *= -1.0
    path.write_text(json.dumps(plain))
    assert check(path).startswith("REFUTED")


def test_a_gain_that_is_better_is_found_and_not_denied(least):
    proof = prove_no_better([SEAT], 1.01 * least, LOW, HIGH)
    assert not proof.is_proven
    assert norm(SEAT, proof.better) < 1.01 * least


def test_one_gain_for_two_plants_is_judged_by_the_worse(check, tmp_path, least):
    hot = build_generalised_plant(Plant(20.0, 80.0, 4600.0, 150.0, 60000.0, 1500.0), Weights(), force_factor=0.5)
    worse = min(max(norm(SEAT, values), norm(hot, values)) for values in GRID)
    proof = prove_no_better([SEAT, hot], 0.99 * worse, LOW, HIGH)
    proof.save(tmp_path / "global.json")
    assert check(tmp_path / "global.json").startswith("proven")
    assert worse > least


ONE, ZERO = np.ones((1, 1)), np.zeros((1, 1))


def make_turning_pair():
    """Beside a stable pole that k moves, a pair of poles at 1 +- 2j that turns with it, always right of zero."""
    A = np.array([[1.0, 2.0, 0.0], [-2.0, 1.0, 0.0], [0.0, 0.0, -3.0]])
    B2, C2 = np.array([[0.0], [1.0], [1.0]]), np.array([[0.2, 0.0, 1.0]])
    return GeneralisedPlant(A, B2, B2, C2, C2, ZERO, ZERO, ZERO)


def make_drifting_mass():
    """x'' = x' + k x: the sum of the poles is 1 whatever the gain."""
    one = np.eye(2)[:, 1:]
    return GeneralisedPlant([[0.0, 1.0], [0.0, 1.0]], one, one, [[1.0, 0.0]], [[1.0, 0.0]], ZERO, ZERO, ZERO)


def make_half_reached():
    """Of z = (x1, x2) the control moves x2 only: T from w to x1 is 1 / (s + 0.5), with the norm 2."""
    none = np.zeros((2, 1))
    A, B1, B2 = np.diag([-0.5, -1.0]), np.ones((2, 1)), np.array([[0.0], [1.0]])
    return GeneralisedPlant(A, B1, B2, np.eye(2), np.eye(2), none, none, none)


def make_lag(sign):
    """x' = -x + w + u, z = 2 w + sign x, y = x: T = 2 + sign / (s + 1 - k)."""
    return GeneralisedPlant(-ONE, ONE, ONE, sign * ONE, ONE, 2 * ONE, ZERO, ZERO)


PROVEN = {
    "poles that turn": (make_turning_pair(), np.inf, [-1.0], [1.0]),
    "poles that drift": (make_drifting_mass(), np.inf, [-1e6], [1e6]),
    "what no control reaches": (make_half_reached(), 1.999, [-1e6, -1e6], [1e6, 1e6]),
    "a norm T(0), least 2.5 at k = -1": (make_lag(1.0), 2.49, [-1.0], [1.0]),
    "a norm T(inf) = 2 where k < 0.75": (make_lag(-1.0), 1.99, [-1.0], [1.0]),
}


@pytest.mark.parametrize("name", PROVEN)
def test_what_no_gain_of_a_box_does_is_proven(check, tmp_path, name):
    plant, level, low, high = PROVEN[name]
    proof = prove_no_better([plant], level, low, high)
    assert proof.is_proven
    proof.save(tmp_path / "global.json")
    assert check(tmp_path / "global.json") == f"proven in {proof.boxes} boxes"
    if name == "poles that turn":
        assert "shift" in (tmp_path / "global.json").read_text()
    if name == "what no control reaches":
        assert proof.boxes == 1
        plain = json.loads((tmp_path / "global.json").read_text())
        (tmp_path / "global.json").write_text(json.dumps(plain | {"level": 2.001}))
        assert check(tmp_path / "global.json").startswith("REFUTED")


def test_two_controls_and_two_measurements(check, tmp_path):
    draw = np.random.default_rng(4)
    A = draw.normal(size=(4, 4)) - 1.5 * np.eye(4)
    B1, B2, C1, C2 = (draw.normal(size=shape) for shape in ((4, 2), (4, 2), (2, 4), (2, 4)))
    plant = GeneralisedPlant(A, B1, B2, C1, C2, np.zeros((2, 2)), 0.3 * np.eye(2), np.zeros((2, 2)))
    least = synthesise(plant, max_gain=0.5).gamma
    proof = prove_no_better([plant], 0.97 * least, np.full(4, -0.5), np.full(4, 0.5), time_budget=60.0)
    assert proof.is_proven
    proof.save(tmp_path / "global.json")
    assert check(tmp_path / "global.json").startswith("proven")


def test_nothing_is_claimed_where_rounding_decides():
    # T = (0.3 + 0.1 k 3) / (s + 1) has the norm 2.8e-17 at k = -1, where doubles add up to 5.6e-17.
    plant = GeneralisedPlant(-ONE, 0.3 * ONE, 0.1 * ONE, ONE, ZERO, ZERO, ZERO, 3 * ONE)
    assert not prove_no_better([plant], 4e-17, [-1.0 - 2.0**-40], [-1.0], time_budget=5.0).is_proven


def test_what_time_does_not_suffice_for_is_counted():
    proof = prove_no_better([SEAT], 1.0, LOW, HIGH, time_budget=0.0)
    assert (proof.is_proven, proof.open_boxes) == (False, 1)


@pytest.mark.parametrize(("low", "high", "said"), [([0.0], [1.0], "2 gains"), ([1.0, 0.0], [0.0, 1.0], "low < high")])
def test_a_box_that_is_none_is_refused(low, high, said):
    with pytest.raises(InputError, match=said):
        prove_no_better([SEAT], 1.0, low, high)


def test_a_design_says_in_its_file_what_was_proven(tmp_path):
    design = synthesise(SEAT, max_gain=1e4).prove()
    design.save(tmp_path / "design.yaml")
    text = (tmp_path / "design.yaml").read_text()
    assert design.proof.is_proven
    assert "proven: true" in text
