"""What the metrics require of their input, and the channels of a run as they read them."""

import math

import numpy as np
import pytest

from seatsim.metrics.motion import as_pair, as_signal, ratio, require_finite, require_positive
from seatsim.metrics.table import MissingInput, RunRecord
from seatsim.schema.errors import InputError


def test_signals_become_floats_of_one_dimension():
    signal = as_signal([1, 2, 3])
    assert signal.dtype == np.float64 and signal.tolist() == [1.0, 2.0, 3.0]
    for bad in ([], [[1.0]], 3.0, ["a"]):
        with pytest.raises(InputError, match="speed"):
            as_signal(bad, "speed")


def test_pairs_have_one_length():
    assert [part.size for part in as_pair([1, 2], [3, 4], ("a", "b"))] == [2, 2]
    with pytest.raises(InputError, match="a has 2 samples, b has 3"):
        as_pair([1, 2], [3, 4, 5], ("a", "b"))


def test_the_first_sample_that_is_not_finite_is_named():
    assert require_finite(np.array([1.0, -2.0]), "x").tolist() == [1.0, -2.0]
    with pytest.raises(InputError, match="x: sample 1 is not finite"):
        require_finite(np.array([0.0, math.inf, math.nan]), "x")


@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_what_must_be_positive_is(value):
    assert require_positive(1e-9, "rate") == 1e-9
    with pytest.raises(InputError, match="rate"):
        require_positive(value, "rate")


def test_a_ratio_over_nothing_is_no_number():
    assert ratio(3.0, -2.0) == -1.5
    assert math.isnan(ratio(1.0, 0.0)) and math.isnan(ratio(1.0, math.nan))


def test_what_is_missing_is_said():
    run = RunRecord({"x": np.ones(5), "empty": np.full(5, math.nan)}, 0.01)
    for read, name in ((run.__getitem__, "y"), (run.__getitem__, "empty"), (run.weighted, "x")):
        with pytest.raises(MissingInput, match=name):
            read(name)
