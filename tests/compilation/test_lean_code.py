"""What is left out of compiled code is what nobody uses: whatever Python calls, or counts, is there as ever."""

import numba
import numpy as np
import pytest
from numba.core.runtime import _nrt_python, rtsys

from seatsim.compilation.jit import jit


def test_functions_of_others_that_callers_take_in_can_be_called():
    @numba.njit(forceinline=True)
    def double(x):
        return 2.0 * x

    @numba.njit
    def quadruple(x):
        return double(double(x))

    assert quadruple(3.0) == 12.0 and double(3.0) == 6.0


def test_an_inlined_function_within_an_inlined_one_reports_its_error():
    @jit
    def check(x):
        if x < 0.0:
            raise ValueError("below zero")
        return np.sqrt(x)

    @jit
    def scale(x):
        return 2.0 * check(x)

    @numba.njit
    def call(x):
        return scale(x) + check(x)

    assert call(4.0) == 6.0
    with pytest.raises(ValueError, match="below zero"):
        call(-1.0)


def test_an_inlined_function_may_ask_python():
    @jit
    def ask(x):
        with numba.objmode(y="float64"):
            y = float(str(x)) + 1.0
        return y

    @numba.njit
    def call(x):
        return 2.0 * ask(x)

    assert call(2.5) == 7.0


@pytest.fixture
def counted():
    """Allocations are counted meanwhile."""
    _nrt_python.memsys_enable_stats()
    yield rtsys.get_allocation_stats
    _nrt_python.memsys_disable_stats()


def test_an_array_in_a_tuple_is_freed_once(counted):
    @numba.njit
    def add(count):
        pair = (np.ones(count), (1.0, 2))
        kept = (pair, pair)
        return kept[0][0].sum() + kept[1][1][0], kept

    before = counted()
    total, kept = add(5)
    assert total == 6.0 and kept[1][0].tolist() == [1.0] * 5
    del kept
    after = counted()
    assert after.alloc - before.alloc == after.free - before.free == 1
