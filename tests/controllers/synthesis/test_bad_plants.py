"""Wrong input and hopeless plants are refused in one sentence, fast."""

import time

import numpy as np
import pytest

from controllers import GeneralisedPlant, synthesise
from seatsim.schema.errors import InputError, SynthesisError

NAMES = ("A", "B1", "B2", "C1", "C2", "D11", "D12", "D21")


def parts(plant):
    return {name: getattr(plant, name) for name in NAMES}


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
        synthesise(**{**parts(seat(30.0)), name: value})


@pytest.mark.parametrize("option", [{"max_gain": 0.0}, {"max_gain": np.inf}, {"time_budget": -1.0}])
def test_wrong_options(seat, option):
    with pytest.raises(InputError, match=next(iter(option))):
        synthesise(seat(30.0), **option)


def three_modes(B2, C2, structure=None):
    ny, nu = len(C2), len(B2[0])
    one, A = np.ones((3, 1)), np.diag([-1.0, 2.5, -3.0])
    return GeneralisedPlant(A, one, B2, one.T, C2, [[0]], np.zeros((1, nu)), np.zeros((ny, 1)), structure)


@pytest.mark.parametrize(
    ("B2", "C2", "structure", "words"),
    [
        ([[1], [0], [1]], [[1, 1, 1]], None, "its mode 2.5 1/s is not reached by the control input"),
        ([[1], [1], [1]], [[1, 0, 1]], None, "its mode 2.5 1/s is not seen by the measurement"),
        ([[1, 0], [0, 1], [0, 0]], [[0, 1, 0], [1, 0, 0]], [[0, 1], [0, 1]], "its mode 2.5 1/s is moved by no gain"),
    ],
)
def test_hopeless_mode_is_named_at_once(B2, C2, structure, words):
    begin = time.monotonic()
    with pytest.raises(SynthesisError, match=words):
        synthesise(three_modes(B2, C2, structure))
    assert time.monotonic() - begin < 1


def test_plant_that_no_static_gain_stabilises():
    # 1/s^3 needs phase lead, which a static gain has not: s^3 - k is never Hurwitz.
    A, B, C = np.eye(3, k=1), np.eye(3)[:, 2:], np.eye(3)[:1]
    with pytest.raises(SynthesisError, match=r"no stabilising gain with \|gain\| <= 100 was found from .* starts"):
        synthesise(A, B, B, C, C, [[0]], [[0]], [[0]], max_gain=100.0, time_budget=5.0)
