"""The vector of a damper's free parameters: there and back, scaled to another damper, fixed by the user."""

import math
from typing import Annotated, NamedTuple

import numpy as np
import pytest

from seatsim.dampers.bouc_wen import BoucWen, ModifiedBoucWen
from seatsim.identification.damper_record import (
    Coordinates,
    Scales,
    evaluate_law,
    fix_parameters,
    numeric_fields,
    rescale_damper,
)
from seatsim.schema.errors import InputError
from seatsim.schema.fields import bounds, param
from seatsim.schema.registry import find, names, specification_of

MODELS = [name for name in names("damper") if find("damper", name).__module__.startswith("seatsim.dampers.")]
SCALES = Scales(force=400.0, stroke=0.006, speed=0.06, current=1.0)


def coordinates(record, scales=SCALES, **options):
    return Coordinates(record, scales, specification_of(type(record)).fixed, **options)


def same(a, b):
    for name, x, y in zip(a._fields, a, b, strict=True):
        assert x == pytest.approx(y, rel=1e-9, abs=1e-12 * max(1.0, float(np.max(np.abs(y))))), name


@pytest.mark.parametrize("model", MODELS)
def test_record_and_vector_come_back_from_each_other_and_stay_in_bounds(model):
    record = find("damper", model)()
    between = coordinates(record)
    vector = between.to_vector(record)
    assert len(vector) == len(between.components) > 0 and np.all(np.isfinite(vector))
    same(between.to_record(vector), record)
    rng = np.random.default_rng(0)
    for _ in range(5):
        draw = between.to_vector(between.start) + 0.5 * rng.standard_normal(len(between.components))
        vector = np.clip(draw, between.low, between.high)
        assert between.to_vector(between.to_record(vector)) == pytest.approx(vector, rel=1e-6, abs=1e-6)
    ends = [np.where(np.isfinite(end), end, 0.0) for end in (between.low, between.high)]
    for record in map(between.to_record, ends):
        for name in numeric_fields(type(record)):
            low, high = bounds(type(record), name)
            assert low <= getattr(record, name) <= high, "a file with it could not be read again"


@pytest.mark.parametrize(("default", "true"), [(0.5, 980.0), (1e-3, 4990.0), (4000.0, 0.2)])
def test_stated_bounds_are_searched_whatever_the_default_is(default, true):
    class Own(NamedTuple):
        bounded: Annotated[float, param("N", "yield force", low=0, high=5e3)] = default
        unbounded: Annotated[float, param("N", "yield force", low=0)] = default

    between = Coordinates(Own(), SCALES)
    record = Own(true, true)
    same(between.to_record(between.to_vector(record)), record)
    assert between.to_record(between.high).bounded == pytest.approx(5e3)


def test_without_current_nothing_that_depends_on_it_is_free():
    between = coordinates(BoucWen(), SCALES._replace(current=0.0))
    assert {c.field for c in between.components}.isdisjoint({"c_b", "alpha_b"})
    laws = coordinates(ModifiedBoucWen(), SCALES._replace(current=0.0), levels=1)
    assert [c.name for c in laws.components if c.field == "c0"] == ["c0[0]"]


def test_a_law_has_one_value_for_each_of_few_currents():
    between = coordinates(ModifiedBoucWen(), levels=2)
    ours = [c for c in between.components if c.field == "alpha"]
    assert [(c.at, c.label) for c in ours] == [(0.0, "alpha(0 A)"), (1.0, "alpha(1 A)")]
    assert between.to_record(between.to_vector(between.start)).alpha[2:] == (0.0, 0.0)


def test_a_law_that_is_nowhere_negative_stays_so():
    record = ModifiedBoucWen()
    between = coordinates(record)
    assert all(c.low == 0.0 for c in between.components if c.field in ("c0", "c1", "alpha"))
    free = coordinates(record._replace(alpha=(100.0, -900.0, 0.0, 0.0), c0=(0.0, 0.0, 0.0, 0.0)))
    assert all(c.low == -math.inf for c in free.components if c.field in ("c0", "alpha"))


def test_a_damper_is_scaled_in_force_and_current():
    record = ModifiedBoucWen()
    other = rescale_damper(record, 3.0, 2.0)
    assert other.law_end == 2.0 and (other.A, other.n, other.beta) == (record.A, record.n, record.beta)
    assert evaluate_law(other.c0, np.array([2.0])) == pytest.approx(3.0 * evaluate_law(record.c0, np.array([1.0])))
    assert other.k0 == pytest.approx(3.0 * record.k0)
    linear = rescale_damper(BoucWen(), 2.0, 5.0)
    assert (linear.c_a, linear.c_b, linear.beta) == (500.0, 700.0, BoucWen().beta)


@pytest.mark.parametrize(
    "model, values, problem",
    [
        ("bouc_wen", {"c_aa": 1.0}, "--fix c_aa: no such number (did you mean 'c_a'?); permitted: c_a, c_b"),
        ("modified_bouc_wen", {"alpha": 1.0}, "--fix alpha: no such number"),
        ("bouc_wen", {"c_a": -1.0}, "--fix c_a=-1.0 is not permitted; it must be a number from 0 to inf"),
        ("bouc_wen", {"n": 99}, "--fix n=99 is not permitted; it must be a number from 1 to 20"),
        ("bouc_wen", {"n": "two"}, "--fix n=two is not permitted; it must be a number"),
        ("bouc_wen", {"n": None}, "--fix n=None is not permitted"),
        ("bouc_wen", {"k0": math.nan}, "--fix k0=nan is not permitted"),
        ("bouc_wen", {"k0": True}, "--fix k0=True is not permitted"),
    ],
)
def test_what_cannot_be_fixed_is_refused(model, values, problem):
    with pytest.raises(InputError) as error:
        fix_parameters(find("damper", model)(), values)
    assert problem in str(error.value)
