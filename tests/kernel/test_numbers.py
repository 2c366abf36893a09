"""Records as numbers in a row."""

from typing import NamedTuple

import pytest

from seatsim.kernel.numbers import One, Two, numbers, template_of


class Inner(NamedTuple):
    gain: float
    law: tuple[float, float]


class Record(NamedTuple):
    exponent: float
    inner: Inner
    order: int
    is_on: bool
    empty: tuple[()] = ()


RECORDS = [Record(2.0, Inner(1.0, (0.5 + k, 1.0)), k, k > 0) for k in range(3)]


def test_numbers_come_in_the_order_of_the_fields():
    assert numbers(RECORDS[1]) == [2.0, 1.0, 1.5, 1.0, 1, True]
    with pytest.raises(TypeError, match="str is no number"):
        numbers(("a",))


def test_the_template_holds_what_all_lanes_share():
    assert template_of(RECORDS) == Record(Two(), Inner(One(), (0.5, One())), 0, False)
    assert isinstance(template_of(RECORDS).exponent, Two) and isinstance(template_of(RECORDS).inner, Inner)
    assert template_of(RECORDS[:1]).inner.law[0] == 0.5
