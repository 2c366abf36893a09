"""Arithmetic of states, as Python and as the source that is compiled."""

import math

import numpy as np
import pytest

from seatsim.kernel import hooks

Y, K = (1.0, -2.0, 3.5), [tuple(np.random.default_rng(k).normal(size=3)) for k in range(4)]
UNROLLED = [
    (hooks.axpy, hooks._axpy(Y, None, None), (Y, 0.3, K[0])),
    (hooks.combine, hooks._combine(Y, *(None,) * 5), (Y, 0.3, *K)),
]


def test_combine_follows_an_exponential_to_the_fourth_order():
    h, k1 = 0.1, (-1.0,)
    k2 = (-hooks.axpy((1.0,), 0.5 * h, k1)[0],)
    k3 = (-hooks.axpy((1.0,), 0.5 * h, k2)[0],)
    k4 = (-hooks.axpy((1.0,), h, k3)[0],)
    (found,) = hooks.combine((1.0,), h, k1, k2, k3, k4)
    assert found == pytest.approx(sum((-h) ** n / math.factorial(n) for n in range(5)), rel=1e-15)


@pytest.mark.parametrize(("plain", "unrolled", "arguments"), UNROLLED)
def test_what_is_compiled_does_the_same(plain, unrolled, arguments):
    assert unrolled(*arguments) == pytest.approx(plain(*arguments), rel=1e-14)
    assert len(unrolled(*arguments)) == 3


@pytest.mark.parametrize("lengths", [(2, 3), (3, 2)])
def test_states_of_different_length_are_refused(lengths):
    with pytest.raises(ValueError, match="zip"):
        hooks.axpy((0.0,) * lengths[0], 1.0, (0.0,) * lengths[1])
    with pytest.raises(ValueError, match="zip"):
        hooks.combine((0.0,) * lengths[0], 1.0, *[(0.0,) * lengths[1]] * 4)
