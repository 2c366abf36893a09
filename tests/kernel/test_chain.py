"""What several records do together: each gets its own part of the state, in order, in Python and compiled."""

from typing import NamedTuple

import numba
import numpy as np
import pytest

from seatsim.kernel.hooks import (
    effect_state,
    fold_hook,
    join_hook,
    leading_state,
    record_class,
    state_at_rest,
    sum_hook,
)

from .uncompiled import plugged


@plugged("first", initial=(1.0, 2.0))
class First(NamedTuple):
    """Two states."""

    a: float = 2.0

    def size(self, x, z):
        return self.a * x + 10.0 * z[0] + 100.0 * z[1]

    def change(self, value, x, z):
        return value * z[1] + x

    def speed(self, x, z):
        return (z[1], -z[0])


@plugged("silent", initial=(7.0,))
class Silent(NamedTuple):
    """A state, but no answer."""

    a: float = 0.0


@plugged("last", initial=(3.0,))
class Last(NamedTuple):
    """One state."""

    a: float = 5.0

    def size(self, x, z):
        return self.a * x - z[0]

    def change(self, value, x, z):
        return value - z[0]

    def speed(self, x, z):
        return (x,)


EFFECTS, Z = (First(), Silent(), Last()), (0.5, 0.25, 9.0, 4.0)
size, change, speed = sum_hook("size"), fold_hook("change"), join_hook("speed")


@numba.njit
def compiled_hooks(effects, z):
    return size(effects, z, 3.0), change(effects, z, 8.0, 3.0), speed(effects, z, 3.0)


def plain_hooks(effects, z):
    return compiled_hooks.py_func(effects, z)


@pytest.mark.parametrize("hooks", [plain_hooks, compiled_hooks])
def test_sum_fold_and_join(hooks):
    total, folded, joined = hooks(EFFECTS, Z)
    assert total == pytest.approx((2.0 * 3.0 + 5.0 + 25.0) + (5.0 * 3.0 - 4.0))
    assert folded == pytest.approx(8.0 * 0.25 + 3.0 - 4.0)
    assert joined == (0.25, -0.5, 3.0)
    assert hooks((Silent(),), (9.0,)) == (0.0, 8.0, ())


def test_states_at_rest_one_after_another():
    assert state_at_rest([First, Silent, Last]) == (1.0, 2.0, 7.0, 3.0)
    assert state_at_rest([]) == ()


def test_the_state_is_parted_at_the_effects():
    z = (0.1, 0.2, *Z)
    assert leading_state(EFFECTS, z) == (0.1, 0.2)
    assert effect_state(EFFECTS, z) == Z
    assert (leading_state((), z), effect_state((), z)) == (z, ())


def test_what_is_no_tuple_of_records_is_refused():
    with pytest.raises(numba.TypingError):
        compiled_hooks(np.zeros(2), Z)
    with pytest.raises(TypeError, match="takes records"):
        record_class(numba.typeof((1.0, 2.0)))
