"""Records of lanes in rows of numbers, and back."""

from typing import NamedTuple

import numba
import numpy as np
import pytest

from seatsim.kernel.lane_records import LANES, One, Two, fill, gather, numbers, scatter, template_of


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


def test_lanes_that_are_left_over_repeat_the_last():
    rows = fill(RECORDS).reshape(-1, LANES)
    assert rows.shape == (6, LANES)
    assert rows[2].tolist() == [0.5, 1.5, *[2.5] * (LANES - 2)]


def test_compiled_code_reads_and_writes_the_records():
    @numba.njit
    def copy(template, rows, lane):
        record, copied = gather(template, rows, lane), np.zeros_like(rows)
        scatter(record, copied, lane)
        return record, copied

    rows = fill(RECORDS)
    for lane, record in enumerate(RECORDS):
        found, copied = copy(template_of(RECORDS), rows, lane)
        assert found == record
        assert np.array_equal(copied.reshape(-1, LANES)[:, lane], rows.reshape(-1, LANES)[:, lane])
