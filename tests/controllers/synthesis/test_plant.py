"""The generalised plant: the loop that a gain closes, its poles, and other ways to state a plant."""

import control
import numpy as np
import pytest

from controllers import synthesise
from controllers.synthesis.norm import frequency_response
from controllers.synthesis.plant import MATRICES, GeneralisedPlant, LinearSystem
from seatsim.schema.errors import InputError

GAIN = np.array([[0.4, -0.2], [0.3, 0.1]])


def test_a_gain_closes_the_loop_that_the_equations_give(random_plant):
    p, omega = random_plant(0), 1.7
    G = np.linalg.inv(1j * omega * np.eye(4) - p.A)
    Gzw, Gzu = p.C1 @ G @ p.B1 + p.D11, p.C1 @ G @ p.B2 + p.D12
    Gyw, Gyu = p.C2 @ G @ p.B1 + p.D21, p.C2 @ G @ p.B2
    wanted = Gzw + Gzu @ GAIN @ np.linalg.inv(np.eye(2) - Gyu @ GAIN) @ Gyw
    np.testing.assert_allclose(frequency_response(p.close(GAIN), omega)[0], wanted, rtol=1e-9)
    assert (p.order, p.control_count, p.measured_count) == (4, 2, 2)


def test_poles_are_sorted_from_the_right_and_the_abscissa_is_the_first():
    A = np.array([[-3.0, 0.0, 0.0, 0.0], [0.0, -1.0, 5.0, 0.0], [0.0, -5.0, -1.0, 0.0], [0.0, 0.0, 0.0, -2.0]])
    loop = LinearSystem(A, *(np.zeros((4, 4)),) * 3)
    np.testing.assert_allclose(loop.poles, [-1 + 5j, -1 - 5j, -2, -3])
    assert loop.abscissa == pytest.approx(-1.0)


def test_free_gains(random_plant):
    assert random_plant(0).free.all() and random_plant(0).free.shape == (2, 2)
    np.testing.assert_array_equal(random_plant(0, structure=[[1, 0], [0, 1]]).free, np.eye(2, dtype=bool))
    with pytest.raises(InputError, match=r"structure must be a \(2, 2\) matrix"):
        random_plant(0, structure=[[1, 0]])
    with pytest.raises(InputError, match=r"structure must be"):
        random_plant(0, structure=[[1, 2], [0, 1]])
    with pytest.raises(InputError, match=r"leaves no gain free"):
        random_plant(0, structure=[[0, 0], [0, 0]])


def test_a_state_space_is_split(random_plant):
    p = random_plant(1)
    D, system = p.system.D, control.ss(*p.system)
    q = GeneralisedPlant.from_state_space(system, 2, 3, [[1, 1], [0, 1]])
    for name in MATRICES:
        np.testing.assert_array_equal(getattr(q, name), getattr(p, name))
    np.testing.assert_array_equal(q.free, [[True, True], [False, True]])
    for split, words in (((4, 3), "4 disturbance inputs of 4"), ((2, 0), "0 performance outputs of 5")):
        with pytest.raises(InputError, match=words):
            GeneralisedPlant.from_state_space(system, *split)
    with pytest.raises(InputError, match="sampled"):
        GeneralisedPlant.from_state_space(control.ss(p.A, system.B, system.C, D, 0.1), 2, 3)
    with pytest.raises(InputError, match="D22 is not zero"):
        GeneralisedPlant.from_state_space(control.ss(p.A, system.B, system.C, D + 1), 2, 3)


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("A", np.ones((4, 3)), r"A has shape \(4, 3\)"),
        ("B2", np.ones((3, 1)), r"B2 has shape \(3, 1\), wanted is \(4, 1\)"),
        ("C2", [1.0, 0.0, 0.0, 0.0], r"C2 has shape \(4,\)"),
        ("D21", np.zeros((2, 2)), r"D21 has shape \(2, 2\), wanted is \(2, 1\)"),
        ("B1", [[0], [np.nan], [0], [0]], r"B1\[1, 0\] is nan"),
        ("C1", [["a", 1, 2, 3]], "C1 is not a matrix of real numbers"),
        ("A", 1j * np.eye(4), "A is complex"),
        ("D11", None, "the plant lacks D11"),
        ("B1", np.zeros((4, 0)), r"B1 has shape \(4, 0\)"),
    ],
)
def test_wrong_matrices_are_named(seat, name, value, words):
    with pytest.raises(InputError, match=words):
        synthesise(**{each: getattr(seat(30.0), each) for each in MATRICES} | {name: value})
