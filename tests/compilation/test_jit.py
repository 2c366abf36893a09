"""What compiled arithmetic keeps of IEEE 754, and how functions are made to be called."""

import math

import numba
import pytest
from numba.core.dispatcher import Dispatcher

from seatsim.compilation.jit import ARITHMETIC, jit, jit_apart


@jit
def ratio(a, b):
    return a / b


@jit_apart
def apart(a, b):
    return ratio(a, b) if not math.isnan(a) else -1.0


@numba.njit(**ARITHMETIC)
def absent(values):
    count = 0
    for value in values:
        if value != value or math.isnan(value) or value > 1e308:
            count += 1
    return count


def test_a_function_stays_what_it_is_for_python():
    assert ratio(3.0, 2.0) == 1.5
    assert not isinstance(ratio, Dispatcher)
    with pytest.raises(ZeroDivisionError):
        ratio(1.0, 0.0)


def test_compiled_a_division_by_zero_is_infinite():
    assert isinstance(apart, Dispatcher)
    assert (apart(1.0, 0.0), apart(-1.0, 0.0)) == (math.inf, -math.inf)
    assert math.isnan(apart(0.0, 0.0))


def test_compiled_nan_and_infinity_keep_their_meaning():
    assert apart(math.nan, 1.0) == -1.0
    assert absent((math.nan, 1.0, math.inf)) == 2
