"""A record's own method goes before the default, in Python and for numba."""

from typing import NamedTuple

import numba
import pytest

from seatsim.kernel.hooks import hook, record_class


class With(NamedTuple):
    """A record that answers."""

    size: float

    def answer(self, value):
        return self.size * value


class Without(NamedTuple):
    """A record that does not."""

    size: float


@hook
def answer(record: With, value: float) -> float:
    """What is said where nothing answers."""
    return -value


@numba.njit
def compiled_answer(record, value):
    return answer(record, value)


@pytest.mark.parametrize("call", [answer, compiled_answer])
def test_the_records_own_method_goes_before_the_default(call):
    assert call(With(3.0), 2.0) == 6.0
    assert call(Without(3.0), 2.0) == -2.0


def test_the_class_of_a_record_is_found_from_its_numba_type():
    assert record_class(numba.typeof(With(1.0))) is With
    assert record_class(numba.typeof(Without(1.0))) is Without
    with pytest.raises(TypeError, match="takes records"):
        record_class(numba.typeof((1.0, 2.0)))


def test_what_is_no_record_has_no_hook():
    with pytest.raises(numba.TypingError, match="answer"):
        compiled_answer(1.0, 2.0)
