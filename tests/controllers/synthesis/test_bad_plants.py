"""Wrong input and hopeless plants are refused in one sentence, fast."""

import numpy as np
import pytest

from controllers import synthesise
from seatsim.schema.errors import InputError

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
