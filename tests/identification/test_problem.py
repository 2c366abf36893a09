"""The problem that a fit solves: its statement from records, its residuals, its Jacobian, and how it is searched."""

import math

import numpy as np
import pytest

from seatsim.identification.damper_record import find_model
from seatsim.identification.problem import BenchModel, find_origin, state_problem
from seatsim.identification.settings import IdentificationSettings as Settings
from seatsim.rig.temperature import TemperatureFactors

from ..text import words
from .benches import BINGHAM, made


def stated(records, settings=None, origin=0.0):
    return state_problem(records, find_model("bingham"), origin, settings or Settings(fix={"v_ref": BINGHAM.v_ref}))


def test_records_count_alike_whatever_their_force_and_length():
    records = [made(seconds=1.0), made(current=1.0, seconds=4.0)]
    problem, _ = stated(records)
    off = BenchModel(BINGHAM._replace(f0=BINGHAM.f0 + 7.0), TemperatureFactors())
    residuals = np.split(problem.residuals(problem.to_vector(off)), [len(problem.inputs[0].force)])
    for part, record in zip(residuals, records, strict=True):
        assert np.sum(part**2) == pytest.approx((7.0 / np.std(record.force)) ** 2, rel=1e-6)
    assert problem.cost(problem.to_vector(off)) == pytest.approx(np.mean([np.sum(part**2) for part in residuals]))


def test_a_force_that_runs_away_has_the_largest_residual():
    problem, _ = stated([made()])
    wild = problem._replace(inputs=[problem.inputs[0]._replace(v=np.full_like(problem.inputs[0].v, np.inf))])
    start = problem.coordinates.to_vector(problem.coordinates.start)
    assert np.sum(wild.residuals(start) ** 2) == pytest.approx(100.0)


def test_a_bench_comes_back_from_its_vector_with_coil_and_temperature():
    coil = made(current=lambda t: np.where(t % 1.0 < 0.5, 0.0, 1.0), coil=(200.0, 50.0), temperature=20.0)
    problem, _ = stated([coil, made(current=1.0, temperature=80.0)])
    bench = BenchModel(BINGHAM, TemperatureFactors(-0.004, 0.001, -0.007, problem.reference), 200.0, 60.0, 0.5)
    found = problem.to_bench(problem.to_vector(bench))
    assert found.rise == pytest.approx(200.0) and found.fall == pytest.approx(60.0)
    assert found.factors == pytest.approx(bench.factors) and found.offset_per_kelvin == pytest.approx(0.5)
    assert found.damper == pytest.approx(BINGHAM)
    assert problem.labels[-6:] == words("""
        actuator.rate actuator.rate_fall temperature_factors.viscous temperature_factors.stiffness
        temperature_factors.yield_force bench.offset_per_kelvin
    """)
    low, high = problem.bounds
    assert high[-6] == pytest.approx(math.log(30.0)) and low[-4] == pytest.approx(-3.0) and high[-1] == math.inf


# --------------------------------------------------------------------------------------------- the statement


@pytest.mark.parametrize("middle, origin", [(0.0, 0.0), (0.002, 0.0), (0.0031, 0.0031), (-0.04, -0.04)])
def test_an_origin_is_the_middle_of_motion_that_is_far_from_zero(middle, origin):
    record = made()
    assert find_origin([record._replace(displacement=record.displacement + middle)]) == pytest.approx(origin, abs=1e-4)


@pytest.mark.parametrize("warmer, reference", [(4.0, None), (6.0, 23.0)])
def test_temperature_is_an_input_where_it_varies_enough(warmer, reference):
    records = [made(temperature=20.0), made(temperature=20.0 + warmer)]
    assert stated(records)[0].reference == reference
    assert stated(records, Settings(ignore_temperature=True))[0].reference is None
    assert stated([records[0], made()])[0].reference is None, "not recorded everywhere"
